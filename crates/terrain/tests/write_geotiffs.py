"""Writes GeoTIFFs of every layout with GDAL, and what rasterio itself reads in them.

    write_geotiffs.py FOLDER

For each file NAME.tif there is NAME.f64: rows from the north, heights after scale and offset, NaN where nothing is known.
index.json lists them with the transform that rasterio gives.
"""

import itertools
import json
import sys
import warnings
from pathlib import Path

import numpy
import rasterio
from rasterio.enums import ColorInterp
from rasterio.shutil import copy
from rasterio.transform import Affine, from_origin

ROWS, COLUMNS = 37, 53
NORTH_UP = from_origin(512000, 5423000, 2, 2)
CODECS = ["NONE", "LZW", "DEFLATE", "PACKBITS", "ZSTD", "LERC", "LERC_DEFLATE", "LERC_ZSTD"]
TYPES = ["uint8", "int8", "uint16", "int16", "uint32", "int32", "uint64", "int64", "float32", "float64"]
BLOCKS = [
    {"blockysize": 1},
    {"blockysize": 16},
    {"blockysize": ROWS},
    {"tiled": True, "blockxsize": 16, "blockysize": 16},
    {"tiled": True, "blockxsize": 64, "blockysize": 32},
]

warnings.filterwarnings("ignore")
folder = Path(sys.argv[1])
index = []


def heights(kind):
    row, column = numpy.mgrid[0:ROWS, 0:COLUMNS]
    z = 100 + 20 * numpy.sin(row / 5) + 0.7 * column
    z = numpy.rint(z) if numpy.dtype(kind).kind in "iu" else z + 0.37
    return (z.clip(max=120) if kind == "int8" else z).astype(kind)


def expect(name):
    """What rasterio reads in the file."""
    path = folder / f"{name}.tif"
    with rasterio.open(path) as file:
        z = file.read(1, masked=True).astype("float64").filled(numpy.nan) * file.scales[0] + file.offsets[0]
        z.astype("<f8").tofile(folder / f"{name}.f64")
        index.append({"name": name, "rows": file.height, "columns": file.width, "transform": list(file.transform)[:6]})


def write(name, bands, then=lambda file: None, **options):
    bands = numpy.atleast_3d(bands.T).T
    profile = {"driver": "GTiff", "crs": "EPSG:32632", "transform": NORTH_UP, "dtype": bands.dtype.name}
    profile |= {"count": bands.shape[0], "height": bands.shape[1], "width": bands.shape[2]} | options
    try:
        with rasterio.open(folder / f"{name}.tif", "w", **profile) as file:
            file.write(bands)
            then(file)
    except rasterio.errors.RasterioError:
        # LERC is not for integers of 64 bits, and says so.
        if not ("lerc" in name and "int64" in name):
            raise
        (folder / f"{name}.tif").unlink(missing_ok=True)
        return
    expect(name)


for codec, (block, options), kind, endianness in itertools.product(
    CODECS, enumerate(BLOCKS), TYPES, ["LITTLE", "BIG"]
):
    floating = kind.startswith("float")
    predictors = [1, 2] + [3] * floating if codec in ("LZW", "DEFLATE", "ZSTD") else [1]
    for predictor in predictors:
        more = {"predictor": predictor} if predictor > 1 else {}
        name = f"{codec.lower()}-p{predictor}-{kind}-block{block}-{endianness.lower()}"
        write(name, heights(kind), compress=codec, ENDIANNESS=endianness, **options, **more)

holes = heights("float32")
holes[5:9, 30:35] = numpy.nan
for codec in CODECS:
    write(f"nan-{codec.lower()}", holes, compress=codec, nodata=numpy.nan, tiled=True, blockxsize=16, blockysize=16)
for text, value in [("-9999", -9999), ("-3.4028234663852886e+38", numpy.finfo("float32").min), ("0.1", 0.1)]:
    marked = numpy.where(numpy.isnan(holes), numpy.float32(value), holes)
    write(f"nodata{text}", marked, nodata=float(text), compress="DEFLATE")
for kind in ["uint8", "int16", "uint16", "int32", "float64"]:
    mark = {"uint8": 255, "uint16": 65535}.get(kind, -32768)
    marked = heights(kind)
    marked[3:6, 4:9] = mark
    write(f"nodata-{kind}", marked, nodata=mark)

for bands, interleave, codec in itertools.product([2, 4], ["PIXEL", "BAND"], ["NONE", "LZW", "DEFLATE", "LERC"]):
    for kind in ["int16", "float32"]:
        several = numpy.stack([heights(kind) + n for n in range(bands)])
        more = {"predictor": 2} if codec in ("LZW", "DEFLATE") else {}
        name = f"bands{bands}-{interleave.lower()}-{codec.lower()}-{kind}"
        write(name, several, interleave=interleave, compress=codec, photometric="MINISBLACK", **more)
write("bigtiff", heights("float32"), BIGTIFF="YES", compress="DEFLATE", predictor=3)
write("bigtiff-big", heights("float64"), BIGTIFF="YES", ENDIANNESS="BIG")
write("nbits12", heights("uint16"), NBITS=12)
write("nbits7", heights("uint8").clip(max=127), NBITS=7, compress="DEFLATE")
write("float16", heights("float32"), NBITS=16)
write("miniswhite", heights("float32"), photometric="MINISWHITE")


def sparse(name, **options):
    profile = {"driver": "GTiff", "crs": "EPSG:32632", "transform": NORTH_UP, "dtype": "float32", "count": 1}
    profile |= {"height": 128, "width": 160, "tiled": True, "blockxsize": 32, "blockysize": 32, "SPARSE_OK": True}
    with rasterio.open(folder / f"{name}.tif", "w", **(profile | options)) as file:
        window = rasterio.windows.Window(32, 64, COLUMNS, ROWS)
        file.write(heights("float32"), 1, window=window)
    expect(name)


sparse("sparse-nodata", compress="DEFLATE", nodata=-9999)
sparse("sparse-zero", compress="LZW")
sparse("sparse-strips", tiled=False, nodata=-9999, blockxsize=None, blockysize=8)


def scaled(file):
    file.scales, file.offsets = (0.1,), (-20.0,)


write("scale-int16", heights("int16"), scaled)
write("scale-uint16", (heights("uint16") * 300).astype("uint16"), lambda f: setattr(f, "scales", (0.01,)))
write("scale-nodata", numpy.where(heights("int16") > 130, -9999, heights("int16")), scaled, nodata=-9999)

with rasterio.Env(GDAL_TIFF_INTERNAL_MASK=True):
    shown = numpy.full((ROWS, COLUMNS), 255, "uint8")
    shown[10:14, 20:31] = 0
    for codec, options in itertools.product(["NONE", "DEFLATE", "LZW", "LERC"], BLOCKS[1:4]):
        name = f"mask-{codec.lower()}-{len(options)}-{options['blockysize']}"
        write(name, heights("float32"), lambda file: file.write_mask(shown), compress=codec, **options)
    write("mask-big-endian", heights("int16"), lambda file: file.write_mask(shown), ENDIANNESS="BIG")

    tall = numpy.tile(heights("float32"), (20, 20))
    write("large", tall, lambda file: file.write_mask(numpy.tile(shown, (20, 20))), compress="DEFLATE")
    for codec in ["DEFLATE", "LZW", "ZSTD", "LERC"]:
        cog = f"cog-{codec.lower()}"
        more = {} if codec == "LERC" else {"predictor": "YES"}
        copy(folder / "large.tif", folder / f"{cog}.tif", driver="COG", compress=codec, blocksize=128, **more)
        expect(cog)


def alpha(file):
    file.colorinterp = [ColorInterp.gray, ColorInterp.alpha]


for interleave in ["PIXEL", "BAND"]:
    bands = numpy.stack([heights("uint8"), shown])
    write(f"alpha-{interleave.lower()}", bands, alpha, interleave=interleave, photometric="MINISBLACK", ALPHA="YES")

south_up = Affine(2, 0, 512000, 0, 2, 5422926)
write("south-up", heights("float32"), transform=south_up)
write("west-up", heights("float32"), transform=Affine(-2, 0, 512106, 0, -2, 5423000))
with rasterio.Env(GTIFF_POINT_GEO_IGNORE=False):
    write("point", heights("float32"), lambda file: file.update_tags(AREA_OR_POINT="Point"))

(folder / "index.json").write_text(json.dumps(index))
print(len(index), "files")
