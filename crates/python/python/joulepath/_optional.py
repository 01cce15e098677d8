"""Packages that some functions need and the package itself does not."""

from __future__ import annotations

import importlib
from typing import Any

from .errors import NotInstalledError

#: Extras of the package that bring what is needed.
EXTRAS = {
    "pandas": "tables",
    "pyarrow": "tables",
    "rasterio": "maps",
    "xarray": "maps",
    "matplotlib.pyplot": "plots",
    "geopandas": "earth",
    "shapely": "earth",
    "ray": "ray",
    "pyarrow.fs": "ray",
    "scipy": "ray",
    "jinja2": "ray",
}


def needed(name: str) -> Any:
    """A package, or ``NotInstalledError`` that says how to install it."""
    try:
        return importlib.import_module(name)
    except ImportError as error:
        top = name.split(".")[0]
        extra = EXTRAS.get(name)
        way = f"pip install 'joulepath[{extra}]'" if extra else f"pip install {top}"
        raise NotInstalledError(f"{top} is needed for this and cannot be imported ({error}): {way}") from error
