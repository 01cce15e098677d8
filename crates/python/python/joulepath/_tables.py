"""Columns of tables in memory as the native half takes them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from .errors import ColumnTypeError, MaskedArrayError, RaggedColumnsError

#: Index of a row without a text.
NO_TEXT = 2**32 - 1


def tuples_of(columns: Mapping[str, Any]) -> list[tuple[Any, ...]]:
    """A tuple for each column: its name, what its values are, and the values."""
    return [(str(name), *_values(str(name), column)) for name, column in columns.items()]


def _values(name: str, column: Any) -> tuple[Any, ...]:
    import numpy

    if isinstance(column, numpy.ma.MaskedArray):
        detail = f"column `{name}` is a masked array: give `{name}.filled(numpy.nan)`, NaN is a gap"
        raise MaskedArrayError(detail, pointer=f"/{name}")
    if hasattr(column, "iloc") and hasattr(column, "cat"):
        return _categories(column)
    array = _array(column)
    if array.ndim != 1:
        detail = f"column `{name}` has shape {array.shape}: give one value by row"
        raise RaggedColumnsError(detail, pointer=f"/{name}")
    kind = array.dtype.kind
    if kind in "fiub":
        return "numbers", numpy.ascontiguousarray(array, dtype=numpy.float64)
    if kind in "mM":
        return _times(name, array)
    if kind in "US":
        return _texts(array)
    return _objects(name, array)


def _array(column: Any) -> Any:
    """An array of a column; extension types of pandas become doubles, or objects where they are no numbers."""
    import numpy

    kind = getattr(getattr(column, "dtype", None), "kind", None)
    if hasattr(column, "isna") and not isinstance(column.dtype, numpy.dtype):
        if kind in ("i", "u", "f", "b"):
            return column.to_numpy(dtype=numpy.float64, na_value=numpy.nan)
        if kind == "M":
            return column.dt.tz_convert("UTC").dt.tz_localize(None).to_numpy()
        return column.to_numpy(dtype=object)
    return numpy.asarray(column)


def _times(name: str, array: Any) -> tuple[Any, ...]:
    import numpy

    unit, count = numpy.datetime_data(array.dtype)
    if unit not in ("s", "ms", "us", "ns") or count != 1:
        detail = f"column `{name}` holds {array.dtype}: turn it into seconds, or into datetime64[ns]"
        raise ColumnTypeError(detail, pointer=f"/{name}")
    values = array.astype(numpy.int64).astype(numpy.float64)
    values[numpy.isnat(array)] = numpy.nan
    return unit, values


def _texts(array: Any) -> tuple[Any, ...]:
    import numpy

    names, index = numpy.unique(array.astype(str), return_inverse=True)
    return "texts", [str(name) for name in names], numpy.ascontiguousarray(index.ravel(), dtype=numpy.uint32)


def _categories(column: Any) -> tuple[Any, ...]:
    import numpy

    codes = column.cat.codes.to_numpy().astype(numpy.int64)
    index = numpy.where(codes < 0, NO_TEXT, codes).astype(numpy.uint32)
    return "texts", [str(name) for name in column.cat.categories], numpy.ascontiguousarray(index)


def _objects(name: str, array: Any) -> tuple[Any, ...]:
    """Texts, where nothing else is there; else a column of no use, which is refused where it is needed."""
    import numpy

    places: dict[str, int] = {}
    index, missing = numpy.empty(len(array), dtype=numpy.uint32), _na()
    for row, value in enumerate(array):
        if value is None or value is missing or value != value:
            index[row] = NO_TEXT
        elif isinstance(value, str):
            index[row] = places.setdefault(value, len(places))
        else:
            kind = type(value).__name__
            reason = f"it holds Python objects ({kind} in row {row + 1}); turn them by df[{name!r}].astype(float)"
            return "unusable", reason, len(array)
    return "texts", list(places), index


def _na() -> Any:
    """The missing value of pandas, where pandas is there."""
    import sys

    pandas = sys.modules.get("pandas")
    return None if pandas is None else pandas.NA
