"""One run of one robot."""

from __future__ import annotations

import csv
import io
import os
from dataclasses import dataclass
from typing import Callable, Dict, List, Literal, Mapping, Optional, Tuple

import numpy as np
import numpy.typing as npt

from . import _native
from ._array import Floats, given, got, sent
from ._callback import number
from ._error import CallbackError, Error, usage
from ._feedback import Step
from ._feedback import asked as stepping
from ._json import JsonObject, asked, made, parsed
from ._robot import Robot, native_robot
from ._run import Parameters, Path, files_and_values
from ._table import Cell, Table
from ._trajectory import Trajectory
from ._warning import Warning

# A gait: a function that returns angles by hinge at a time, in seconds from the start of the run.
Gait = Callable[[float], Mapping[str, float]]
JointKind = Literal["auto", "multibody", "impulse"]


@dataclass(frozen=True)
class EnergyBalance:
    """The energy balance of a run, joules: all parts but the servos' positive part add up to the kinetic energy.

    >>> energy = realgap.simulate(robot, duration_s=0.5, energy=True).energy
    >>> energy.servo_positive_j > 0.0
    True
    """

    servo_j: float
    servo_positive_j: float
    gravity_j: float
    contact_j: float
    friction_j: float
    joint_j: float
    slack_j: float
    kinetic_j: float
    residual_j: float


@dataclass(frozen=True)
class _Info:
    records_joints: bool
    energy: Optional[EnergyBalance]
    warnings: Tuple[Warning, ...]


class Simulation(Trajectory):
    """The motion of one run: of the tracked module, and of every part and hinge, as arrays over the same times.

    >>> isinstance(run, realgap.Trajectory), run.robot.name
    (True, 'tripod')
    """

    def __init__(self, native: _native.Simulation, robot: Robot, name: str) -> None:
        self._run = native
        self._facts = made(_Info, native.info())
        self.robot = robot
        self._adopt(native.trajectory(name, self._facts.records_joints))

    @property
    def quaternions(self) -> Floats:
        """Orientations of the tracked module, world from body, real part first, n x 4.

        >>> run.quaternions.shape
        (31, 4)
        """
        turned = super().quaternions
        assert turned is not None, "every simulated motion has orientations"
        return turned

    @property
    def part_positions_m(self) -> Floats:
        """Positions of all rigid parts, n x parts x 3, in the order of `Robot.parts`.

        >>> run.part_positions_m.shape
        (31, 4, 3)
        """
        return got(self._run.parts()[0], len(self), len(self.robot.parts), 3)

    @property
    def part_quaternions(self) -> Floats:
        """Orientations of all rigid parts, real part first, n x parts x 4.

        >>> run.part_quaternions.shape
        (31, 4, 4)
        """
        return got(self._run.parts()[1], len(self), len(self.robot.parts), 4)

    @property
    def joint_angles_rad(self) -> Floats:
        """Angles of all hinges, n x hinges, in the order of `Robot.hinges`.

        >>> run.joint_angles_rad.shape
        (31, 3)
        """
        return got(self._run.joints()[0], len(self), len(self.robot.hinges))

    @property
    def joint_speeds_rad_s(self) -> Floats:
        """Speeds of all hinges, n x hinges.

        >>> run.joint_speeds_rad_s.shape
        (31, 3)
        """
        return got(self._run.joints()[1], len(self), len(self.robot.hinges))

    @property
    def others(self) -> Dict[str, Trajectory]:
        """The motions of the other robots of a controller, by name, in the frame of this robot.

        >>> run.others
        {}
        """
        return {name: Trajectory._of(native) for name, native in self._run.others()}

    @property
    def decisions(self) -> Table:
        """Readings, messages and decisions, one row per decision of a robot; empty without a controller or a `step`.

        >>> seeing = realgap.simulate(robot, duration_s=0.5, controller="controllers/tripod_avoid.ron", seed=1)
        >>> list(seeing.decisions), seeing.decisions.rows
        (['t_s', 'robot', 'x_m', 'y_m', 'z_m', 'front', 'rule', 'heard'], 5)
        """
        rows = list(csv.reader(io.StringIO(self._run.decisions())))
        texts = {"robot", "heard"}
        columns: Dict[str, List[Cell]] = {}
        for index, name in enumerate(rows[0] if rows else []):
            cells = [row[index] for row in rows[1:]]
            columns[name] = [cell if name in texts else _number(cell) for cell in cells]
        return Table(columns)

    def write_decisions(self, path: Path) -> None:
        """Writes the decisions as CSV, with the same bytes as `realgap simulate --decisions`.

        >>> run.write_decisions(folder / "decisions.csv")
        """
        with open(path, "w", encoding="utf-8", newline="") as file:
            file.write(self._run.decisions())

    @property
    def energy(self) -> Optional[EnergyBalance]:
        """The energy balance, with `energy=True`.

        >>> run.energy is None
        True
        """
        return self._facts.energy

    @property
    def info(self) -> JsonObject:
        """Steps, CPU time, servo error, solver and engine.

        >>> run.info["robot"]
        'tripod'
        """
        return parsed(self._run.info())

    @property
    def warnings(self) -> Tuple[Warning, ...]:
        """Warnings about the run.

        >>> "servo-too-slow" in [warning.code for warning in run.warnings]
        True
        """
        return self._facts.warnings

    def write_parts(self, path: Path) -> None:
        """Writes all parts and hinges as CSV, the same bytes as `realgap simulate --parts`.

        >>> run.write_parts(folder / "parts.csv")
        """
        self._run.write_parts(os.fspath(path))

    def __repr__(self) -> str:
        return (
            f"Simulation of {self.robot.name}: {self.duration_s:.4g} s,"
            f" net displacement {100.0 * self.net_displacement_m:.2f} cm"
        )


def simulate(
    robot: Robot,
    *,
    duration_s: float = 10.0,
    parameters: Parameters = None,
    rate_hz: float = 60.0,
    times_s: Optional[npt.ArrayLike] = None,
    timestep_s: Optional[float] = None,
    substeps: Optional[int] = None,
    joint: Optional[JointKind] = None,
    arena: Optional[Path] = None,
    gait: Optional[Gait] = None,
    commands: Optional[Mapping[str, npt.ArrayLike]] = None,
    commands_at_s: Optional[npt.ArrayLike] = None,
    gait_rate_hz: float = 240.0,
    controller: Optional[Path] = None,
    seed: Optional[int] = None,
    step: Optional[Step] = None,
    step_rate_hz: Optional[float] = None,
    energy: bool = False,
    name: Optional[str] = None,
) -> Simulation:
    """Simulates a robot from rest, as `realgap simulate` does, to the same bits.

    `parameters` are values by name, or files such as the `best.ron` of a sweep. `gait(t_s)` gives angles in radians by hinge, in
    place of the gaits of the file; it is called `gait_rate_hz` times per simulated second before the run, and its angles are
    interpolated, so that it cannot react to the robot. Servos that it does not name keep their own gaits. Pictures call the motion
    by `name`.

    `commands` are arrays of angles in radians by hinge, at the times `commands_at_s`, with straight lines between; they take the
    place of a gait.

    `controller` is a file with sensors, rules, other robots and radio (docs/control.md); `seed` is the seed of their noise.
    `step(sensed)` overrides the rules: it is called at every decision with the knowledge of a robot (`Sensed`) and returns angles in
    radians by hinge, which hold until the next decision; servos that it does not name are not changed. It is called `step_rate_hz`
    times a second (default: the rate of the file, or 50).

    >>> slow = realgap.simulate(robot, duration_s=0.5, parameters={"floor.friction": 0.4}, rate_hz=10.0)
    >>> len(slow)
    6
    >>> bent = realgap.simulate(robot, duration_s=0.5, commands={"leg_a": [0.0, 0.3]}, commands_at_s=[0.0, 0.5])
    >>> bool(bent.joint_angles_rad[-1, 0] > 0.1)
    True
    >>> def upright(sensed):
    ...     return {hinge: 0.5 * angle for hinge, angle in sensed.angles_rad.items()} if sensed.time_s > 0.2 else None
    >>> bool(abs(realgap.simulate(robot, duration_s=0.5, step=upright).joint_angles_rad[-1]).max() < 0.1)
    True
    """
    if arena is not None and controller is not None:
        raise usage("a controller has an arena of its own", field="arena", found=arena)
    if step is None and controller is None and step_rate_hz is not None:
        raise usage("nothing decides without a controller", field="step_rate_hz", hint="give controller= or a function step=")
    model = native_robot(robot)
    files, values = files_and_values(parameters)
    settings = asked(
        "simulate",
        duration_s=duration_s,
        rate_hz=rate_hz,
        set=values,
        parameters=files,
        timestep_s=timestep_s,
        substeps=substeps,
        joint=joint,
        arena=arena,
        energy=energy,
        steering={"controller": controller, "seed": seed, "step_rate_hz": step_rate_hz},
    )
    times = None if times_s is None else sent(given(times_s, "times_s", (None,)))
    driven = [] if gait is None else _commands(gait, float(duration_s), float(gait_rate_hz))
    if commands is not None:
        if gait is not None:
            raise usage("a gait and commands exclude each other", field="commands", hint="give one of them")
        driven = _given_commands(commands, commands_at_s, robot.hinges)
    elif commands_at_s is not None:
        raise usage("times without commands", field="commands_at_s", hint="give commands={HINGE: angles_rad}, too")
    feedback = None if step is None else stepping(step)
    run = _native.simulate(model, settings, times, driven, feedback)
    return Simulation(run, robot, robot.name if name is None else name)


def _number(cell: str) -> Cell:
    return float(cell) if cell else None


def _commands(gait: Gait, duration_s: float, rate_hz: float) -> List[Tuple[str, bytes, bytes]]:
    if not (np.isfinite(rate_hz) and 0.0 < rate_hz <= 1e5):
        raise usage("out of range", field="gait_rate_hz", found=rate_hz, allowed="more than 0, at most 1e5")
    if not (np.isfinite(duration_s) and 0.0 < duration_s <= 3600.0):
        raise usage("out of range", field="duration_s", found=duration_s, allowed="more than 0, at most 3600 s")
    times = np.arange(int(np.ceil(duration_s * rate_hz)) + 1) / rate_hz
    columns: Dict[str, List[float]] = {}
    for t_s in times:
        angles = _angles(gait, float(t_s))
        if not columns:
            columns = {hinge: [] for hinge in angles}
        if angles.keys() != columns.keys():
            raise usage(
                "the gait names other hinges than at the start",
                field=f"gait({t_s:.6g})",
                found=", ".join(angles),
                allowed=", ".join(columns),
            )
        for hinge, angle in angles.items():
            columns[hinge].append(angle)
    track = sent(given(times, "times", (None,)))
    return [(hinge, track, sent(given(a, hinge, (None,)))) for hinge, a in columns.items()]


def _given_commands(
    commands: Mapping[str, npt.ArrayLike], at_s: Optional[npt.ArrayLike], hinges: List[str]
) -> List[Tuple[str, bytes, bytes]]:
    if at_s is None:
        raise usage("commands without times", field="commands_at_s", allowed="the times of the commands, seconds from the start")
    times = given(at_s, "commands_at_s", (None,))
    for hinge in commands:
        if hinge not in hinges:
            raise usage("no hinge of this name", field="commands", found=hinge, allowed=", ".join(hinges))
    return [
        (hinge, sent(times), sent(given(angles, f"commands[{hinge!r}]", (len(times),))))
        for hinge, angles in commands.items()
    ]


def _angles(gait: Gait, t_s: float) -> Dict[str, float]:
    try:
        angles: object = gait(t_s)
        if not isinstance(angles, Mapping):
            raise TypeError(f"the gait must give a dict of angles by hinge, not {angles!r}")
        return {str(hinge): number(a, f"the gait of {hinge}") for hinge, a in angles.items()}
    except Error:
        raise
    except Exception as error:
        kind = type(error).__name__
        raise CallbackError(f"the gait raised {kind}: {error}\n  found:   at t_s = {t_s:.6g}") from error
