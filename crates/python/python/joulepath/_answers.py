"""Answers: the API's documents with their fields as attributes."""

from __future__ import annotations

import html
import json
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy
    import numpy.typing


class Columns(Mapping[str, "numpy.typing.NDArray[Any]"]):
    """Columns by name, all of one length: a mapping from names to numpy arrays.

    >>> import numpy
    >>> columns = Columns({"t_s": numpy.array([0.0, 0.5])})
    >>> columns["t_s"].tolist(), list(columns), columns.rows
    ([0.0, 0.5], ['t_s'], 2)
    """

    def __init__(self, columns: Mapping[str, numpy.typing.NDArray[Any]]) -> None:
        self._columns = dict(columns)

    def __getitem__(self, name: str) -> numpy.typing.NDArray[Any]:
        try:
            return self._columns[name]
        except KeyError:
            raise KeyError(f"no column {name!r}; there are {', '.join(self._columns)}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    @property
    def rows(self) -> int:
        """Number of rows."""
        return next((column.shape[0] if column.ndim else 1 for column in self._columns.values()), 0)

    def to_pandas(self) -> Any:
        """The columns as a ``pandas.DataFrame``."""
        from ._optional import needed

        return needed("pandas").DataFrame(self._columns)

    def __repr__(self) -> str:
        return f"Columns({', '.join(self._columns)}; {self.rows} rows)"


class Answer:
    """An answer of the API: the fields of its document are attributes."""

    def __init__(self, document: dict[str, Any] | str) -> None:
        self._text = document if isinstance(document, str) else None
        self._parsed = None if isinstance(document, str) else document

    @property
    def _document(self) -> dict[str, Any]:
        if self._parsed is None:
            self._parsed = json.loads(self._text or "{}")
        return self._parsed

    def to_dict(self) -> dict[str, Any]:
        """The document that the HTTP API answers with."""
        return self._document

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        try:
            return self._document[name]
        except KeyError:
            known = ", ".join(self._document)
            raise AttributeError(f"{type(self).__name__} has no {name!r}; there are {known}") from None

    def __getitem__(self, name: str) -> Any:
        return self._document[name]

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *self._document})

    def __repr__(self) -> str:
        shown = (f"{name}={_short(value)}" for name, value in self._scalars())
        return f"{type(self).__name__}({', '.join(shown)})"

    def _scalars(self) -> list[tuple[str, Any]]:
        """The fields of one value each, for showing."""
        return [(name, value) for name, value in self._document.items() if not isinstance(value, (list, dict))]

    def _repr_html_(self) -> str:
        return table(self._scalars())


def _short(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else repr(value)


def table(rows: list[tuple[str, Any]]) -> str:
    """An HTML table of names and values."""
    cells = (f"<tr><th>{html.escape(name)}</th><td>{html.escape(_short(value))}</td></tr>" for name, value in rows)
    return f"<table>{''.join(cells)}</table>"


def page(document: str, height_px: int = 480) -> str:
    """A whole HTML page within a notebook, apart from its styles."""
    source = html.escape(document, quote=True)
    return f'<iframe srcdoc="{source}" style="width: 100%; height: {height_px}px; border: 0" sandbox></iframe>'
