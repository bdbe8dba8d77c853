"""The answers of sweeps and tunings."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Dict, Tuple

from . import _native
from ._result import Result
from ._sweep import Best, SweepSummary, Verdict
from ._table import Table

if TYPE_CHECKING:
    import pandas
    import polars

    from ._study import Study


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
