"""Distances between motions."""

from __future__ import annotations

import json
from dataclasses import dataclass, fields
from typing import Dict, List, Mapping, Optional, Sequence, Tuple, Union, cast

from . import _native
from ._callback import AnyMetric, Metric, native_metric
from ._json import JsonObject, asked, typed
from ._picture import one, page
from ._table import Table
from ._trajectory import Trajectories, Trajectory, native_trajectories, native_trajectory
from ._warning import Warning


@dataclass(frozen=True)
class Distances:
    """The distances of one motion from the reference: one number per metric, by the name of its column.

    >>> realgap.compare(recordings[0], run, metric="rms").rows[0].distances.keys()
    dict_keys(['rms_m'])
    """

    trajectory: str
    reference: str
    net_displacement_m: float
    warnings: Tuple[Warning, ...]
    distances: Mapping[str, float]
    time: str = "fraction"
    common_s: Optional[float] = None
    matched: Optional[int] = None
    unmatched_reference: Optional[int] = None
    unmatched: Optional[int] = None
    offset_s: Optional[float] = None
    offset_deviation_s: Optional[float] = None


class Comparison:
    """Distances of motions from a reference: one row per motion, one column per metric.

    Paths are cut to the time that all of them have in common, so that a shorter motion changes the distances of the others.

    >>> comparison = realgap.compare(recordings[0], [recordings[1], run], metric="rms")
    >>> comparison.distance(0) > 0
    True
    """

    def __init__(
        self,
        reference: Trajectory,
        others: Trajectories,
        metrics: Optional[Sequence[AnyMetric]],
        how: str,
    ) -> None:
        self._reference = native_trajectory(reference)
        self._others = native_trajectories(others)
        self._metrics = None if metrics is None else [native_metric(metric) for metric in metrics]
        self._how = how
        self._json = self._ask(None)
        self._rows = [_distances(row) for row in self.report]

    def _ask(self, picture: Optional[str]) -> str:
        return _native.compare(self._reference, self._others, self._metrics, self._how, picture)

    @property
    def report(self) -> List[JsonObject]:
        """Everything as JSON, one object per motion.

        >>> realgap.compare(recordings[0], run).report[0]["trajectory"]
        'tripod'
        """
        return cast(List[JsonObject], json.loads(self._json))

    @property
    def rows(self) -> List[Distances]:
        """The distances, one element per motion.

        >>> [row.trajectory for row in realgap.compare(recordings[0], [recordings[1], run]).rows]
        ['run_01', 'tripod']
        """
        return list(self._rows)

    @property
    def table(self) -> Table:
        """The distances as a table, one row per motion.

        >>> realgap.compare(recordings[0], run, metric="rms").table
        Table of 1 rows: trajectory, net_displacement_m, rms_m
        """
        said: Dict[str, List[Union[None, bool, int, float, str]]] = {
            "trajectory": [row.trajectory for row in self._rows],
            "net_displacement_m": [row.net_displacement_m for row in self._rows],
        }
        for name in self._rows[0].distances if self._rows else ():
            said[name] = [row.distances[name] for row in self._rows]
        return Table(said)

    @property
    def warnings(self) -> List[Warning]:
        """All warnings, each once.

        >>> realgap.compare(recordings[0], recordings[1], metric="rms").warnings
        []
        """
        return list(dict.fromkeys(warning for row in self._rows for warning in row.warnings))

    def distance(self, index: int = 0) -> float:
        """The first distance of a motion; it is the only one where one metric was given.

        >>> realgap.compare(run, [recordings[0], run], metric="rms").distance(1)
        0.0
        """
        return next(iter(self._rows[index].distances.values()))

    def __float__(self) -> float:
        return self.distance()

    def picture(self) -> bytes:
        r"""The aligned paths, a PNG.

        >>> realgap.compare(recordings[0], run).picture()[:4]
        b'\x89PNG'
        """
        return one(self._ask)

    def __repr__(self) -> str:
        def text(row: Distances) -> str:
            said = {"net_displacement_m": row.net_displacement_m, **row.distances}
            return ", ".join([row.trajectory, *(f"{name} {value:.6g}" for name, value in said.items())])

        return "\n".join(text(row) for row in self._rows)

    def _repr_html_(self) -> str:
        return self.table._repr_html_() + page("", [self.picture()], self.warnings)


def _distances(row: JsonObject) -> Distances:
    known = {field.name for field in fields(Distances)}
    rest = {name: value for name, value in row.items() if name not in known}
    return cast(Distances, typed(Distances, {**row, "distances": rest}))


def compare(
    reference: Trajectory,
    others: Trajectories,
    metric: Union[AnyMetric, Sequence[AnyMetric], None] = None,
    *,
    components: Optional[int] = None,
    variance: Optional[float] = None,
    body_length_m: Optional[float] = None,
    time: str = "clock",
    associate: str = "nearest",
    max_difference_s: Optional[float] = None,
    align: str = "none",
    offset_s: Union[float, str, None] = None,
) -> Comparison:
    """Compares motions with a reference; without a metric, by all metrics that need positions only.

    `time` is "clock" (stamps of one clock), "start" (times since each start) or "fraction" (equal fractions of the durations).
    ape, umeyama-ape, rpe and rotation compare samples that belong together in time: the nearest within `max_difference_s` (0.01),
    or with `associate="interpolate"` at every sample of the reference; `align` is "none", "se3" or "sim3". `offset_s` is how much
    later the stamps of the motions are, or "auto". All other metrics compare paths as `prepare` makes them.

    >>> float(realgap.compare(recordings[0], recordings[1], metric="rms")) > 0.0
    True
    """
    metrics: Optional[Sequence[AnyMetric]] = None
    if metric is not None:
        metrics = [metric] if isinstance(metric, (str, Metric)) else metric
    how = asked(
        "compare",
        components=components,
        variance=variance,
        body_length_m=body_length_m,
        time=time,
        associate=associate,
        max_difference_s=max_difference_s,
        align=align,
        offset=None if offset_s is None else str(offset_s),
    )
    return Comparison(reference, others, metrics, how)
