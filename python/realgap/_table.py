"""Tables: columns by name, as pandas or polars frames where these are installed."""

from __future__ import annotations

import html
import math
from typing import TYPE_CHECKING, Dict, Iterator, List, Mapping, Union

import numpy as np

from ._array import Floats
from ._error import usage

if TYPE_CHECKING:
    import pandas
    import polars

# More rows than this are not shown in a notebook.
ROWS_SHOWN = 20
Cell = Union[None, bool, int, float, str]


class Table(Mapping[str, List[Cell]]):
    """Columns by name; each is a list, with `None` in empty cells.

    >>> answer.points["floor.friction"]
    [0.2, 0.5, 0.8]
    """

    def __init__(self, columns: Mapping[str, List[Cell]]) -> None:
        self._columns: Dict[str, List[Cell]] = dict(columns)

    def __getitem__(self, name: str) -> List[Cell]:
        return self._columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    @property
    def rows(self) -> int:
        """The number of rows.

        >>> answer.points.rows
        3
        """
        return max(map(len, self._columns.values()), default=0)

    def numbers(self, name: str) -> Floats:
        """A column of numbers as an array, with NaN in empty cells.

        >>> answer.points.numbers("score").shape
        (3,)
        """
        found: List[float] = []
        for cell in self[name]:
            if isinstance(cell, str):
                raise usage("not a column of numbers", field=name, found=f"the text {cell!r}")
            found.append(math.nan if cell is None else float(cell))
        return np.array(found)

    def to_dict(self) -> Dict[str, List[Cell]]:
        """The columns as a dict of lists.

        >>> sorted(ensemble.repeats.to_dict())
        ['case', 'net_displacement_m', 'repeat']
        """
        return {name: list(column) for name, column in self._columns.items()}

    def to_pandas(self) -> "pandas.DataFrame":
        """A pandas frame.

        >>> answer.points.to_pandas().shape[0]
        3
        """
        import pandas

        return pandas.DataFrame(self.to_dict())

    def to_polars(self) -> "polars.DataFrame":
        """A polars frame.

        >>> answer.points.to_polars().height
        3
        """
        import polars

        return polars.DataFrame(self.to_dict(), infer_schema_length=None)

    def __repr__(self) -> str:
        return f"Table of {self.rows} rows: {', '.join(self._columns)}"

    def _repr_html_(self) -> str:
        head = "".join(f"<th>{html.escape(name)}</th>" for name in self._columns)
        shown = zip(*(column[:ROWS_SHOWN] for column in self._columns.values()))
        body = "".join(
            "<tr>" + "".join(f"<td>{html.escape(_text(cell))}</td>" for cell in row) + "</tr>"
            for row in shown
        )
        more = self.rows - ROWS_SHOWN
        note = f"<p>… and {more} more rows</p>" if more > 0 else ""
        return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>{note}"


def _text(cell: Cell) -> str:
    if cell is None:
        return ""
    return f"{cell:.6g}" if isinstance(cell, float) else str(cell)
