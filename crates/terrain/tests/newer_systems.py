"""Prints the projected systems of the EPSG registry that the crate `crs-definitions` does not have, as `src/crs/epsg/newer.txt` holds them.

Its argument is that file, whose codes are looked up anew; needs pyproj (the file: pyproj 3.7.2, PROJ 9.5.1, EPSG v11.022).
A line is a code and its definition for PROJ. What PROJ has no definition for has its method and unit.
"""

import re
import sys

from pyproj import CRS


def definition(code):
    system = CRS.from_epsg(code)
    try:
        words = system.to_proj4().split()
    except Exception:
        words = []
    if not words:
        method = re.sub("[^a-z0-9]", "", system.coordinate_operation.method_name.lower())
        words = [f"+proj={method}", f"+to_meter={system.axis_info[0].unit_conversion_factor}"]
    words = [word for word in words if word not in ("+no_defs", "+type=crs")]
    axes = "".join(axis.direction[0] for axis in system.axis_info[:2])
    # Of polar systems both axes run north or both south, along meridians.
    if "w" in axes and not any(word.startswith("+axis=") for word in words):
        words.append(f"+axis={axes}u")
    return " ".join(words)


for line in open(sys.argv[1], encoding="ascii"):
    code = int(line.split()[0])
    print(code, definition(code))
