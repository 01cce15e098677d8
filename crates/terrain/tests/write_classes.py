"""Writes rasters of classes into a folder, and to standard output, as JSON, which class lies at the centre of each of a map's cells."""

import json
import sys
import warnings
from pathlib import Path

import numpy as np
import rasterio
from pyproj import Transformer
from rasterio.transform import from_origin

warnings.filterwarnings("ignore")
FOLDER = Path(sys.argv[1])
MAP = {"crs": "EPSG:32632", "origin_m": [512_000.0, 5_422_960.0], "rows": 90, "columns": 120, "cell_size_m": 2.0}
CLASSES = np.array([10, 30, 40, 50, 80, 90, 100], dtype="uint8")


def places():
    x = MAP["origin_m"][0] + (np.arange(MAP["columns"]) + 0.5) * MAP["cell_size_m"]
    y = MAP["origin_m"][1] + (np.arange(MAP["rows"]) + 0.5) * MAP["cell_size_m"]
    return np.meshgrid(x, y)


def write(name, crs, step, **profile):
    """A patchwork of classes over the map and beyond, and the class at each cell's centre by rasterio."""
    x, y = places()
    to = Transformer.from_crs(MAP["crs"], crs, always_xy=True)
    at_x, at_y = to.transform(x, y)
    west, north = at_x.min() - 3.3 * step, at_y.max() + 2.7 * step
    columns, rows = (int(np.ceil(span / step)) + 7 for span in (np.ptp(at_x), np.ptp(at_y)))
    rng = np.random.default_rng(7)
    patches = rng.choice(CLASSES, (rows // 3 + 1, columns // 3 + 1)).repeat(3, 0).repeat(3, 1)[:rows, :columns]
    speckled = np.where(rng.random((rows, columns)) < 0.1, 0, patches).astype("uint8")
    path = FOLDER / f"{name}.tif"
    shape = {"height": rows, "width": columns, "count": 1, "dtype": "uint8", "nodata": 0}
    placed = {"crs": crs, "transform": from_origin(west, north, step, step)}
    with rasterio.open(path, "w", driver="GTiff", **shape, **placed, **profile) as file:
        file.write(speckled, 1)
        if profile.get("photometric") == "palette":
            file.write_colormap(1, {int(c): (int(c), 9, 200) for c in CLASSES})
    with rasterio.open(path) as file:
        points = np.column_stack([at_x.ravel(), at_y.ravel()])
        classes = np.array([value[0] for value in file.sample(points)]).reshape(x.shape)
        rows_f, columns_f = (np.array(at) for at in rasterio.transform.rowcol(file.transform, at_x.ravel(), at_y.ravel(), op=float))
    # Centres within a centimetre of a pixel's edge may be on either side of it.
    near = np.minimum(np.abs(rows_f - np.round(rows_f)), np.abs(columns_f - np.round(columns_f)))
    per_m = step if step > 0.1 else step * 111_000
    return {"classes": classes.tolist(), "is_plain": (near * per_m > 0.01).reshape(x.shape).tolist()}


tiled = {"tiled": True, "blockxsize": 16, "blockysize": 16, "compress": "deflate"}
answer = {
    "map": MAP,
    "rasters": {
        # As ESA WorldCover: 1/12000 degree, palette, tiles.
        "worldcover": write("worldcover", "EPSG:4326", 1 / 12_000, photometric="palette", **tiled),
        "same": write("same", "EPSG:32632", 7.0),
        "finer": write("finer", "EPSG:25832", 1.3, compress="lzw"),
        "national": write("national", "EPSG:3035", 10.0, **tiled),
    },
}
print(json.dumps(answer))
