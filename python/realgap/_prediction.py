"""Repeats under noise: what will happen, how likely, and how far that is from reality."""

from __future__ import annotations

import json
import os
from typing import Any, Dict, List, Mapping, Optional, Sequence, Union

from . import _native
from ._array import asked
from ._picture import drawn, page
from ._robot import Path, Robot, native_robot
from ._run import Progress, folder_name
from ._simulation import Parameters, _parameters
from ._table import Table

# Fields of a study's `noise`, or a file of them. A distribution is `{"Normal": 0.01}`.
Noise = Union[Mapping[str, Any], Path, None]


class _Result:
    """What results of repeats have in common."""

    def __init__(self, native: Union[_native.Ensemble, _native.Gap, _native.Prediction]) -> None:
        self._result = native
        self._report: Dict[str, Any] = json.loads(native.report())

    @property
    def report(self) -> Dict[str, Any]:
        """Everything, as in the JSON file of the results folder."""
        return dict(self._report)

    @property
    def warnings(self) -> List[Dict[str, str]]:
        """What the reader should know."""
        return list(self._report["warnings"])

    def write(self, folder: Path) -> None:
        """Writes the tables and pictures that the command writes."""
        self._result.write(os.fspath(folder))

    def pictures(self) -> Dict[str, bytes]:
        """The pictures as PNG, by name."""
        return drawn(self._result.write)

    def __str__(self) -> str:
        return self._result.text()

    def __repr__(self) -> str:
        return self._result.text()

    def _repr_html_(self) -> str:
        return page(str(self), list(self.pictures().values()), self.warnings)


class Ensemble(_Result):
    """Repeats of a study's runs under noise."""

    def __init__(self, native: _native.Ensemble) -> None:
        super().__init__(native)
        self._native = native

    @property
    def repeats(self) -> Table:
        """A row a repeat."""
        return Table(json.loads(self._native.repeats()))


class Gap(_Result):
    """How many noise floors of reality lie between it and the simulation."""

    @property
    def metrics(self) -> List[Dict[str, Any]]:
        """Noise floor, gap and their ratio, by metric."""
        return [dict(metric) for metric in self._report["metrics"]]


class Prediction(_Result):
    """What a robot will do before anybody builds it, and how likely."""

    def __init__(self, native: _native.Prediction) -> None:
        super().__init__(native)
        self._native = native

    @property
    def repeats(self) -> Table:
        """A row a repeat."""
        return Table(json.loads(self._native.repeats()))


def _drawing(
    what: str,
    repeats: int,
    noise: Noise,
    seed: Optional[int],
    model_error: bool = True,
    indistinguishable: Optional[Path] = None,
) -> str:
    is_file = isinstance(noise, (str, os.PathLike))
    return asked(
        what,
        repeats=repeats,
        seed=seed,
        noise=None if noise is None or is_file else dict(noise),  # type: ignore[arg-type]
        noise_file=noise if is_file else None,
        model_error=model_error,
        indistinguishable=indistinguishable,
    )


def ensemble_of(
    study: _native.Study,
    repeats: int,
    noise: Noise,
    seed: Optional[int],
    model_error: bool,
    indistinguishable: Optional[Path],
    jobs: Optional[int],
    folder: Optional[Path],
    progress: Optional[Progress],
) -> Ensemble:
    """See `Study.ensemble`."""
    drawing = _drawing("ensemble", repeats, noise, seed, model_error, indistinguishable)
    return Ensemble(_native.repeat_study(study, drawing, jobs, folder_name(folder), progress))


def gap_of(
    study: _native.Study,
    metrics: Optional[Sequence[Union[str, _native.OwnMetric, None]]],
    repeats: int,
    noise: Noise,
    seed: Optional[int],
    jobs: Optional[int],
    folder: Optional[Path],
    progress: Optional[Progress],
) -> Gap:
    """See `Study.gap`."""
    drawing = _drawing("gap", repeats, noise, seed)
    return Gap(_native.study_gap(study, metrics, drawing, jobs, folder_name(folder), progress))


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
    indistinguishable: Optional[Path] = None,
    jobs: Optional[int] = None,
    folder: Optional[Path] = None,
    progress: Optional[Progress] = None,
) -> Prediction:
    """The prediction card of a robot, as `realgap predict` makes it."""
    files, values = _parameters(parameters)
    question = asked(
        "predict", duration_s=duration_s, success_m=success_m, set=values, parameters=files
    )
    drawing = _drawing("predict", repeats, noise, seed, model_error, indistinguishable)
    return Prediction(
        _native.predict(native_robot(robot), question, drawing, jobs, folder_name(folder), progress)
    )
