"""Maps."""

from __future__ import annotations

import json
import os
from typing import TYPE_CHECKING, Any

from . import _native
from ._answers import table
from ._documents import encode
from ._optional import needed
from .errors import InvalidMapError, MaskedArrayError, MissingCrsError, NotANumberError, ShapeError

if TYPE_CHECKING:
    import numpy.typing


class Map:
    """Ground on a grid of square cells: elevations, and surfaces, obstacles and areas where they are known.

    >>> import joulepath, numpy
    >>> yard = joulepath.Map.from_array(numpy.zeros((40, 60)), cell_size_m=0.5)
    >>> yard.shape, yard.cell_size_m, yard.crs
    ((40, 60), 0.5, None)
    """

    def __init__(self, native: _native.Map) -> None:
        self._native = native

    @staticmethod
    def from_array(
        z: numpy.typing.ArrayLike,
        cell_size_m: float,
        origin_m: tuple[float, float] = (0.0, 0.0),
        crs: str | None = None,
        *,
        surface: numpy.typing.ArrayLike | None = None,
        obstacle: numpy.typing.ArrayLike | None = None,
        areas: dict[str, Any] | None = None,
        name: str | None = None,
        unknown: str = "refuse",
    ) -> Map:
        """A map from arrays of cells, row 0 the southernmost and column 0 the westernmost.

        ``z``: elevation, shape ``(rows, columns)`` [m]. ``cell_size_m``: edge of a cell, 0.01 to 100 [m]. ``origin_m``: south-west corner
        of the first cell [m]. ``crs``: ``"EPSG:26915"`` or WKT of a system in metres. ``surface``: names by cell, ``None`` or ``""`` for
        the robot's default. ``obstacle``: true where no robot can be. ``areas``: a GeoJSON feature collection. ``unknown``: ``"refuse"``
        raises on NaN elevations, ``"impassable"`` takes them for ground that is not known, where the robot does not go.

        Rows of images run from the north: ``numpy.flipud(z)`` turns them.

        Raises ``ShapeError``, ``MaskedArrayError``, ``NotANumberError`` or ``InvalidMapError``.

        >>> import joulepath, numpy
        >>> east = numpy.arange(60) * 0.5
        >>> hill = joulepath.Map.from_array(numpy.tile(0.1 * east, (40, 1)), 0.5, crs="EPSG:32632")
        >>> hill.elevation_m[0, :3].round(3).tolist()
        [0.0, 0.05, 0.1]
        >>> joulepath.Map.from_array(numpy.zeros(5), 0.5)
        Traceback (most recent call last):
            ...
        joulepath.errors.ShapeError: z has 1 axis, but elevations are rows of columns: ...
        """
        import numpy

        cells = _layer(z, "z", None)
        elevation_m = _numbers(cells, "z")
        if unknown not in ("refuse", "impassable"):
            raise InvalidMapError(f'unknown is {unknown!r}, but must be "refuse" or "impassable"', pointer="/unknown")
        _refuse_infinite(elevation_m, unknown)
        rows, columns = elevation_m.shape
        head: dict[str, Any] = {"cell_size_m": cell_size_m, "origin_m": origin_m, "rows": rows, "columns": columns}
        head |= {"crs": crs, "name": name, "areas": areas, "elevation_m": []}
        names, codes = _codes(surface, (rows, columns))
        blocked = None
        if obstacle is not None:
            blocked = numpy.ascontiguousarray(_layer(obstacle, "obstacle", (rows, columns)).astype(bool).ravel())
        return Map(_native.Map.from_layers(encode(head), elevation_m.ravel(), names, codes, blocked))

    @staticmethod
    def open(
        path: str | os.PathLike[str],
        *,
        nodata_m: float | None = None,
        fill_voids_m: float | None = None,
        cell_size_m: float | None = None,
        origin_m: tuple[float, float] | None = None,
        crs: str | None = None,
    ) -> Map:
        """A map from a file: ``.json`` grid, ``.asc`` ESRI ASCII, ``.tif`` GeoTIFF, ``.npy`` array, ``.hgt`` SRTM tile or ``.yaml`` ROS map.

        ``nodata_m``: elevation of unknown cells besides those that the file marks [m]. ``fill_voids_m``: holes up to this wide are filled
        [m]. ``cell_size_m``, ``origin_m`` and ``crs`` are those of ``from_array``, for ``.npy`` files, where NaN is unknown ground.

        Raises ``InvalidMapError`` with file, place and mend.

        >>> import joulepath, numpy, os, tempfile
        >>> path = os.path.join(tempfile.mkdtemp(), "dem.npy")
        >>> numpy.save(path, numpy.zeros((40, 60), dtype="float32"))
        >>> joulepath.Map.open(path, cell_size_m=0.5).id == joulepath.Map.from_array(numpy.zeros((40, 60)), 0.5).id
        True
        >>> joulepath.Map.open("no-such.tif")
        Traceback (most recent call last):
            ...
        joulepath.errors.InvalidMapError: ...no-such.tif...
        """
        return Map(_native.Map.open(os.fspath(path), nodata_m, fill_voids_m, (cell_size_m, origin_m, crs)))

    @staticmethod
    def from_rasterio(dataset: Any, *, band: int = 1, **layers: Any) -> Map:
        """A map from an open ``rasterio`` dataset of elevations in metres, north up with square cells.

        ``band``: from 1. Cells that the dataset masks are unknown ground. ``layers``: ``surface``, ``obstacle``, ``areas`` and ``name`` of
        ``from_array``, rows from the south.

        Raises ``InvalidMapError`` where cells are not square, turned, or in degrees: warp the dataset to metres first.
        """
        import numpy

        transform = dataset.transform
        east, north = transform.a, -transform.e
        if transform.b or transform.d or east <= 0 or north <= 0 or abs(east - north) > 1e-6 * east:
            detail = (
                f"cells of the raster are {east} by {north} and turned by {transform.b}, {transform.d}: warp it to square cells, north up"
            )
            raise InvalidMapError(detail, pointer="/transform")
        read = dataset.read(band, masked=True)
        z = numpy.flipud(read.astype(numpy.float64).filled(numpy.nan))
        origin_m = (transform.c, transform.f - north * dataset.height)
        crs = None if dataset.crs is None else _text_of_crs(dataset.crs)
        return Map.from_array(z, east, origin_m, crs, unknown="impassable", **layers)

    @staticmethod
    def from_xarray(array: Any, *, crs: str | None = None, **layers: Any) -> Map:
        """A map from an ``xarray.DataArray`` of elevations in metres with coordinates ``x`` and ``y``, the middles of cells.

        ``crs``: by default that of the array's ``rio`` accessor or of its attribute ``crs``. NaN is unknown ground.

        Raises ``ShapeError`` or ``InvalidMapError`` where coordinates are missing or not evenly apart.

        >>> import joulepath, numpy
        >>> yard = joulepath.Map.from_array(numpy.zeros((4, 6)), 0.5, (10.0, 20.0), "EPSG:32632")
        >>> joulepath.Map.from_xarray(yard.to_xarray()).origin_m
        (10.0, 20.0)
        """
        import numpy

        squeezed = array.squeeze()
        missing = [axis for axis in ("y", "x") if axis not in squeezed.coords or axis not in squeezed.dims]
        if missing or squeezed.ndim != 2:
            detail = f"the array has axes {array.dims}, but elevations have y and x with coordinates: rename or select"
            raise ShapeError(detail, pointer="/dims")
        squeezed = squeezed.transpose("y", "x").sortby(["y", "x"])
        x_m, y_m = (numpy.asarray(squeezed[axis], dtype=numpy.float64) for axis in ("x", "y"))
        step_m = _even_step(x_m, "x") or _even_step(y_m, "y")
        across_m = _even_step(y_m, "y") or step_m
        if step_m is None or across_m is None or abs(step_m - across_m) > 1e-6 * step_m:
            raise InvalidMapError(f"cells are {step_m} by {across_m}: resample them to squares", pointer="/coords")
        origin_m = (x_m[0] - step_m / 2, y_m[0] - step_m / 2)
        values = numpy.asarray(squeezed.values, dtype=numpy.float64)
        return Map.from_array(values, step_m, origin_m, crs or _crs_of_xarray(array), unknown="impassable", **layers)

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return self._native.shape

    @property
    def cell_size_m(self) -> float:
        """Edge of a cell [m]."""
        return self._native.cell_size_m

    @property
    def origin_m(self) -> tuple[float, float]:
        """South-west corner of the first cell [m]."""
        return self._native.origin_m

    @property
    def crs(self) -> str | None:
        """The coordinate reference system: ``EPSG:`` and a code, or WKT; ``None`` where it is not known."""
        return self._native.crs

    @property
    def elevation_m(self) -> numpy.typing.NDArray[Any]:
        """Elevations, shape ``(rows, columns)``, row 0 the southernmost, NaN where unknown [m]."""
        return self._native.elevation_m().reshape(self.shape)

    @property
    def obstacle(self) -> numpy.typing.NDArray[Any] | None:
        """True where no robot can be, in the same shape; ``None`` where the map has no obstacles."""
        cells = self._native.obstacle()
        return None if cells is None else cells.reshape(self.shape)

    @property
    def surface(self) -> numpy.typing.NDArray[Any] | None:
        """Names of surfaces in the same shape, ``""`` for the robot's default; ``None`` where the map names none."""
        import numpy

        found = self._native.surface()
        if found is None:
            return None
        names, codes = found
        padded = numpy.full(256, "", dtype=object)
        padded[: len(names)] = names
        return padded[codes].reshape(self.shape)

    @property
    def warnings(self) -> list[dict[str, str]]:
        """What is doubtful about the map: ``kind`` and ``detail`` of each."""
        return json.loads(self._native.warnings())

    @property
    def id(self) -> str:
        """A hash of the content: the id that the service gives the same map."""
        return self._native.content_id()

    def needed_crs(self, crs: str | None) -> str:
        """The map's system of coordinates, or the given one.

        Raises ``MissingCrsError`` where there is neither.
        """
        found = crs or self.crs
        if found is None:
            detail = "the map has no crs: give it one, Map.from_array(..., crs='EPSG:32632'), or name one here, crs='EPSG:32632'"
            raise MissingCrsError(detail, pointer="/map/crs")
        return found

    def to_xarray(self) -> Any:
        """Elevations as an ``xarray.DataArray`` with coordinates of the middles of cells [m]."""
        import numpy

        rows, columns = self.shape
        (x_m, y_m), step_m = self.origin_m, self.cell_size_m
        coords = {"y": y_m + (numpy.arange(rows) + 0.5) * step_m, "x": x_m + (numpy.arange(columns) + 0.5) * step_m}
        attrs = {"units": "m", "crs": self.crs} if self.crs else {"units": "m"}
        return needed("xarray").DataArray(self.elevation_m, coords=coords, dims=("y", "x"), name="elevation_m", attrs=attrs)

    def plot(self, ax: Any = None) -> Any:
        """Draws the ground by ``matplotlib`` and returns the axes."""
        import numpy

        pyplot = needed("matplotlib.pyplot")
        axes = pyplot.gca() if ax is None else ax
        (west, south), (rows, columns), step_m = self.origin_m, self.shape, self.cell_size_m
        z = self.elevation_m
        extent = (west, west + columns * step_m, south, south + rows * step_m)
        image = axes.imshow(z, origin="lower", extent=extent, cmap="terrain", interpolation="nearest")
        axes.figure.colorbar(image, ax=axes, label="elevation [m]", shrink=0.8)
        obstacle = self.obstacle
        if obstacle is not None:
            shown = numpy.ma.masked_where(~obstacle, numpy.ones_like(z))
            axes.imshow(shown, origin="lower", extent=extent, cmap="gray", vmin=0, vmax=2)
        axes.set(xlabel="x [m]", ylabel="y [m]", aspect="equal")
        return axes

    def __repr__(self) -> str:
        rows, columns = self.shape
        return f"Map({rows} x {columns} cells of {self.cell_size_m:g} m, crs={self.crs!r})"

    def _repr_html_(self) -> str:
        rows, columns = self.shape
        warned = [("warning", warning["detail"]) for warning in self.warnings]
        head = [("rows", rows), ("columns", columns), ("cell_size_m", self.cell_size_m), ("crs", self.crs)]
        return table([*head, *warned])


def _layer(values: Any, name: str, shape: tuple[int, int] | None) -> Any:
    """An array of two axes, of a shape where one is given."""
    import numpy

    if isinstance(values, numpy.ma.MaskedArray):
        detail = f"{name} is a masked array: give {name}.filled(numpy.nan)" + (', unknown="impassable"' if name == "z" else "")
        raise MaskedArrayError(detail, pointer=f"/{name}")
    cells = numpy.asarray(values)
    if cells.ndim != 2:
        axes = "axis" if cells.ndim == 1 else "axes"
        detail = f"{name} has {cells.ndim} {axes}, but elevations are rows of columns: reshape it to (rows, columns)"
        raise ShapeError(detail, pointer=f"/{name}")
    if shape is not None and cells.shape != shape:
        detail = f"{name} has shape {cells.shape}, but z has {shape}: give both the same"
        raise ShapeError(detail, pointer=f"/{name}")
    return cells


def _numbers(cells: Any, name: str) -> Any:
    import numpy

    if cells.dtype.kind not in "fiub":
        detail = f"{name} holds {cells.dtype}, but elevations are numbers in metres: {name}.astype(float) turns it"
        raise InvalidMapError(detail, pointer=f"/{name}")
    return numpy.ascontiguousarray(cells, dtype=numpy.float64)


def _refuse_infinite(elevation_m: Any, unknown: str) -> None:
    import numpy

    wrong = numpy.isinf(elevation_m) if unknown == "impassable" else ~numpy.isfinite(elevation_m)
    if wrong.any():
        row, column = (int(place) for place in numpy.argwhere(wrong)[0])
        found = elevation_m[row, column]
        mend = 'unknown="impassable" takes NaN for ground that is not known' if numpy.isnan(found) else "NaN stands for unknown ground"
        raise NotANumberError(f"z[{row}, {column}] is {found}: {mend}", pointer=f"/z/{row}/{column}")


def _codes(surface: Any, shape: tuple[int, int]) -> tuple[list[str], Any]:
    """Distinct names, and by cell the place of its own; -1 for none."""
    import numpy

    if surface is None:
        return [], None
    cells = _layer(surface, "surface", shape).astype(object).ravel()
    texts = numpy.array(["" if cell is None or cell != cell else str(cell) for cell in cells], dtype=str)
    names, codes = numpy.unique(texts, return_inverse=True)
    codes = codes.ravel().astype(numpy.int64)
    codes[names[codes] == ""] = -1
    return [str(name) for name in names], numpy.ascontiguousarray(codes)


def _text_of_crs(crs: Any) -> str:
    """A system of rasterio or pyproj by its code, else as WKT."""
    code = crs.to_epsg()
    return f"EPSG:{code}" if code else crs.to_wkt()


def _crs_of_xarray(array: Any) -> str | None:
    accessor = getattr(array, "rio", None)
    if accessor is not None and getattr(accessor, "crs", None) is not None:
        return _text_of_crs(accessor.crs)
    return array.attrs.get("crs")


def _even_step(places_m: Any, axis: str) -> float | None:
    """Distance between neighbours [m]; ``None`` of one place."""
    import numpy

    if len(places_m) < 2:
        return None
    steps_m = numpy.diff(places_m)
    if (abs(steps_m - steps_m.mean()) > 1e-6 * steps_m.mean()).any():
        detail = f"coordinates {axis} are not evenly apart: resample the array to square cells"
        raise InvalidMapError(detail, pointer=f"/coords/{axis}")
    return float(steps_m.mean())
