"""Tables: columns by name, as pandas or polars frames where these are installed."""

from __future__ import annotations

import html
from typing import TYPE_CHECKING, Any, Dict, Iterator, List, Mapping

if TYPE_CHECKING:
    import pandas
    import polars

# More rows than this are not shown in a notebook.
ROWS_SHOWN = 20


class Table(Mapping[str, List[Any]]):
    """Columns by name; each is a list, with `None` where there is nothing."""

    def __init__(self, columns: Mapping[str, List[Any]]) -> None:
        self._columns: Dict[str, List[Any]] = dict(columns)

    def __getitem__(self, name: str) -> List[Any]:
        return self._columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    @property
    def rows(self) -> int:
        """How many rows there are."""
        return len(next(iter(self._columns.values()), []))

    def to_dict(self) -> Dict[str, List[Any]]:
        """The columns as a dict of lists."""
        return {name: list(column) for name, column in self._columns.items()}

    def to_pandas(self) -> "pandas.DataFrame":
        """A pandas frame."""
        import pandas

        return pandas.DataFrame(self.to_dict())

    def to_polars(self) -> "polars.DataFrame":
        """A polars frame."""
        import polars

        return polars.DataFrame(self.to_dict(), infer_schema_length=None)

    def __repr__(self) -> str:
        return f"Table of {self.rows} rows: {', '.join(self._columns)}"

    def _repr_html_(self) -> str:
        head = "".join(f"<th>{html.escape(name)}</th>" for name in self._columns)
        shown = zip(*(column[:ROWS_SHOWN] for column in self._columns.values()))
        body = "".join(
            "<tr>" + "".join(f"<td>{html.escape(_cell(value))}</td>" for value in row) + "</tr>"
            for row in shown
        )
        more = self.rows - ROWS_SHOWN
        note = f"<p>… and {more} more rows</p>" if more > 0 else ""
        return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>{note}"


def _cell(value: Any) -> str:
    if value is None:
        return ""
    return f"{value:.6g}" if isinstance(value, float) else str(value)
