"""Robots, from files, texts and dicts."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Callable, List, Mapping, Tuple

from . import _native
from ._error import usage
from ._json import Given, JsonObject, asked, made, parsed
from ._picture import one, page
from ._run import Path
from ._warning import Warning


@dataclass(frozen=True)
class _Info:
    name: str
    modules: Tuple[str, ...]
    parts: Tuple[Tuple[str, ...], ...]
    hinges: Tuple[str, ...]
    mass_kg: float
    body_length_m: float
    warnings: Tuple[Warning, ...]


def native_robot(robot: object) -> _native.Robot:
    """A robot as the native half takes it."""
    if isinstance(robot, Robot):
        return robot._native
    raise usage(
        "not a robot",
        field="robot",
        found=type(robot).__name__,
        allowed="a realgap.Robot",
        hint="Robot.read(path) reads one",
    )


class Robot:
    """A robot of cubes and hinges, checked. Use `Robot.read`, `Robot.from_text` or `Robot.from_dict`.

    >>> robot
    Robot tripod: 4 modules, 3 hinges, 0.27 kg
    """

    def __init__(self, native: _native.Robot) -> None:
        self._native = native
        self._info = made(_Info, native.info())

    @classmethod
    def read(cls, path: Path) -> "Robot":
        """A robot from its RON file.

        >>> realgap.Robot.read("morphologies/spider8.ron").name
        'spider8'
        """
        return cls(_native.Robot.read(os.fspath(path)))

    @classmethod
    def from_text(cls, text: str, name: str = "robot") -> "Robot":
        """A robot from RON; errors call the text by `name`.

        >>> realgap.Robot.from_text(robot.to_ron()).parts == robot.parts
        True
        """
        return cls(_native.Robot.parse(name, text, False))

    @classmethod
    def from_dict(cls, fields: Mapping[str, Given]) -> "Robot":
        """A robot from the fields of its file. A variant with fields, `Passive(side_m: 0.1)`, is `{"Passive": {"side_m": 0.1}}`.

        >>> cube = {"name": "body", "kind": {"Passive": {"side_m": 0.1, "mass_kg": 0.37}}}
        >>> realgap.Robot.from_dict({"name": "cube", "modules": [cube]}).mass_kg
        0.37
        """
        name = str(fields.get("name", "robot"))
        return cls(_native.Robot.parse(name, asked("a robot", **dict(fields)), True))

    def to_ron(self) -> str:
        """The text of its file.

        >>> "tripod" in robot.to_ron()
        True
        """
        return self._native.ron()

    @property
    def name(self) -> str:
        """Its name.

        >>> robot.name
        'tripod'
        """
        return self._info.name

    @property
    def modules(self) -> List[str]:
        """Names of its modules.

        >>> robot.modules
        ['core', 'leg_a', 'leg_b', 'leg_c']
        """
        return list(self._info.modules)

    @property
    def hinges(self) -> List[str]:
        """Names of its hinges, in the order of joint angles.

        >>> robot.hinges
        ['leg_a', 'leg_c', 'leg_b']
        """
        return list(self._info.hinges)

    @property
    def parts(self) -> List[List[str]]:
        """Its rigid parts, as names of modules, in the order of poses.

        >>> len(robot.parts)
        4
        """
        return [list(part) for part in self._info.parts]

    @property
    def mass_kg(self) -> float:
        """Its mass.

        >>> round(robot.mass_kg, 6)
        0.27
        """
        return self._info.mass_kg

    @property
    def body_length_m(self) -> float:
        """Longest edge of the tracked module.

        >>> robot.body_length_m
        0.06
        """
        return self._info.body_length_m

    @property
    def info(self) -> JsonObject:
        """All numbers of the robot: mass, size, centre of mass, the tracked module.

        >>> robot.info["servos"]
        3
        """
        return parsed(self._native.info())

    @property
    def warnings(self) -> Tuple[Warning, ...]:
        """Warnings about the robot.

        >>> [warning.code for warning in robot.warnings]
        ['servo-too-slow']
        """
        return self._info.warnings

    def picture(self) -> bytes:
        r"""A picture of the robot, a PNG.

        >>> robot.picture()[:4]
        b'\x89PNG'
        """
        return one(self._native.draw)

    def __reduce__(self) -> Tuple[Callable[[str, str], "Robot"], Tuple[str, str]]:
        return (Robot.from_text, (self.to_ron(), self.name))

    def __repr__(self) -> str:
        count = len(self.modules)
        return f"Robot {self.name}: {count} modules, {len(self.hinges)} hinges, {self.mass_kg:.3g} kg"

    def _repr_html_(self) -> str:
        return page(repr(self), [self.picture()], self.warnings)
