"""Sensor readings and messages of a robot during a run, for a function of yours that commands its servos."""

from __future__ import annotations

from collections.abc import Mapping as AbstractMapping
from dataclasses import dataclass
from typing import Callable, List, Mapping, Optional, Sequence, Tuple, cast

from ._callback import number
from ._error import CallbackError

Place = Tuple[float, float, float]


@dataclass(frozen=True)
class Heard:
    """The last message that arrived from another robot, with the position of that robot when it was sent.

    >>> realgap.Heard("second", (0.3, 0.2, 0.03), sent_s=1.0, arrived_s=1.05, strength_dbm=-61.0).robot
    'second'
    """

    robot: str
    position_m: Place
    sent_s: float
    arrived_s: float
    strength_dbm: float


@dataclass(frozen=True)
class Sensed:
    """The knowledge of one robot when it decides: its place in the arena, readings by sensor (`None` where no reading came), angles by hinge.

    >>> known = []
    >>> _ = realgap.simulate(robot, duration_s=0.2, step=known.append, step_rate_hz=10.0)
    >>> [round(sensed.time_s, 1) for sensed in known], sorted(known[0].angles_rad)
    ([0.0, 0.1], ['leg_a', 'leg_b', 'leg_c'])
    """

    robot: str
    time_s: float
    position_m: Place
    readings: Mapping[str, Optional[float]]
    angles_rad: Mapping[str, float]
    heard: Tuple[Heard, ...]


# A function that returns the commands of servos until the next decision, by hinge: angles in radians, torques in N m for the law
# `Direct`; or None.
Step = Callable[[Sensed], Optional[Mapping[str, float]]]
_Message = Tuple[str, Sequence[float], float, float, float]


def asked(step: Step) -> Callable[..., List[Tuple[str, float]]]:
    """The function in the form in which the native half calls it."""

    def ask(
        robot: str,
        time_s: float,
        position_m: Sequence[float],
        readings: Sequence[Tuple[str, Optional[float]]],
        angles_rad: Sequence[Tuple[str, float]],
        heard: Sequence[_Message],
    ) -> List[Tuple[str, float]]:
        messages = tuple(Heard(who, _place(where), *rest) for who, where, *rest in heard)
        returned = step(
            Sensed(robot, time_s, _place(position_m), dict(readings), dict(angles_rad), messages)
        )
        try:
            return _commands(returned)
        except (TypeError, ValueError) as error:
            raise CallbackError(f"step: {error}\n  found:   at t_s = {time_s:.6g}") from error

    return ask


def _place(numbers: Sequence[float]) -> Place:
    x, y, z = numbers
    return x, y, z


def _commands(returned: object) -> List[Tuple[str, float]]:
    if returned is None:
        return []
    if not isinstance(returned, AbstractMapping):
        raise TypeError(f"the function must give a dict of angles by hinge, or None, not {returned!r}")
    commands = cast(Mapping[object, object], returned)
    return [(str(hinge), number(value, f"the command of {hinge}")) for hinge, value in commands.items()]
