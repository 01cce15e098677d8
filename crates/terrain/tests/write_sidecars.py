"""Writes GeoTIFFs with files beside them into a folder, and what rasterio reads of each as JSON to standard output."""

import json
import sys
import warnings
from pathlib import Path

import numpy as np
import rasterio
from rasterio.transform import from_origin

warnings.filterwarnings("ignore")
FOLDER = Path(sys.argv[1])
ROWS, COLUMNS = 3, 4
SAMPLES = np.arange(ROWS * COLUMNS, dtype="float32").reshape(ROWS, COLUMNS)
PLACED = {"transform": from_origin(500_000, 5_000_000, 2, 2), "crs": "EPSG:32632"}
WORLD = "0.5\n0\n0\n-0.5\n500000.25\n4999999.75\n"
FEET = 0.3048


def write(name, **profile):
    path = FOLDER / f"{name}.tif"
    shape = {"height": ROWS, "width": COLUMNS, "count": 1, "dtype": "float32"}
    with rasterio.open(path, "w", driver="GTiff", **shape, **profile) as file:
        file.write(SAMPLES, 1)
    return path


def beside(path, ending, text):
    (FOLDER / f"{path.name}{ending}").write_text(text)


def aux(*parts, band=""):
    return f'<PAMDataset>{"".join(parts)}<PAMRasterBand band="1">{band}</PAMRasterBand></PAMDataset>'


def mask(path, shown):
    with rasterio.Env(GDAL_TIFF_INTERNAL_MASK=False), rasterio.open(path, "r+") as file:
        file.write_mask(np.where(shown, 255, 0).astype("uint8"))


def read(path):
    """Elevation in metres, row by row from the south, null where unknown."""
    with rasterio.open(path) as file:
        heights = file.read(1).astype("float64") * file.scales[0] + file.offsets[0]
        heights *= FEET if file.units[0] == "ft" else 1
        # Of several marks of unknown ground GDAL knows one; every mark counts here.
        known = (file.read_masks(1) > 0) & (file.read(1) != file.nodata)
        rows = [[float(z) if k else None for z, k in zip(*row)] for row in zip(heights[::-1], known[::-1])]
        origin = [file.transform.c, file.transform.f + ROWS * file.transform.e]
        code = file.crs.to_epsg() if file.crs else None
        return {"cell_size_m": file.transform.a, "origin_m": origin, "epsg": code, "elevation_m": rows}


world = write("world")
(FOLDER / "world.tfw").write_text(WORLD)
both = write("both", **PLACED)
(FOLDER / "both.tfw").write_text(WORLD)
bare = write("bare")
transform = "<GeoTransform>500000, 2, 0, 5000000, 0, -2</GeoTransform>"
srs = "<SRS>" + rasterio.crs.CRS.from_epsg(32633).to_wkt().replace('"', "&quot;") + "</SRS>"
beside(bare, ".aux.xml", aux(srs, transform, band="<NoDataValue>5</NoDataValue>"))
over = write("over", nodata=3, **PLACED)
band = "<NoDataValue>7</NoDataValue><Scale>0.5</Scale><Offset>-2</Offset><UnitType>ft</UnitType>"
beside(over, ".aux.xml", aux(srs, band=band))
hidden = write("hidden", nodata=3, **PLACED)
mask(hidden, SAMPLES != 9)
print(json.dumps({path.stem: read(path) for path in (world, both, bare, over, hidden)}))
