"""The answers of sweeps and tunings."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Dict, List, Literal, Optional, Sequence, Tuple

import numpy as np
import numpy.typing as npt

from . import _native
from ._array import Floats
from ._error import usage
from ._plot import draw_joint, draw_map, draw_profile, table_of_expected
from ._result import Result
from ._sweep import Best, SweepSummary, Verdict
from ._table import Table

if TYPE_CHECKING:
    import pandas
    import polars
    from matplotlib.axes import Axes

    from ._study import Study


@dataclass(frozen=True)
class Profile:
    """The lowest expected score at each value of a parameter, whatever the others, with its 90 % interval.

    >>> answer.profiles[0].parameter, answer.profiles[0].values.shape
    ('floor.friction', (3,))
    """

    parameter: str
    unit: str
    values: Floats
    lowest_score: Floats
    low: Floats
    high: Floats
    indistinguishable: "npt.NDArray[np.bool_]"


class Answer(Result[_native.Answer, SweepSummary]):
    """The answer of a sweep or a tuning: the best point, and how sure it is.

    >>> list(answer.best), answer.unit
    (['floor.friction'], 'm')
    """

    _shown = ("heatmap", "curve", "trajectories", "convergence")

    def __init__(self, native: _native.Answer, study: "Study") -> None:
        super().__init__(native, SweepSummary)
        self.study = study

    @property
    def summary(self) -> SweepSummary:
        """Everything, as in `summary.json`.

        >>> answer.summary.metric
        'rms'
        """
        return self._summary

    @property
    def _best(self) -> Best:
        assert self._summary.best is not None, "an answer without a best point is an error"
        return self._summary.best

    @property
    def best(self) -> Dict[str, float]:
        """The values of the best point.

        >>> answer.best["floor.friction"] in answer.points["floor.friction"]
        True
        """
        return dict(self._best.parameters)

    @property
    def fitted(self) -> "Study":
        """The study with the best values fixed, for ensembles and gaps; it warns that its recordings were used to find them.

        >>> "in-sample" in [warning.code for warning in answer.fitted.warnings]
        True
        """
        return type(self.study)(self._native.fitted())

    @property
    def score(self) -> float:
        """The score of the best point, in `unit`.

        >>> answer.score == answer.summary.best.score
        True
        """
        return self._best.score

    @property
    def unit(self) -> str:
        """Unit of the scores.

        >>> answer.unit
        'm'
        """
        return self._summary.unit

    @property
    def verdicts(self) -> Tuple[Verdict, ...]:
        """The verdict on each parameter: its best value, its interval, and whether the recordings determine it.

        >>> [verdict.parameter for verdict in answer.verdicts]
        ['floor.friction']
        """
        return self._summary.verdicts

    @property
    def points(self) -> Table:
        """One row per point: parameters, score, and whether the point is indistinguishable from the best.

        >>> answer.points.rows
        3
        """
        return Table(json.loads(self._native.points()))

    @property
    def posterior(self) -> Table:
        """Draws from the posterior, one row a draw and one column a parameter; `.to_pandas()` makes a frame of them.

        >>> list(answer.posterior), answer.posterior.rows > 0
        (['floor.friction'], True)
        """
        return Table(json.loads(self._native.posterior()))

    @property
    def profiles(self) -> Tuple[Profile, ...]:
        """The lowest expected score along each parameter; empty where too few runs have a score.

        >>> [profile.parameter for profile in answer.profiles]
        ['floor.friction']
        """
        found: List[Profile] = []
        for one in json.loads(self._native.profiles()):
            numbers = {
                name: np.array(one[name], dtype=float) for name in ("values", "lowest_score", "low", "high")
            }
            inside = np.array(one["indistinguishable"], dtype=bool)
            found.append(Profile(one["parameter"], one["unit"], **numbers, indistinguishable=inside))
        return tuple(found)

    def expected(self, points: Sequence[Sequence[float]]) -> Table:
        """The score that all runs let expect at any points, simulated or not: the columns `score`, and `low` and `high` of its 90 %
        interval. Cells are empty where it is not known. A point has a value for each parameter, in the order of `study.parameters`.

        >>> answer.expected([[0.3], [0.4]]).rows
        2
        """
        names = self.study.parameters
        rows = [[float(value) for value in point] for point in points]
        for index, row in enumerate(rows):
            if len(row) != len(names):
                raise usage(
                    "wrong number of values",
                    field=f"points[{index}]",
                    found=len(row),
                    allowed=f"a value for each of {', '.join(names)}",
                )
        return table_of_expected(rows, names, json.loads(self._native.expected(rows)))

    @property
    def joints(self) -> Table:
        """Recorded joints, or the channels that the study scores, beside those of the best point, one row a sample; no rows where no
        joints were recorded. The best point is simulated again for it.

        >>> answer.joints.rows
        0
        """
        return Table(json.loads(self._native.joints()))

    def plot(
        self,
        what: Optional[Literal["map", "profiles", "joints"]] = None,
        *,
        ax: Optional["Axes"] = None,
        parameters: Optional[Sequence[str]] = None,
        joint: Optional[str] = None,
        recording: Optional[str] = None,
    ) -> "Axes":
        """Draws on axes of matplotlib, new ones without `ax`, and returns them.

        "map" is the expected score over two `parameters`, the others at the best point, with the posterior's draws; "profiles" is
        the profile of one parameter; "joints" is one `joint` of one `recording` over time beside the best point. Without `what`, it
        is the map where two or more parameters vary, otherwise the profile.

        >>> import matplotlib
        >>> matplotlib.use("agg")
        >>> answer.plot("profiles").get_xlabel()
        'floor.friction'
        """
        kind = what or ("profiles" if len(self.study.parameters) == 1 else "map")
        if kind == "joints":
            if parameters is not None:
                raise usage("joints over time have no parameters", field="parameters", hint="choose joint= and recording=")
            return draw_joint(self, joint, recording, ax)
        if joint is not None or recording is not None:
            name = "joint" if joint is not None else "recording"
            raise usage("only joints over time have this choice", field=name, hint='plot("joints", joint=..., recording=...)')
        if isinstance(parameters, str):
            parameters = [parameters]
        if kind == "map":
            return draw_map(self, parameters, ax)
        if kind == "profiles":
            return draw_profile(self, parameters, ax)
        raise usage("no such picture", field="what", found=repr(what), allowed="map, profiles, joints")

    def to_pandas(self) -> "pandas.DataFrame":
        """The points as a pandas frame.

        >>> answer.to_pandas().sort_values("score").shape[0]
        3
        """
        return self.points.to_pandas()

    def to_polars(self) -> "polars.DataFrame":
        """The points as a polars frame.

        >>> answer.to_polars().height
        3
        """
        return self.points.to_polars()
