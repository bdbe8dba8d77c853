"""Motions: recorded, simulated or computed."""

from __future__ import annotations

import os
import tempfile
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Dict, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np
import numpy.typing as npt

from . import _native
from ._array import Floats, given, got, sent
from ._error import usage
from ._json import Given, JsonObject, asked, made, many, parsed
from ._picture import one, page
from ._run import Path
from ._warning import Warning

if TYPE_CHECKING:
    import pandas


@dataclass(frozen=True)
class Joint:
    """Angles of a joint, and its speeds where they are known.

    >>> realgap.Trajectory([0, 1], [[0, 0], [1, 0]], joints={"knee": [0.0, 0.5]}).joints["knee"].angles_rad
    array([0. , 0.5])
    """

    angles_rad: Floats
    speeds_rad_s: Optional[Floats]


@dataclass(frozen=True)
class _Measures:
    net_displacement_m: float
    path_length_m: float
    heading_rad: float
    warnings: Tuple[Warning, ...]


@dataclass(frozen=True)
class Prepared(_Measures):
    """A path in the form in which paths are compared: 182 points uniform in time, from the origin, net displacement along +x.

    >>> realgap.prepare(recordings[0]).xy_m.shape
    (182, 2)
    """

    xy_m: Floats
    z_m: Optional[Floats]
    quaternions: Optional[Floats]


@dataclass(frozen=True)
class _Info:
    name: str
    samples: int
    duration_s: float
    net_displacement_world_m: Tuple[float, float, float]
    is_planar: bool
    is_stand_in: bool
    joints: Tuple[str, ...]
    signals: Tuple[str, ...]
    warnings: Tuple[Warning, ...]


Trajectories = Union["Trajectory", Sequence["Trajectory"]]


def native_trajectory(motion: object) -> _native.Trajectory:
    """A motion as the native half takes it."""
    if isinstance(motion, Trajectory):
        return motion._native
    raise usage(
        "not a trajectory",
        found=type(motion).__name__,
        allowed="a realgap.Trajectory or realgap.Simulation",
        hint="Trajectory.read(path) reads one, Trajectory(times_s, positions_m) makes one",
    )


def native_trajectories(motions: Trajectories) -> List[_native.Trajectory]:
    """One motion or several as the native half takes them."""
    if isinstance(motions, Sequence) and not isinstance(motions, str):
        return [native_trajectory(motion) for motion in motions]
    return [native_trajectory(motions)]


class Trajectory:
    """A motion: times, positions, and where known orientations, velocities and joints. It is immutable; its arrays are read-only.

    >>> realgap.Trajectory([0.0, 0.5, 1.0], [[0, 0, 0], [0.1, 0, 0], [0.3, 0, 0]], name="push")
    Trajectory push: 3 samples, 1 s
    """

    def __init__(
        self,
        times_s: npt.ArrayLike,
        positions_m: npt.ArrayLike,
        quaternions: Optional[npt.ArrayLike] = None,
        *,
        velocities_m_s: Optional[npt.ArrayLike] = None,
        angular_velocities_body_rad_s: Optional[npt.ArrayLike] = None,
        joints: Optional[Mapping[str, npt.ArrayLike]] = None,
        signals: Optional[Mapping[str, npt.ArrayLike]] = None,
        commands: Optional[Mapping[str, npt.ArrayLike]] = None,
        name: str = "trajectory",
        stand_in_of: Optional[str] = None,
    ) -> None:
        """A motion from arrays.

        `positions_m` is n x 3 in the world, z up, or n x 2 where heights are not known; `quaternions` is n x 4, world from
        body, real part first. `commands` are commanded angles in radians by joint, which `Study.of` lets the servos follow; other
        commands are signals by column, e.g. `knee_command_nm`. `stand_in_of` names the robot where a program and not hardware made
        this motion; pictures then say so.

        >>> realgap.Trajectory(run.times_s, run.positions_m, run.quaternions, stand_in_of="tripod").is_stand_in
        True
        >>> asked = realgap.Trajectory([0, 1], [[0, 0], [1, 0]], joints={"knee": [0.0, 0.4]}, commands={"knee": [0.0, 0.5]})
        >>> list(asked.joints)
        ['knee', 'knee_command']
        """
        times = given(times_s, "times_s", (None,))
        count = len(times)
        positions, planar = _positions(positions_m, count)
        turned = None if quaternions is None else sent(given(quaternions, "quaternions", (count, 4)))
        velocities: Optional[Tuple[bytes, bytes]] = None
        if velocities_m_s is not None and angular_velocities_body_rad_s is not None:
            linear = given(velocities_m_s, "velocities_m_s", (count, 3))
            angular = given(
                angular_velocities_body_rad_s, "angular_velocities_body_rad_s", (count, 3)
            )
            velocities = (sent(linear), sent(angular))
        elif velocities_m_s is not None or angular_velocities_body_rad_s is not None:
            raise usage(
                "one kind of velocity alone",
                field="velocities_m_s",
                allowed="both velocities_m_s and angular_velocities_body_rad_s, or none",
            )
        angles = [
            (joint, sent(given(values, f"joints[{joint!r}]", (count,))), None)
            for joint, values in (joints or {}).items()
        ]
        more = [
            (signal, sent(given(values, f"signals[{signal!r}]", (count,))))
            for signal, values in (signals or {}).items()
        ]
        # A file has these in the column `NAME_command_rad`, which is read as the angle of a joint `NAME_command`.
        angles += [
            (f"{joint}_command", sent(given(values, f"commands[{joint!r}]", (count,))), None)
            for joint, values in (commands or {}).items()
        ]
        self._adopt(
            _native.Trajectory.new(
                str(name),
                sent(times),
                positions,
                turned,
                velocities,
                angles,
                more,
                planar,
                stand_in_of,
            )
        )

    @staticmethod
    def _of(native: _native.Trajectory) -> "Trajectory":
        motion = Trajectory.__new__(Trajectory)
        motion._adopt(native)
        return motion

    def _adopt(self, native: _native.Trajectory) -> None:
        self._native = native
        self._motion = made(_Info, native.info())

    @staticmethod
    def read(path: Path, reading: Optional[Mapping[str, Given]] = None) -> "Trajectory":
        """The motion in a file of any format that realgap reads. `reading` has the fields of a study's `reading`.

        >>> realgap.Trajectory.read("real_trajectories/tripod_standin/run_00.csv", {"length": "m"}).name
        'run_00'
        """
        all_of_it = Trajectory.read_all(path, reading)
        if len(all_of_it) != 1:
            raise usage(
                "the file holds several recordings",
                field="path",
                found=len(all_of_it),
                hint="use Trajectory.read_all",
            )
        return all_of_it[0]

    @staticmethod
    def read_all(path: Path, reading: Optional[Mapping[str, Given]] = None) -> List["Trajectory"]:
        """Every motion in a file that holds several, told apart by the column `run`.

        >>> len(realgap.Trajectory.read_all("real_trajectories/tripod_standin/run_00.csv"))
        1
        """
        how = asked("reading", **dict(reading or {}))
        return [Trajectory._of(native) for native in _native.Trajectory.read(os.fspath(path), how)]

    @staticmethod
    def from_pandas(
        frame: "pandas.DataFrame",
        reading: Optional[Mapping[str, Given]] = None,
        *,
        name: str = "trajectory",
    ) -> "Trajectory":
        """The motion in a frame, whose columns are read by the rules of a file's: `t_s`, `x_cm`, `knee_deg`, `knee_command_rad`.

        An index with a name is a column, too. `reading` has the fields of a study's `reading`.

        >>> import pandas
        >>> frame = pandas.DataFrame({"x_cm": [0.0, 5.0, 12.0], "y_cm": [0.0, 0.0, 1.0]}, index=pandas.Index([0.0, 0.5, 1.0], name="t_s"))
        >>> realgap.Trajectory.from_pandas(frame, name="push").positions_m[-1]
        array([0.12, 0.01, 0.  ])
        """
        if not hasattr(frame, "to_csv"):
            raise usage(
                "not a pandas frame",
                field="frame",
                found=type(frame).__name__,
                allowed="a pandas.DataFrame",
                hint="Trajectory(times_s, positions_m) takes arrays",
            )
        if os.path.basename(name) != name or not name:
            raise usage("not a name", field="name", found=repr(name), allowed="a name without slashes")
        has_index = any(level is not None for level in frame.index.names)
        with tempfile.TemporaryDirectory(prefix="realgap-") as folder:
            path = os.path.join(folder, f"{name}.csv")
            frame.to_csv(path, index=has_index)
            return Trajectory.read(path, reading)

    def write(self, path: Path) -> List[Warning]:
        """Writes the motion as CSV or TUM, by the ending of the file; returns warnings about data that the format cannot hold.

        >>> run.write(folder / "run.csv")
        []
        """
        return many(Warning, self._native.write(os.fspath(path)))

    @property
    def name(self) -> str:
        """Its name: that of the file, or of the robot that was simulated.

        >>> recordings[0].name, run.name
        ('run_00', 'tripod')
        """
        return self._motion.name

    @property
    def times_s(self) -> Floats:
        """Times, n.

        >>> float(run.times_s[-1])
        0.5
        """
        return got(self._native.times_s(), len(self))

    @property
    def positions_m(self) -> Floats:
        """Positions of the tracked point in the world, n x 3.

        >>> run.positions_m.shape
        (31, 3)
        """
        return got(self._native.positions(), len(self), 3)

    @property
    def quaternions(self) -> Optional[Floats]:
        """Orientations, world from body, real part first, n x 4.

        >>> run.quaternions.shape
        (31, 4)
        """
        data = self._native.orientations()
        return None if data is None else got(data, len(self), 4)

    @property
    def velocities_m_s(self) -> Optional[Floats]:
        """Velocities in the world, n x 3.

        >>> run.velocities_m_s.shape
        (31, 3)
        """
        data = self._native.velocities()
        return None if data is None else got(data[0], len(self), 3)

    @property
    def angular_velocities_body_rad_s(self) -> Optional[Floats]:
        """Angular velocities in the frame of the body, n x 3.

        >>> run.angular_velocities_body_rad_s.shape
        (31, 3)
        """
        data = self._native.velocities()
        return None if data is None else got(data[1], len(self), 3)

    @property
    def joints(self) -> Dict[str, Joint]:
        """Joints by name.

        >>> recordings[0].joints
        {}
        """
        found: Dict[str, Joint] = {}
        for name in self._motion.joints:
            data = self._native.joint(name)
            if data is not None:
                speeds = None if data[1] is None else got(data[1], len(self))
                found[name] = Joint(got(data[0], len(self)), speeds)
        return found

    @property
    def signals(self) -> Dict[str, Floats]:
        """Commands, and what sensors beside pose and joints measured (torques, currents, inertial sensors), by column.

        >>> torques = {"knee_torque_nm": [0.1, 0.2]}
        >>> realgap.Trajectory([0, 1], [[0, 0], [1, 0]], signals=torques).signals["knee_torque_nm"]
        array([0.1, 0.2])
        """
        found: Dict[str, Floats] = {}
        for name in self._motion.signals:
            data = self._native.signal(name)
            if data is not None:
                found[name] = got(data, len(self))
        return found

    @property
    def bodies(self) -> Dict[str, "Trajectory"]:
        """Motions of other bodies in the same file, by name.

        >>> recordings[0].bodies
        {}
        """
        return {name: Trajectory._of(native) for name, native in self._native.bodies()}

    @property
    def is_planar(self) -> bool:
        """Whether heights are unknown.

        >>> realgap.Trajectory([0, 1], [[0, 0], [1, 0]]).is_planar
        True
        """
        return self._motion.is_planar

    @property
    def is_stand_in(self) -> bool:
        """Whether it was made by a program in place of hardware.

        >>> recordings[0].is_stand_in
        True
        """
        return self._motion.is_stand_in

    @property
    def duration_s(self) -> float:
        """From the first sample to the last.

        >>> run.duration_s
        0.5
        """
        return self._motion.duration_s

    @property
    def displacement_m(self) -> Floats:
        """Last position minus first, 3.

        >>> realgap.Trajectory([0, 1], [[0, 0, 1], [3, 4, 1]]).displacement_m
        array([3., 4., 0.])
        """
        return given(self._motion.net_displacement_world_m, "displacement_m", (3,))

    @property
    def net_displacement_m(self) -> float:
        """Distance from start to end in the plane.

        >>> realgap.Trajectory([0, 1], [[0, 0], [3, 4]]).net_displacement_m
        5.0
        """
        moved = self._motion.net_displacement_world_m
        return float(np.hypot(moved[0], moved[1]))

    @property
    def info(self) -> JsonObject:
        """All numbers of the motion; for a simulation also steps, CPU time, servo error, solver and engine.

        >>> recordings[0].info["samples"] == len(recordings[0])
        True
        """
        return parsed(self._native.info())

    @property
    def warnings(self) -> Tuple[Warning, ...]:
        """Warnings about the motion.

        >>> recordings[0].warnings
        ()
        """
        return self._motion.warnings

    def __len__(self) -> int:
        return self._motion.samples

    def __array__(self, dtype: Any = None, copy: Optional[bool] = None) -> "np.ndarray[Any, Any]":
        """The positions, so that numpy takes a motion for an array of n x 3."""
        positions = self.positions_m
        # The array is a view of bytes, so that only a conversion or a wish makes a copy.
        return np.array(positions, dtype=dtype) if copy else np.asarray(positions, dtype=dtype)

    def __repr__(self) -> str:
        return f"Trajectory {self.name}: {len(self)} samples, {self.duration_s:.4g} s"

    def picture(self) -> bytes:
        r"""Its prepared path, a PNG.

        >>> recordings[0].picture()[:4]
        b'\x89PNG'
        """
        return one(self._native.draw)

    def _repr_html_(self) -> str:
        return page(repr(self), [self.picture()], self.warnings)


def _positions(positions_m: npt.ArrayLike, count: int) -> Tuple[bytes, bool]:
    if _width(positions_m) == 2:
        flat = given(positions_m, "positions_m", (count, 2))
        return sent(np.column_stack([flat, np.zeros(count)])), True
    return sent(given(positions_m, "positions_m", (count, 3))), False


def _width(rows: npt.ArrayLike) -> int:
    try:
        shape = np.shape(rows)
    except ValueError:
        return 0
    return shape[1] if len(shape) == 2 else 0


def prepare(trajectory: Trajectory) -> Prepared:
    """Brings a path into the form in which paths are compared.

    >>> realgap.prepare(run).xy_m.shape
    (182, 2)
    """
    xy, z, turned, info = native_trajectory(trajectory).prepare()
    count = len(xy) // 16
    rest = made(_Measures, info)
    return Prepared(
        rest.net_displacement_m,
        rest.path_length_m,
        rest.heading_rad,
        rest.warnings,
        xy_m=got(xy, count, 2),
        z_m=None if z is None else got(z, count),
        quaternions=None if turned is None else got(turned, count, 4),
    )
