"""Robots, from files, texts and dicts."""

from __future__ import annotations

import json
import os
from typing import Any, Dict, List, Mapping, Tuple, Union

from . import _native
from ._array import asked
from ._error import usage
from ._picture import one, page

Path = Union[str, "os.PathLike[str]"]


def native_robot(robot: Any) -> _native.Robot:
    """A robot as the library takes it."""
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
    """A robot of cubes and hinges, checked."""

    def __init__(self, native: _native.Robot) -> None:
        """Use `Robot.read`, `Robot.from_text` or `Robot.from_dict`."""
        self._native = native
        self._info: Dict[str, Any] = json.loads(native.info())

    @classmethod
    def read(cls, path: Path) -> "Robot":
        """A robot from its RON file."""
        return cls(_native.Robot.read(os.fspath(path)))

    @classmethod
    def from_text(cls, text: str, name: str = "robot") -> "Robot":
        """A robot from RON; `name` is what errors call the text."""
        return cls(_native.Robot.parse(name, text, False))

    @classmethod
    def from_dict(cls, fields: Mapping[str, Any]) -> "Robot":
        """A robot from the fields of its file. A variant with fields, `Active(face: PosX)`, is `{"Active": {"face": "PosX"}}`."""
        name = str(fields.get("name", "robot"))
        return cls(_native.Robot.parse(name, asked("a robot", **dict(fields)), True))

    def to_ron(self) -> str:
        """The text of its file."""
        return self._native.ron()

    @property
    def name(self) -> str:
        """Its name."""
        return str(self._info["name"])

    @property
    def modules(self) -> List[str]:
        """Names of its modules."""
        return list(self._info["modules"])

    @property
    def hinges(self) -> List[str]:
        """Names of its hinges, in the order of joint angles."""
        return list(self._info["hinges"])

    @property
    def parts(self) -> List[List[str]]:
        """Its rigid parts, as names of modules, in the order of poses."""
        return [list(part) for part in self._info["parts"]]

    @property
    def mass_kg(self) -> float:
        """Its mass."""
        return float(self._info["mass_kg"])

    @property
    def body_length_m(self) -> float:
        """Longest edge of the tracked module."""
        return float(self._info["body_length_m"])

    @property
    def info(self) -> Dict[str, Any]:
        """Everything in numbers: mass, size, centre of mass, what is tracked."""
        return dict(self._info)

    @property
    def warnings(self) -> List[Dict[str, str]]:
        """What the reader should know."""
        return list(self._info["warnings"])

    def picture(self) -> bytes:
        """A PNG."""
        return one(self._native.draw)

    def __reduce__(self) -> Tuple[Any, Tuple[str, str]]:
        return (Robot.from_text, (self.to_ron(), self.name))

    def __repr__(self) -> str:
        count = len(self.modules)
        return f"Robot {self.name}: {count} modules, {len(self.hinges)} hinges, {self.mass_kg:.3g} kg"

    def _repr_html_(self) -> str:
        return page(repr(self), [self.picture()], self.warnings)
