"""Studies: recordings, a robot, the parameters to vary, and a metric."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Dict, List, Literal, Mapping, Optional, Sequence, Tuple, Union

from . import _native
from ._answer import Answer
from ._callback import AnyMetric, Optimizer, native_metric
from ._error import usage
from ._finding import Evaluation, Explanation, Identification
from ._json import Given, JsonObject, asked, made, parsed
from ._prediction import Ensemble, Gap, Noise, OtherEngine, ensemble_of, gap_of
from ._robot import Robot, native_robot
from ._progress import AnyProgress, shown
from ._run import Parameters, Path, file_name, files_and_values, folder_name, mode, whole
from ._simulator import Declarations, Simulate, responder
from ._trajectory import Trajectories, Trajectory, native_trajectories
from ._warning import Warning

# Lowest value, highest value, and the number of points including both ends.
Range = Union[Tuple[float, float], Tuple[float, float, int]]
# Points of a range without a number of points: 21 x 21 as in paper 003.
POINTS = 21
Start = Literal["settled", "first-sample", "half-sample", "flight"]


@dataclass(frozen=True)
class _Varied:
    name: str


@dataclass(frozen=True)
class _Info:
    name: str
    robot: str
    parameters: Tuple[_Varied, ...]
    recordings: Tuple[str, ...]
    metric: str
    warnings: Tuple[Warning, ...]


class Study:
    """A study, ready to run. Use `Study.read`, `Study.from_text`, `Study.from_dict`, or `Study.of`.

    >>> study
    Study study: tripod, 2 recordings, floor.friction by rms
    """

    def __init__(self, native: _native.Study) -> None:
        self._native = native
        self._info = made(_Info, native.info())

    @classmethod
    def read(
        cls,
        path: Path,
        *,
        recordings: Union[str, Sequence[str], None] = None,
        every: Optional[int] = None,
        offset: int = 0,
        limit_recordings: Optional[int] = None,
        metric: Optional[AnyMetric] = None,
        duration_s: Optional[float] = None,
        points: Optional[int] = None,
        seed: Optional[int] = None,
        score: Optional[str] = None,
        basis: Optional[Path] = None,
        set: Optional[Mapping[str, float]] = None,
        parameters: Parameters = None,
        folds: Optional[int] = None,
        hold_out: Optional[float] = None,
        reading: Optional[Mapping[str, Given]] = None,
        allow_command: bool = False,
    ) -> "Study":
        """A study from its RON file, as `realgap sweep` reads it; arguments override the file.

        `recordings` are globs; every `every`-th file from `offset` on is taken, at most `limit_recordings`; of each run, the
        first `duration_s` are simulated; `points` is the number of each range; `score` is "valid", "ensemble:N" or "single";
        `basis` is "recordings" or a file, for metrics that project; `set` fixes values by name, `parameters` those of files;
        `folds` or `hold_out` (a share) keep recordings for a check; `reading` says how files are read; `allow_command` runs the
        command that the study names as its simulator.

        >>> realgap.Study.read("sweeps/tripod_floor.ron", points=3, recordings="real_trajectories/tripod_standin/run_0*.csv")
        Study tripod_floor: tripod, 10 recordings, floor.friction, floor.restitution by pca
        """
        wishes = _wishes(
            recordings, every, offset, limit_recordings, duration_s, points, seed, score, basis, set, parameters,
            folds, hold_out, reading, allow_command,
        )  # fmt: skip
        return cls(_native.Study.parse(os.fspath(path), None, False, native_metric(metric), wishes))

    @classmethod
    def from_text(
        cls,
        text: str,
        *,
        name: str = "study",
        folder: Path = ".",
        recordings: Union[str, Sequence[str], None] = None,
        every: Optional[int] = None,
        offset: int = 0,
        limit_recordings: Optional[int] = None,
        metric: Optional[AnyMetric] = None,
        duration_s: Optional[float] = None,
        points: Optional[int] = None,
        seed: Optional[int] = None,
        score: Optional[str] = None,
        basis: Optional[Path] = None,
        set: Optional[Mapping[str, float]] = None,
        parameters: Parameters = None,
        folds: Optional[int] = None,
        hold_out: Optional[float] = None,
        reading: Optional[Mapping[str, Given]] = None,
        allow_command: bool = False,
    ) -> "Study":
        """A study from RON. The files that it names are relative to `folder`; the rest as for `Study.read`.

        >>> with open("sweeps/tripod_floor.ron") as file:
        ...     realgap.Study.from_text(file.read(), name="floor", folder="sweeps", limit_recordings=4).name
        'floor'
        """
        wishes = _wishes(
            recordings, every, offset, limit_recordings, duration_s, points, seed, score, basis, set, parameters,
            folds, hold_out, reading, allow_command,
        )  # fmt: skip
        path = file_name(folder, name)
        return cls(_native.Study.parse(path, text, False, native_metric(metric), wishes))

    @classmethod
    def from_dict(
        cls,
        fields: Mapping[str, Given],
        *,
        name: str = "study",
        folder: Path = ".",
        recordings: Union[str, Sequence[str], None] = None,
        every: Optional[int] = None,
        offset: int = 0,
        limit_recordings: Optional[int] = None,
        metric: Optional[AnyMetric] = None,
        duration_s: Optional[float] = None,
        points: Optional[int] = None,
        seed: Optional[int] = None,
        score: Optional[str] = None,
        basis: Optional[Path] = None,
        set: Optional[Mapping[str, float]] = None,
        parameters: Parameters = None,
        folds: Optional[int] = None,
        hold_out: Optional[float] = None,
        reading: Optional[Mapping[str, Given]] = None,
        allow_command: bool = False,
    ) -> "Study":
        """A study from the fields of its file, as `Robot.from_dict` takes those of a robot; the rest as for `Study.from_text`.

        >>> fields = {
        ...     "morphology": "morphologies/tripod.ron",
        ...     "recordings": ["real_trajectories/tripod_standin/run_0[01].csv"],
        ...     "start": "Settled",
        ...     "duration_s": 0.5,
        ...     "parameters": [{"name": "floor.friction", "from": 0.2, "to": 0.8, "points": 3}],
        ...     "metric": "rms",
        ... }
        >>> realgap.Study.from_dict(fields).sweep().points["score"] == answer.points["score"]
        True
        """
        wishes = _wishes(
            recordings, every, offset, limit_recordings, duration_s, points, seed, score, basis, set, parameters,
            folds, hold_out, reading, allow_command,
        )  # fmt: skip
        path, text = file_name(folder, name), asked("a study", **dict(fields))
        return cls(_native.Study.parse(path, text, True, native_metric(metric), wishes))

    @classmethod
    def of(
        cls,
        robot: Optional[Robot] = None,
        recordings: Optional[Trajectories] = None,
        vary: Optional[Mapping[str, Range]] = None,
        *,
        simulate: Optional[Simulate] = None,
        declares: Optional[Declarations] = None,
        settings: Sequence[Mapping[str, Given]] = (),
        version: str = "",
        name: str = "study",
        metric: Optional[AnyMetric] = None,
        set: Optional[Mapping[str, float]] = None,
        duration_s: Optional[float] = None,
        start: Start = "settled",
        score: Optional[str] = None,
        seed: int = 1,
        folds: Optional[int] = None,
        hold_out: Optional[float] = None,
        noise: Optional[Mapping[str, Given]] = None,
        commands: Optional[bool] = None,
    ) -> "Study":
        """A study of objects: `vary` names parameters with (from, to) or (from, to, points).

        `start` is "settled", or "first-sample", "half-sample" or "flight" for runs that begin with the state of each recording.
        Runs of a simulation are recordings, too. Servos follow the commands of the recordings (`Trajectory(..., commands=...)`)
        where there are any; `commands=False` lets them follow the gaits of the robot's file.

        In place of a robot, `simulate` is a function of your own, as `realgap.serve` takes it with `declares` and `settings`: it
        gets a `realgap.Question` and returns channels by name. `version` stands in the fingerprint of results: change it when you
        change what the function calls.

        >>> realgap.Study.of(robot, run, {"floor.friction": (0.2, 0.8)}, metric="rms").info["points"]
        21
        """
        if recordings is None or vary is None:
            lacking = "recordings" if recordings is None else "vary"
            raise usage(
                "a study needs recordings, and parameters that vary",
                field=lacking,
                allowed='a Trajectory or several, and {"floor.friction": (0.2, 0.8)}',
            )
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
            commands=commands,
        )
        given = native_trajectories(recordings)
        if simulate is None and (declares or settings or version):
            raise usage(
                "declares, settings and version belong to a function in place of a robot",
                field="simulate",
                hint="give simulate=, or leave them out",
            )
        if simulate is not None and commands is not None:
            raise usage(
                "a function in place of a robot has no servos of a file",
                field="commands",
                found=commands,
                hint="leave commands out: realgap.Question.commands has what was recorded",
            )
        own = None if simulate is None else responder(simulate, declares or {}, settings, name, version)
        model = None if robot is None else native_robot(robot)
        return cls(_native.Study.build(model, own, given, native_metric(metric), said))

    @property
    def name(self) -> str:
        """Its name.

        >>> study.name
        'study'
        """
        return self._info.name

    @property
    def info(self) -> JsonObject:
        """The content of the study: parameters, recordings, metric, seed.

        >>> study.info["recordings"]
        ['run_00', 'run_01']
        """
        return parsed(self._native.info())

    @property
    def parameters(self) -> List[str]:
        """The parameters that vary, in the order of an optimizer's coordinates.

        >>> study.parameters
        ['floor.friction']
        """
        return [parameter.name for parameter in self._info.parameters]

    @property
    def recordings(self) -> List[Trajectory]:
        """Its recordings.

        >>> [recording.name for recording in study.recordings]
        ['run_00', 'run_01']
        """
        return [Trajectory._of(native) for native in self._native.recordings()]

    @property
    def warnings(self) -> Tuple[Warning, ...]:
        """Warnings about the study.

        >>> "stand-in" in [warning.code for warning in study.warnings]
        True
        """
        return self._info.warnings

    def at(self, values: Mapping[str, float]) -> "Study":
        """The same study with these values fixed, for ensembles and gaps.

        >>> study.at({"floor.friction": 0.4}).info["set"]
        {'floor.friction': 0.4}
        """
        return Study(self._native.at({name: float(value) for name, value in values.items()}))

    def values(self, point: Sequence[float]) -> Dict[str, float]:
        """The values of the parameters at coordinates from 0 to 1.

        >>> study.values([0.5])
        {'floor.friction': 0.5}
        """
        return dict(zip(self.parameters, self._native.values([float(x) for x in point])))

    def evaluate(
        self, *, jobs: Optional[int] = None, progress: AnyProgress = None
    ) -> Evaluation:
        """How well the study's own values predict its recordings, each simulated once, as `realgap evaluate` tells it.

        Take recordings that the values were not fitted on. Recordings need orientations, or joints alone.

        >>> tosses = realgap.Study.read("sweeps/cube_toss_fit.ron", limit_recordings=4, parameters="sweeps/cube_toss_best.ron")
        >>> tosses.evaluate().report["recordings"]
        4
        """
        return Evaluation(self._native.evaluate(whole("jobs", jobs), shown(progress)))

    def identify(
        self,
        *,
        explain: Explanation = "length-scale",
        jobs: Optional[int] = None,
        progress: AnyProgress = None,
    ) -> Identification:
        """What the recordings say without a fit, as `realgap study identify` tells it: centre of mass and gravity from free flight,
        or which parameters recordings of joints determine. `explain` says what an apparent gravity is due to.

        >>> tosses = realgap.Study.read("sweeps/cube_toss_fit.ron", limit_recordings=8)
        >>> sorted(tosses.identify().parameters)[:2]
        ['body.com_offset_x_m', 'body.com_offset_y_m']
        """
        found = self._native.identify(explain, whole("jobs", jobs), shown(progress))
        return Identification(found)

    def sweep(
        self,
        *,
        jobs: Optional[int] = None,
        folder: Optional[Path] = None,
        resume: bool = False,
        restart: bool = False,
        progress: AnyProgress = None,
        audit: bool = True,
    ) -> Answer:
        """Simulates every point of the grid. `folder` gets the files of `realgap sweep -o`, with the same bytes. Without `audit` no
        further runs check the answer, as with `--no-audit`.

        >>> study.sweep(folder=folder / "sweep").best == answer.best
        True
        """
        how = mode(resume, restart)
        count, into = whole("jobs", jobs), folder_name(folder)
        return Answer(self._native.sweep(count, into, how, shown(progress), audit), self)

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
        progress: AnyProgress = None,
        audit: bool = True,
    ) -> Answer:
        """Lets an optimizer choose the points. Without `audit` no further runs check the answer, as with `--no-audit`.

        >>> study.tune(optimizer="nelder-mead", budget=12).summary.tuning.evaluated
        12
        """
        if isinstance(optimizer, Optimizer):
            name = optimizer.name
            own = (optimizer.design, optimizer.batch, optimizer._proposer())
        else:
            name, own = optimizer, None
        how, into, count = mode(resume, restart), folder_name(folder), whole("jobs", jobs)
        most, patient = whole("budget", budget), whole("patience", patience)
        if most is None:
            raise usage("not a number of points", field="budget", found=None, allowed="a whole number")
        return Answer(
            self._native.tune(name, own, most, patient, count, into, how, shown(progress), audit),
            self,
        )

    def ensemble(
        self,
        *,
        repeats: int = 200,
        noise: Noise = None,
        seed: Optional[int] = None,
        model_error: bool = True,
        posterior: Optional[Path] = None,
        other_engine: Optional[OtherEngine] = None,
        jobs: Optional[int] = None,
        folder: Optional[Path] = None,
        progress: AnyProgress = None,
    ) -> Ensemble:
        """Repeats the study's runs under noise. `posterior` is the results folder of a sweep or tuning whose draws are simulated as further models;
        `other_engine` as in `realgap.predict`.

        >>> answer.fitted.ensemble(repeats=5, model_error=False).repeats.rows
        5
        """
        return ensemble_of(
            self._native, repeats, noise, seed, model_error, posterior, other_engine, jobs, folder, progress
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
        progress: AnyProgress = None,
    ) -> Gap:
        """Measures the gap between simulation and reality in noise floors.

        >>> len(answer.fitted.gap(metrics=["rms"], repeats=5).metrics)
        1
        """
        return gap_of(self._native, metrics, repeats, noise, seed, jobs, folder, progress)

    def __repr__(self) -> str:
        info = self._info
        count, varied = len(info.recordings), ", ".join(self.parameters)
        return f"Study {self.name}: {info.robot}, {count} recordings, {varied} by {info.metric}"


def _range(values: Range) -> Tuple[float, float, int]:
    if len(values) == 2:
        return (float(values[0]), float(values[1]), POINTS)
    return (float(values[0]), float(values[1]), int(values[2]))


def _wishes(
    recordings: Union[str, Sequence[str], None],
    every: Optional[int],
    offset: int,
    limit_recordings: Optional[int],
    duration_s: Optional[float],
    points: Optional[int],
    seed: Optional[int],
    score: Optional[str],
    basis: Optional[Path],
    set: Optional[Mapping[str, float]],
    parameters: Parameters,
    folds: Optional[int],
    hold_out: Optional[float],
    reading: Optional[Mapping[str, Given]],
    allow_command: bool,
) -> str:
    files, values = files_and_values(parameters)
    return asked(
        "a study",
        recordings=[recordings] if isinstance(recordings, str) else list(recordings or ()),
        every=every,
        offset=offset,
        limit_recordings=limit_recordings,
        duration_s=duration_s,
        points=points,
        seed=seed,
        score=score,
        basis=basis,
        set={**values, **(set or {})},
        parameters=files,
        folds=folds,
        hold_out=hold_out,
        reading=dict(reading or {}),
        allow_command=allow_command,
    )
