"""Studies: recordings, a robot, what is not known of it, and how far apart they are; and the answers."""

from __future__ import annotations

import json
import os
from typing import TYPE_CHECKING, Any, Dict, List, Mapping, Optional, Sequence, Tuple, Union

from . import _native
from ._array import asked
from ._callback import Metric, Optimizer, native_metric
from ._comparison import AnyMetric
from ._picture import drawn, page
from ._prediction import Ensemble, Gap, Noise, ensemble_of, gap_of
from ._robot import Path, Robot, native_robot
from ._run import Progress, file_name, folder_name, mode
from ._simulation import Parameters, _parameters
from ._table import Table
from ._trajectory import Trajectory, native_trajectory

if TYPE_CHECKING:
    import pandas
    import polars

# From, to, and how many points in between and at the ends.
Range = Union[Tuple[float, float], Tuple[float, float, int]]
# Points of a range that does not say how many: 21 x 21 as in paper 003.
POINTS = 21


class Answer:
    """What a sweep or a tuning says: the best point, and how sure that is."""

    def __init__(self, native: _native.Answer, study: "Study") -> None:
        self._native = native
        self.study = study
        self._report: Dict[str, Any] = json.loads(native.report())

    @property
    def report(self) -> Dict[str, Any]:
        """Everything, as in `summary.json`."""
        return dict(self._report)

    @property
    def best(self) -> Dict[str, float]:
        """The values of the best point."""
        return dict(self._report["best"]["parameters"])

    @property
    def fitted(self) -> "Study":
        """The study with the best values fixed, for ensembles and gaps; it warns that its recordings were used to find them."""
        return Study(self._native.fitted())

    @property
    def score(self) -> float:
        """The score of the best point, in `unit`."""
        return float(self._report["best"]["score"])

    @property
    def unit(self) -> str:
        """Unit of the scores."""
        return str(self._report["unit"])

    @property
    def verdicts(self) -> List[Dict[str, Any]]:
        """What the recordings say about each parameter: best, interval, whether they determine it."""
        return [dict(verdict) for verdict in self._report["verdicts"]]

    @property
    def points(self) -> Table:
        """A row a point: parameters, score, whether it can be told from the best."""
        return Table(json.loads(self._native.points()))

    def to_pandas(self) -> "pandas.DataFrame":
        """The points as a pandas frame."""
        return self.points.to_pandas()

    def to_polars(self) -> "polars.DataFrame":
        """The points as a polars frame."""
        return self.points.to_polars()

    @property
    def warnings(self) -> List[Dict[str, str]]:
        """What the reader should know."""
        return list(self._report["warnings"])

    def write(self, folder: Path) -> None:
        """Writes the tables and pictures that the command writes."""
        self._native.write(os.fspath(folder))

    def pictures(self) -> Dict[str, bytes]:
        """The pictures as PNG, by name."""
        return drawn(self._native.write)

    def __str__(self) -> str:
        return self._native.text()

    def __repr__(self) -> str:
        return self._native.text()

    def _repr_html_(self) -> str:
        pictures = self.pictures()
        wanted = ("heatmap", "curve", "trajectories", "convergence")
        shown = [pictures[name] for name in wanted if name in pictures]
        return page(str(self), shown, self.warnings)


class Study:
    """A study, ready to run. Use `Study.read`, `Study.from_text`, `Study.from_dict`, or `Study.of`."""

    def __init__(self, native: _native.Study) -> None:
        self._native = native
        self._info: Dict[str, Any] = json.loads(native.info())

    @classmethod
    def read(cls, path: Path, **wishes: Any) -> "Study":
        """A study from its RON file, as `realgap sweep` reads it.

        Different from the file, if wished: `recordings` (globs), `every`, `offset`, `limit_recordings`, `metric` (a name or a
        `Metric`), `points`, `seed`, `score` ("valid", "ensemble:N", "single"), `basis`, `set` (values by name), `parameters` (files
        of values), `folds`, `hold_out`, `reading`.
        """
        return cls._parsed(os.fspath(path), None, False, wishes)

    @classmethod
    def from_text(cls, text: str, *, name: str = "study", folder: Path = ".", **wishes: Any) -> "Study":
        """A study from RON. The files that it names are relative to `folder`; wishes as for `Study.read`."""
        path = file_name(folder, name)
        return cls._parsed(path, text, False, wishes)

    @classmethod
    def from_dict(
        cls, fields: Mapping[str, Any], *, name: str = "study", folder: Path = ".", **wishes: Any
    ) -> "Study":
        """A study from the fields of its file, as `Robot.from_dict` takes those of a robot."""
        path = file_name(folder, name)
        return cls._parsed(path, asked("a study", **dict(fields)), True, wishes)

    @classmethod
    def _parsed(cls, path: str, text: Optional[str], is_json: bool, wishes: Dict[str, Any]) -> "Study":
        metric = native_metric(wishes.pop("metric", None))
        told = asked("a study", **_all_wishes(**wishes))
        return cls(_native.Study.parse(path, text, is_json, metric, told))

    @classmethod
    def of(
        cls,
        robot: Robot,
        recordings: Union[Trajectory, Sequence[Trajectory]],
        vary: Mapping[str, Range],
        *,
        name: str = "study",
        metric: Optional[AnyMetric] = None,
        set: Optional[Mapping[str, float]] = None,
        duration_s: Optional[float] = None,
        start: str = "settled",
        score: Optional[str] = None,
        seed: int = 1,
        folds: Optional[int] = None,
        hold_out: Optional[float] = None,
        noise: Optional[Mapping[str, Any]] = None,
    ) -> "Study":
        """A study of objects: `vary` names parameters with (from, to) or (from, to, points).

        `start` is "settled", or "first-sample", "half-sample" or "flight" for runs that begin with the state of each recording.
        """
        many = [recordings] if isinstance(recordings, Trajectory) else list(recordings)
        ranges = [(parameter, *_range(values)) for parameter, values in vary.items()]
        said = asked(
            "a study",
            name=name,
            vary=ranges,
            set=dict(set or {}),
            duration_s=duration_s,
            start=start,
            score=score,
            seed=seed,
            folds=folds,
            hold_out=hold_out,
            noise=None if noise is None else dict(noise),
        )
        given = [native_trajectory(recording) for recording in many]
        return cls(_native.Study.build(native_robot(robot), given, native_metric(metric), said))

    @property
    def name(self) -> str:
        """Its name."""
        return str(self._info["name"])

    @property
    def info(self) -> Dict[str, Any]:
        """What it says: parameters, recordings, metric, seed."""
        return dict(self._info)

    @property
    def parameters(self) -> List[str]:
        """The parameters that vary, in the order of an optimizer's coordinates."""
        return [str(parameter["name"]) for parameter in self._info["parameters"]]

    @property
    def recordings(self) -> List[Trajectory]:
        """Its recordings."""
        return [Trajectory._of(native) for native in self._native.recordings()]

    @property
    def warnings(self) -> List[Dict[str, str]]:
        """What the reader should know."""
        return list(self._info["warnings"])

    def at(self, values: Mapping[str, float]) -> "Study":
        """The same study with these values fixed, for ensembles and gaps."""
        return Study(self._native.at({name: float(value) for name, value in values.items()}))

    def values(self, point: Sequence[float]) -> Dict[str, float]:
        """The values of the parameters at coordinates from 0 to 1."""
        return dict(zip(self.parameters, self._native.values([float(x) for x in point])))

    def sweep(
        self,
        *,
        jobs: Optional[int] = None,
        folder: Optional[Path] = None,
        resume: bool = False,
        restart: bool = False,
        progress: Optional[Progress] = None,
    ) -> Answer:
        """Tries every point of the grid. Into `folder` goes what `realgap sweep -o` writes, with the same bytes."""
        how = mode(resume, restart)
        return Answer(self._native.sweep(jobs, folder_name(folder), how, progress), self)

    def tune(
        self,
        *,
        optimizer: Union[str, Optimizer] = "cma-es",
        budget: int = 100,
        patience: Optional[int] = None,
        jobs: Optional[int] = None,
        folder: Optional[Path] = None,
        resume: bool = False,
        restart: bool = False,
        progress: Optional[Progress] = None,
    ) -> Answer:
        """Lets an optimizer choose the points."""
        if isinstance(optimizer, Optimizer):
            name = optimizer.name
            own = (optimizer.design, optimizer.batch, optimizer._proposer())
        else:
            name, own = optimizer, None
        how = mode(resume, restart)
        into = folder_name(folder)
        return Answer(
            self._native.tune(name, own, budget, patience, jobs, into, how, progress), self
        )

    def ensemble(
        self,
        *,
        repeats: int = 200,
        noise: Noise = None,
        seed: Optional[int] = None,
        model_error: bool = True,
        indistinguishable: Optional[Path] = None,
        jobs: Optional[int] = None,
        folder: Optional[Path] = None,
        progress: Optional[Progress] = None,
    ) -> Ensemble:
        """Repeats the study's runs under noise: what will really happen, and how sure may we be?"""
        return ensemble_of(
            self._native, repeats, noise, seed, model_error, indistinguishable, jobs, folder, progress
        )

    def gap(
        self,
        *,
        metrics: Optional[Sequence[AnyMetric]] = None,
        repeats: int = 200,
        noise: Noise = None,
        seed: Optional[int] = None,
        jobs: Optional[int] = None,
        folder: Optional[Path] = None,
        progress: Optional[Progress] = None,
    ) -> Gap:
        """How many noise floors of reality is the simulation away?"""
        chosen = None if metrics is None else [native_metric(metric) for metric in metrics]
        return gap_of(self._native, chosen, repeats, noise, seed, jobs, folder, progress)

    def __repr__(self) -> str:
        info = self._info
        count = len(info["recordings"])
        varied = ", ".join(self.parameters)
        return f"Study {self.name}: {info['robot']}, {count} recordings, {varied} by {info['metric']}"


def _range(values: Range) -> Tuple[float, float, int]:
    if len(values) == 2:
        return (float(values[0]), float(values[1]), POINTS)
    return (float(values[0]), float(values[1]), int(values[2]))


def _all_wishes(
    *,
    recordings: Union[str, Sequence[str], None] = None,
    every: Optional[int] = None,
    offset: int = 0,
    limit_recordings: Optional[int] = None,
    points: Optional[int] = None,
    seed: Optional[int] = None,
    score: Optional[str] = None,
    basis: Optional[str] = None,
    set: Optional[Mapping[str, float]] = None,
    parameters: Parameters = None,
    folds: Optional[int] = None,
    hold_out: Optional[float] = None,
    reading: Optional[Mapping[str, Any]] = None,
) -> Dict[str, Any]:
    files, values = _parameters(parameters)
    globs = [] if recordings is None else [recordings] if isinstance(recordings, str) else list(recordings)
    return {
        "recordings": globs,
        "every": every,
        "offset": offset,
        "limit_recordings": limit_recordings,
        "points": points,
        "seed": seed,
        "score": score,
        "basis": basis,
        "set": {**values, **dict(set or {})},
        "parameters": files,
        "folds": folds,
        "hold_out": hold_out,
        "reading": dict(reading or {}),
    }
