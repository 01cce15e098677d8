"""Prints places of many systems by PROJ: code, longitude, latitude, easting, northing [unit of the system], one a line.

The systems are of all continents; three places each lie within the area that the registry says the system is for.
"""

import pyproj

CODES = [
    32632, 32719, 32733, 25832, 25833, 25830, 3035, 2154, 3006, 3067, 2180, 3346, 3301, 3059, 3765, 5636,  # Europe
    26915, 26917, 32736, 5070, 3347, 3978, 3005, 2263, 2225, 2277, 6414, 6588, 3578, 3112,  # North America, Australia
    31983, 32755, 28355, 7855, 2193, 20255, 2326, 5179, 5186, 3826, 7760, 3116, 2048, 22185,
    8325, 8068, 7117, 7111, 6798, 8335, 8345,  # cones of one parallel with a scale
    3413, 3031, 3857, 3395, 27700, 28992, 29902, 2056, 31467, 5514, 24378, 4326, 9473,
]

for code in CODES:
    crs = pyproj.CRS.from_epsg(code)
    area = crs.area_of_use
    project = pyproj.Transformer.from_crs(4326, code, always_xy=True)
    width = area.east - area.west + (360 if area.east < area.west else 0)
    for share_x, share_y in [(0.3, 0.3), (0.5, 0.6), (0.7, 0.4)]:
        longitude = area.west + share_x * width
        longitude -= 360 if longitude > 180 else 0
        latitude = area.south + share_y * (area.north - area.south)
        easting, northing = project.transform(longitude, latitude)
        print(code, repr(longitude), repr(latitude), repr(easting), repr(northing))
