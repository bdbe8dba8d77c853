"""Repeats under noise: ensembles, gaps and predictions."""

from __future__ import annotations

import json
import sys
from typing import TYPE_CHECKING, Literal, Mapping, Optional, Sequence, Tuple, Union

from . import _native
from ._callback import AnyMetric, native_metric
from ._card import Card
from ._forecast import EnsembleSummary
from ._gap import GapSummary, MetricGap
from ._json import Given, asked
from ._plot import draw_gap
from ._progress import AnyProgress, shown
from ._result import Result
from ._robot import Robot, native_robot
from ._run import Parameters, Path, files_and_values, folder_name, whole
from ._table import Table

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Fields of a study's `noise`, or a file of them. A distribution is `{"Normal": 0.01}`.
Noise = Union[Mapping[str, Given], Path, None]
# Who says what another engine would do.
OtherEngine = Literal["auto", "mujoco", "table"]


class Ensemble(Result[_native.Ensemble, EnsembleSummary]):
    """Repeats of a study's runs under noise.

    >>> ensemble.summary.cases[0].summary.repeats
    5
    """

    def __init__(self, native: _native.Ensemble) -> None:
        super().__init__(native, EnsembleSummary)

    @property
    def summary(self) -> EnsembleSummary:
        """Everything, as in `ensemble.json`.

        >>> ensemble.summary.morphology
        'tripod'
        """
        return self._summary

    @property
    def repeats(self) -> Table:
        """One row per repeat.

        >>> ensemble.repeats.rows
        5
        """
        return Table(json.loads(self._native.repeats()))


class Gap(Result[_native.Gap, GapSummary]):
    """The gap between simulation and reality, in noise floors of reality.

    >>> gap.metrics[0].floor.value > 0.0
    True
    """

    def __init__(self, native: _native.Gap) -> None:
        super().__init__(native, GapSummary)

    @property
    def summary(self) -> GapSummary:
        """Everything, as in `gap.json`.

        >>> gap.summary.starts
        1
        """
        return self._summary

    @property
    def metrics(self) -> Tuple[MetricGap, ...]:
        """Noise floor, gap and their ratio, by metric.

        >>> [metric.metric for metric in gap.metrics]
        ['rms', 'displacement']
        """
        return self._summary.metrics

    def plot(
        self,
        what: Literal["distance", "confidence"] = "distance",
        *,
        ax: Optional["Axes"] = None,
    ) -> "Axes":
        """Draws over time on axes of matplotlib, new ones without `ax`, and returns them: the distance from the recordings, or the
        share of real runs inside the region that the repeats predict.

        >>> import matplotlib
        >>> matplotlib.use("agg")
        >>> gap.plot().get_xlabel(), gap.plot("confidence").get_ylabel()
        ('time, s', 'share of real runs inside')
        """
        return draw_gap(self._summary, what, ax)


class Prediction(Result[_native.Prediction, Card]):
    """The prediction of what a robot will do before it is built, and how likely it is.

    >>> prediction.card.success.probability.trials
    5
    """

    def __init__(self, native: _native.Prediction) -> None:
        super().__init__(native, Card)

    @property
    def card(self) -> Card:
        """Everything, as in `prediction.json`.

        >>> prediction.card.prediction.duration_s
        0.5
        """
        return self._summary

    @property
    def repeats(self) -> Table:
        """One row per repeat.

        >>> prediction.repeats["repeat"]
        [0, 1, 2, 3, 4]
        """
        return Table(json.loads(self._native.repeats()))


def _drawing(
    what: str,
    repeats: int,
    noise: Noise,
    seed: Optional[int],
    model_error: bool = True,
    posterior: Optional[Path] = None,
    other_engine: Optional[OtherEngine] = None,
) -> str:
    return asked(
        what,
        repeats=repeats,
        seed=seed,
        noise=dict(noise) if isinstance(noise, Mapping) else None,
        noise_file=None if isinstance(noise, Mapping) else noise,
        model_error=model_error,
        posterior=posterior,
        other_engine=other_engine,
        python=sys.executable or None,
    )


def ensemble_of(
    study: _native.Study,
    repeats: int,
    noise: Noise,
    seed: Optional[int],
    model_error: bool,
    posterior: Optional[Path],
    other_engine: Optional[OtherEngine],
    jobs: Optional[int],
    folder: Optional[Path],
    progress: AnyProgress,
) -> Ensemble:
    """See `Study.ensemble`."""
    drawing = _drawing("ensemble", repeats, noise, seed, model_error, posterior, other_engine)
    return Ensemble(_native.repeat_study(study, drawing, whole("jobs", jobs), folder_name(folder), shown(progress)))


def gap_of(
    study: _native.Study,
    metrics: Optional[Sequence[AnyMetric]],
    repeats: int,
    noise: Noise,
    seed: Optional[int],
    jobs: Optional[int],
    folder: Optional[Path],
    progress: AnyProgress,
) -> Gap:
    """See `Study.gap`."""
    drawing = _drawing("gap", repeats, noise, seed)
    chosen = None if metrics is None else [native_metric(metric) for metric in metrics]
    return Gap(_native.study_gap(study, chosen, drawing, whole("jobs", jobs), folder_name(folder), shown(progress)))


def predict(
    robot: Robot,
    *,
    duration_s: float = 20.0,
    parameters: Parameters = None,
    noise: Noise = None,
    repeats: int = 200,
    seed: int = 1,
    success_m: Optional[float] = None,
    model_error: bool = True,
    posterior: Optional[Path] = None,
    other_engine: Optional[OtherEngine] = None,
    jobs: Optional[int] = None,
    folder: Optional[Path] = None,
    progress: AnyProgress = None,
) -> Prediction:
    """The prediction card of a robot, as `realgap predict` makes it.

    `other_engine` says who tells what another engine would do: "mujoco" asks MuJoCo, which this Python must have, "table" takes
    what it did with other robots, and "auto", the default, asks MuJoCo where it can.

    >>> noise = {"friction_run_relative": {"LogNormal": 0.05}}
    >>> realgap.predict(robot, duration_s=0.5, noise=noise, repeats=3, model_error=False).card.noise_from
    'Python'
    """
    files, values = files_and_values(parameters)
    question = asked(
        "predict", duration_s=duration_s, success_m=success_m, set=values, parameters=files
    )
    drawing = _drawing("predict", repeats, noise, seed, model_error, posterior, other_engine)
    return Prediction(
        _native.predict(
            native_robot(robot), question, drawing, whole("jobs", jobs), folder_name(folder), shown(progress)
        )
    )
