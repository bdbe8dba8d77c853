"""One run of one robot."""

from __future__ import annotations

import json
import os
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Union

import numpy as np
import numpy.typing as npt

from . import _native
from ._array import Floats, asked, given, got, sent
from ._callback import number
from ._error import CallbackError, Error, usage
from ._picture import page
from ._robot import Path, Robot, native_robot
from ._trajectory import Trajectory

# A gait: angles by hinge at a time, seconds from the start of the run.
Gait = Callable[[float], Mapping[str, float]]
Parameters = Union[Mapping[str, float], Path, Sequence[Path], None]


class Simulation:
    """What a run did: every part and hinge, as arrays over the same times."""

    def __init__(self, native: _native.Simulation, robot: Robot, name: str) -> None:
        self._native = native
        self._info: Dict[str, Any] = json.loads(native.info())
        self.robot = robot
        with_joints = bool(self._info["records_joints"])
        self.trajectory = Trajectory._of(native.trajectory(name, with_joints))

    @property
    def times_s(self) -> Floats:
        """Times, n."""
        return self.trajectory.times_s

    @property
    def positions_m(self) -> Floats:
        """Positions of the tracked module in the world, n x 3."""
        return self.trajectory.positions_m

    @property
    def quaternions(self) -> Floats:
        """Orientations of the tracked module, world from body, real part first, n x 4."""
        turned = self.trajectory.quaternions
        assert turned is not None, "every simulated motion has orientations"
        return turned

    @property
    def part_positions_m(self) -> Floats:
        """Positions of all rigid parts, n x parts x 3, in the order of `Robot.parts`."""
        return got(self._native.parts()[0], len(self.trajectory), len(self.robot.parts), 3)

    @property
    def part_quaternions(self) -> Floats:
        """Orientations of all rigid parts, real part first, n x parts x 4."""
        return got(self._native.parts()[1], len(self.trajectory), len(self.robot.parts), 4)

    @property
    def joint_angles_rad(self) -> Floats:
        """Angles of all hinges, n x hinges, in the order of `Robot.hinges`."""
        return got(self._native.joints()[0], len(self.trajectory), len(self.robot.hinges))

    @property
    def joint_speeds_rad_s(self) -> Floats:
        """Speeds of all hinges, n x hinges."""
        return got(self._native.joints()[1], len(self.trajectory), len(self.robot.hinges))

    @property
    def net_displacement_m(self) -> float:
        """Distance from start to end in the plane."""
        moved = self.trajectory.net_displacement_m
        return float(np.hypot(moved[0], moved[1]))

    @property
    def energy(self) -> Optional[Dict[str, float]]:
        """Where the energy came from and went, J; with `energy=True`."""
        energy: Optional[Dict[str, float]] = self._info["energy"]
        return energy

    @property
    def info(self) -> Dict[str, Any]:
        """Steps, CPU time, servo error, solver and engine."""
        return dict(self._info)

    @property
    def warnings(self) -> List[Dict[str, str]]:
        """What the reader should know."""
        return list(self._info["warnings"])

    def write(self, path: Path) -> List[Dict[str, str]]:
        """Writes the tracked motion, the same bytes as `realgap simulate -o`."""
        return self.trajectory.write(path)

    def write_parts(self, path: Path) -> None:
        """Writes all parts and hinges as CSV, the same bytes as `realgap simulate --parts`."""
        self._native.write_parts(os.fspath(path))

    def __repr__(self) -> str:
        return (
            f"Simulation of {self.robot.name}: {self.trajectory.duration_s:.4g} s,"
            f" net displacement {100.0 * self.net_displacement_m:.2f} cm"
        )

    def _repr_html_(self) -> str:
        return page(repr(self), [self.trajectory.picture()], self.warnings)


def simulate(
    robot: Robot,
    *,
    duration_s: float = 10.0,
    parameters: Parameters = None,
    rate_hz: float = 60.0,
    times_s: Optional[npt.ArrayLike] = None,
    timestep_s: Optional[float] = None,
    substeps: Optional[int] = None,
    joint: Optional[str] = None,
    arena: Optional[Path] = None,
    gait: Optional[Gait] = None,
    gait_rate_hz: float = 240.0,
    energy: bool = False,
    name: Optional[str] = None,
) -> Simulation:
    """Simulates a robot from rest, as `realgap simulate` does, to the same bits.

    `parameters` are values by name, or files such as the `best.ron` of a sweep. `gait(t_s)` gives angles in radians by hinge, in
    place of the gaits of the file; it is asked `gait_rate_hz` times a second before the run, with straight lines between, so that
    it cannot react to the robot. Servos that it does not name keep their own gaits. `name` is what pictures call the motion.
    """
    files, values = _parameters(parameters)
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
    )
    times = None if times_s is None else sent(given(times_s, "times_s", (None,)))
    commands = [] if gait is None else _commands(gait, float(duration_s), float(gait_rate_hz))
    run = _native.simulate(native_robot(robot), settings, times, commands)
    return Simulation(run, robot, robot.name if name is None else name)


def _parameters(parameters: Parameters) -> "tuple[List[str], Dict[str, float]]":
    if parameters is None:
        return [], {}
    if isinstance(parameters, Mapping):
        return [], dict(parameters)
    if isinstance(parameters, (str, os.PathLike)):
        return [os.fspath(parameters)], {}
    return [os.fspath(file) for file in parameters], {}


def _commands(gait: Gait, duration_s: float, rate_hz: float) -> "List[tuple[str, bytes, bytes]]":
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


def _angles(gait: Gait, t_s: float) -> Dict[str, float]:
    try:
        angles = gait(t_s)
        if not isinstance(angles, Mapping):
            raise TypeError(f"the gait must give a dict of angles by hinge, not {angles!r}")
        return {str(hinge): number(a, f"the gait of {hinge}") for hinge, a in angles.items()}
    except Error:
        raise
    except Exception as error:
        kind = type(error).__name__
        raise CallbackError(f"the gait raised {kind}: {error}\n  found:   at t_s = {t_s:.6g}") from error
