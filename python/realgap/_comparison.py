"""How far motions are apart."""

from __future__ import annotations

import json
from typing import Any, Dict, List, Optional, Sequence, Union

from . import _native
from ._array import asked
from ._callback import Metric, native_metric
from ._picture import one, page
from ._table import Table
from ._trajectory import Trajectories, Trajectory, native_trajectory

AnyMetric = Union[str, Metric]


class Comparison:
    """Motions against a reference: a row each, a column a metric."""

    def __init__(
        self,
        reference: Trajectory,
        others: Sequence[Trajectory],
        metrics: Optional[Sequence[AnyMetric]],
        how: str,
    ) -> None:
        self._reference = reference
        self._others = list(others)
        self._metrics = None if metrics is None else [native_metric(metric) for metric in metrics]
        self._how = how
        self._rows: List[Dict[str, Any]] = json.loads(self._ask(None))

    def _ask(self, picture: Optional[str]) -> str:
        others = [native_trajectory(other) for other in self._others]
        reference = native_trajectory(self._reference)
        return _native.compare(reference, others, self._metrics, self._how, picture)

    @property
    def rows(self) -> List[Dict[str, Any]]:
        """A dict a motion."""
        return [dict(row) for row in self._rows]

    @property
    def table(self) -> Table:
        """A row a motion."""
        names = [name for name in self._rows[0] if name != "warnings"] if self._rows else []
        return Table({name: [row[name] for row in self._rows] for name in names})

    @property
    def warnings(self) -> List[Dict[str, str]]:
        """What the reader should know, each once."""
        found: List[Dict[str, str]] = []
        for row in self._rows:
            found.extend(warning for warning in row["warnings"] if warning not in found)
        return found

    def distance(self, index: int = 0) -> float:
        """The first distance of a motion: the only one where one metric was asked for."""
        row = self._rows[index]
        first = [name for name in row if name not in _NOT_DISTANCES][0]
        return float(row[first])

    def __float__(self) -> float:
        """The distance, where one motion is compared by one metric."""
        return self.distance()

    def picture(self) -> bytes:
        """The aligned paths, a PNG."""
        return one(self._ask)

    def __repr__(self) -> str:
        return "\n".join(
            ", ".join(
                f"{name} {value:.6g}" if isinstance(value, float) else f"{value}"
                for name, value in row.items()
                if name not in ("warnings", "reference")
            )
            for row in self._rows
        )

    def _repr_html_(self) -> str:
        return self.table._repr_html_() + page("", [self.picture()], self.warnings)


_NOT_DISTANCES = ("trajectory", "reference", "net_displacement_m", "warnings")


def compare(
    reference: Trajectory,
    others: Trajectories,
    metric: Union[AnyMetric, Sequence[AnyMetric], None] = None,
    *,
    components: Optional[int] = None,
    variance: Optional[float] = None,
    body_length_m: Optional[float] = None,
    equal_times: bool = False,
) -> Comparison:
    """Compares motions with a reference, prepared as `prepare` does it; without a metric, by all that need positions only."""
    many = list(others) if isinstance(others, (list, tuple)) else [others]
    metrics: Optional[List[AnyMetric]] = None
    if metric is not None:
        metrics = [metric] if isinstance(metric, (str, Metric)) else list(metric)
    how = asked(
        "compare",
        components=components,
        variance=variance,
        body_length_m=body_length_m,
        equal_times=equal_times,
    )
    return Comparison(reference, many, metrics, how)
