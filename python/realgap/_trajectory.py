"""Motions: recorded, simulated or computed."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from typing import Any, Dict, List, Mapping, Optional, Tuple, Union

import numpy as np
import numpy.typing as npt

from . import _native
from ._array import Floats, asked, given, got, sent
from ._error import usage
from ._picture import one, page
from ._robot import Path


@dataclass(frozen=True)
class Joint:
    """Angles of a joint, and its speeds where they are known."""

    angles_rad: Floats
    speeds_rad_s: Optional[Floats]


@dataclass(frozen=True)
class Prepared:
    """A path as paths are compared: 182 points uniform in time, from the origin, net displacement along +x."""

    xy_m: Floats
    z_m: Optional[Floats]
    quaternions: Optional[Floats]
    net_displacement_m: float
    path_length_m: float
    heading_rad: float
    warnings: List[Dict[str, str]]


def native_trajectory(motion: Any) -> _native.Trajectory:
    """A motion as the library takes it."""
    if isinstance(motion, Trajectory):
        return motion._native
    raise usage(
        "not a trajectory",
        found=type(motion).__name__,
        allowed="a realgap.Trajectory",
        hint="Trajectory.read(path) reads one, Trajectory(times_s, positions_m) makes one",
    )


class Trajectory:
    """Times, positions, and what else is known of a motion. It never changes; its arrays are read-only."""

    def __init__(
        self,
        times_s: npt.ArrayLike,
        positions_m: npt.ArrayLike,
        quaternions: Optional[npt.ArrayLike] = None,
        *,
        velocities_m_s: Optional[npt.ArrayLike] = None,
        angular_velocities_body_rad_s: Optional[npt.ArrayLike] = None,
        joints: Optional[Mapping[str, npt.ArrayLike]] = None,
        name: str = "trajectory",
        stand_in_of: Optional[str] = None,
    ) -> None:
        """A motion from arrays.

        `positions_m` is n x 3 in the world, z up, or n x 2 where heights are not known; `quaternions` is n x 4, world from
        body, real part first. `stand_in_of` names the robot where no hardware made this motion: pictures say so then.
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
        self._adopt(
            _native.Trajectory.new(
                str(name), sent(times), positions, turned, velocities, angles, planar, stand_in_of
            )
        )

    @classmethod
    def _of(cls, native: _native.Trajectory) -> "Trajectory":
        made = cls.__new__(cls)
        made._adopt(native)
        return made

    def _adopt(self, native: _native.Trajectory) -> None:
        self._native = native
        self._info: Dict[str, Any] = json.loads(native.info())
        self._count = int(self._info["samples"])

    @classmethod
    def read(cls, path: Path, reading: Optional[Mapping[str, Any]] = None) -> "Trajectory":
        """The motion in a CSV or TUM file. `reading` is what a study says under that name, e.g. `{"length": "mm"}`."""
        all_of_it = cls.read_all(path, reading)
        if len(all_of_it) != 1:
            raise usage(
                "the file holds several recordings",
                field="path",
                found=len(all_of_it),
                hint="use Trajectory.read_all",
            )
        return all_of_it[0]

    @classmethod
    def read_all(
        cls, path: Path, reading: Optional[Mapping[str, Any]] = None
    ) -> List["Trajectory"]:
        """Every motion in a file that holds several, told apart by the column `run`."""
        how = asked("reading", **dict(reading or {}))
        return [cls._of(native) for native in _native.Trajectory.read(os.fspath(path), how)]

    def write(self, path: Path) -> List[Dict[str, str]]:
        """Writes it as CSV or TUM, by the ending; returns what the format cannot hold."""
        return list(json.loads(self._native.write(os.fspath(path))))

    @property
    def name(self) -> str:
        """Its name: that of the file."""
        return str(self._info["name"])

    @property
    def times_s(self) -> Floats:
        """Times, n."""
        return got(self._native.times_s(), self._count)

    @property
    def positions_m(self) -> Floats:
        """Positions of the tracked point in the world, n x 3."""
        return got(self._native.positions(), self._count, 3)

    @property
    def quaternions(self) -> Optional[Floats]:
        """Orientations, world from body, real part first, n x 4."""
        data = self._native.orientations()
        return None if data is None else got(data, self._count, 4)

    @property
    def velocities_m_s(self) -> Optional[Floats]:
        """Velocities in the world, n x 3."""
        data = self._native.velocities()
        return None if data is None else got(data[0], self._count, 3)

    @property
    def angular_velocities_body_rad_s(self) -> Optional[Floats]:
        """Angular velocities in the frame of the body, n x 3."""
        data = self._native.velocities()
        return None if data is None else got(data[1], self._count, 3)

    @property
    def joints(self) -> Dict[str, Joint]:
        """Joints by name."""
        found: Dict[str, Joint] = {}
        for name in self._info["joints"]:
            data = self._native.joint(name)
            if data is not None:
                speeds = None if data[1] is None else got(data[1], self._count)
                found[name] = Joint(got(data[0], self._count), speeds)
        return found

    @property
    def bodies(self) -> Dict[str, "Trajectory"]:
        """Motions of other bodies in the same file, by name."""
        return {name: Trajectory._of(native) for name, native in self._native.bodies()}

    @property
    def is_planar(self) -> bool:
        """Whether heights are unknown."""
        return bool(self._info["is_planar"])

    @property
    def is_stand_in(self) -> bool:
        """Whether it was made by a program in place of hardware."""
        return bool(self._info["is_stand_in"])

    @property
    def duration_s(self) -> float:
        """From the first sample to the last."""
        return float(self._info["duration_s"])

    @property
    def net_displacement_m(self) -> Floats:
        """Last position minus first, 3."""
        return given(self._info["net_displacement_world_m"], "net_displacement_m", (3,))

    @property
    def warnings(self) -> List[Dict[str, str]]:
        """What the reader should know."""
        return list(self._info["warnings"])

    def __len__(self) -> int:
        return self._count

    def __repr__(self) -> str:
        return f"Trajectory {self.name}: {self._count} samples, {self.duration_s:.4g} s"

    def picture(self) -> bytes:
        """Its prepared path, a PNG."""
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
    """Brings a path into the form in which paths are compared."""
    xy, z, turned, info = native_trajectory(trajectory).prepare()
    count = len(xy) // 16
    rest: Dict[str, Any] = json.loads(info)
    return Prepared(
        xy_m=got(xy, count, 2),
        z_m=None if z is None else got(z, count),
        quaternions=None if turned is None else got(turned, count, 4),
        **rest,
    )


Trajectories = Union[Trajectory, List[Trajectory], Tuple[Trajectory, ...]]
