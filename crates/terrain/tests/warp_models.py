"""Writes elevation models in degrees, and what GDAL makes of them on the grids that the program warps them to.

    warp_models.py write FOLDER        files NAME.tif (and a .asc with its .prj), listed in index.json
    warp_models.py warp FOLDER         reads grids.json: for each NAME a frame; writes NAME.f64, rows from the north, NaN where unknown
"""

import json
import sys
from pathlib import Path

import numpy
import pyproj
import rasterio
from rasterio.io import MemoryFile
from rasterio.transform import Affine, from_origin
from rasterio.vrt import WarpedVRT
from rasterio.warp import Resampling

# GDAL interpolates positions along a row to within this; an eighth of a cell if it is told nothing.
POSITION_TOLERANCE_CELLS = 0.001

# Name, system, west, south, columns, rows, width and height of a cell [deg].
MODELS = [
    ("north", 4326, 9.16, 48.95, 300, 200, 1 / 3600, 1 / 3600),
    ("oblong", 4258, 24.9, 60.1, 240, 160, 2 / 3600, 1 / 3600),
    ("south", 7844, 151.1, -33.9, 150, 200, 1 / 3600, 1 / 3600),
    ("equator", 4979, -78.51, -0.02, 160, 160, 1 / 3600, 1 / 3600),
    ("dateline", 4326, 179.95, -17.0, 400, 150, 1 / 3600, 1 / 3600),
    ("turns", 4326, 266.1, 46.5, 150, 150, 1 / 3600, 1 / 3600),
    ("edge", 4269, -96.01, 46.5, 200, 150, 1 / 3600, 1 / 3600),
    ("fine", 4326, 9.16, 48.95, 200, 300, 2e-6, 1.5e-6),
    ("arctic", 4326, 20.0, 79.9, 500, 100, 3 / 3600, 1 / 3600),
]


def heights(columns, rows):
    row, column = numpy.mgrid[0:rows, 0:columns]
    return (300 + 40 * numpy.sin(row / 9) + 25 * numpy.cos(column / 7) + 0.3 * column).astype("float64")


def frame(west, south, rows, width, height):
    return from_origin(west, south + rows * height, width, height)


def write(folder):
    for name, code, west, south, columns, rows, width, height in MODELS:
        z = heights(columns, rows)
        profile = {"driver": "GTiff", "width": columns, "height": rows, "count": 1, "dtype": "float64"}
        profile |= {"crs": f"EPSG:{code}", "transform": frame(west, south, rows, width, height)}
        with rasterio.open(folder / f"{name}.tif", "w", **profile) as file:
            file.write(z, 1)
    (folder / "index.json").write_text(json.dumps([model[0] for model in MODELS]))


def warp(folder):
    models = {model[0]: model[1:] for model in MODELS}
    for grid in json.loads((folder / "grids.json").read_text()):
        _, west, south, columns, rows, width, height = models[grid["name"]]
        # GDAL of the test sees longitudes from -180, as PROJ has them.
        west -= 360 if west > 180 else 0
        crs = pyproj.CRS(grid["crs"])
        if west < 180 < west + columns * width:
            # GDAL does not warp across 180 degrees: the same ground half way round the globe, 30 zones on.
            west -= 180
            zone = int(grid["crs"][-2:])
            crs = pyproj.CRS.from_epsg(int(grid["crs"][5:]) + (30 if zone <= 30 else -30))
        z = heights(columns, rows)
        cell = grid["cell_size_m"]
        north = grid["origin_m"][1] + grid["rows"] * cell
        # WGS 84 on both sides: GDAL may shift other datums by a metre or two, which the program sets equal.
        profile = {"driver": "GTiff", "width": columns, "height": rows, "count": 1, "dtype": "float64"}
        profile |= {"crs": "EPSG:4326", "transform": frame(west, south, rows, width, height)}
        with MemoryFile() as memory:
            with memory.open(**profile) as file:
                file.write(z, 1)
            target = {"crs": crs.to_wkt(), "width": grid["columns"], "height": grid["rows"], "nodata": numpy.nan}
            target["transform"] = Affine(cell, 0, grid["origin_m"][0], 0, -cell, north)
            with memory.open() as file, WarpedVRT(
                file, resampling=Resampling.bilinear, tolerance=POSITION_TOLERANCE_CELLS, **target
            ) as warped:
                out = warped.read(1)
        out.tofile(folder / f"{grid['name']}.f64")
        # Places by PROJ: centres of the source's cells in the grid's system.
        project = pyproj.Transformer.from_crs(4326, crs, always_xy=True)
        row, column = numpy.mgrid[0:rows:7, 0:columns:7]
        x, y = project.transform(west + (column + 0.5) * width, south + (rows - row - 0.5) * height)
        numpy.stack([x, y, z[::7, ::7]], axis=-1).tofile(folder / f"{grid['name']}.places")


{"write": write, "warp": warp}[sys.argv[1]](Path(sys.argv[2]))
