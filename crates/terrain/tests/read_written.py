"""Reads a GeoTIFF by rasterio: where the centre of its first cell lies on WGS 84, and its system's code if it has one."""

import json
import sys

import pyproj
import rasterio

with rasterio.open(sys.argv[1]) as file:
    x, y = file.xy(0, 0)
    try:
        place = pyproj.Transformer.from_crs(file.crs, "EPSG:4326", always_xy=True).transform(x, y)
    except pyproj.exceptions.ProjError:
        place = None  # A frame of the file's own.
    print(json.dumps({"place_deg": place, "epsg": file.crs.to_epsg() if file.crs else None, "crs": str(file.crs)}))
