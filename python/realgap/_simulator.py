"""Simulators of your own: a function in place of a robot, or served to the command line."""

from __future__ import annotations

import base64
import hashlib
import inspect
import json
import sys
from array import array
from dataclasses import dataclass, field
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Tuple, Union

# Version of the protocol of docs/simulator.md.
PROTOCOL = 1
# Arrays of at least so many numbers are packed.
_PACKED = 16


@dataclass(frozen=True)
class Question:
    """What a simulator is asked: one run.

    `parameters` are values by name; `times_s` the times of the compared samples; `start` the first recorded value of each column,
    where runs start from recordings, and `recording` the name of that recording; `commands` the recorded commands at
    `command_times_s`; `setting` is one of the declared settings, and `seed` is for random numbers. `id` is the
    number of the question, from 1.

    >>> question = realgap.Question(parameters={"stiffness": 40.0}, times_s=[0.0, 0.5, 1.0], duration_s=1.0)
    >>> [question.parameters["stiffness"] * t for t in question.times_s]
    [0.0, 20.0, 40.0]
    """

    parameters: Dict[str, float]
    times_s: List[float]
    duration_s: float
    seed: int = 0
    setting: Dict[str, Any] = field(default_factory=dict[str, Any])
    recording: str = ""
    start: Dict[str, float] = field(default_factory=dict[str, float])
    commands: Dict[str, List[float]] = field(default_factory=dict[str, List[float]])
    command_times_s: List[float] = field(default_factory=list[float])
    id: int = 0


# Values of channels by their names; with a key "t_s" they are at these times, else at the asked ones.
Channels = Mapping[str, Sequence[float]]
Simulate = Callable[[Question], Channels]
# Of each parameter (from, to, default) or (from, to, default, unit), or a dictionary of the protocol.
Declaration = Union[Tuple[float, float, float], Tuple[float, float, float, str], Mapping[str, Any]]
Declarations = Mapping[str, Declaration]


def serve(
    simulate: Simulate,
    declares: Declarations,
    *,
    settings: Sequence[Mapping[str, Any]] = (),
    name: str = "simulator",
    version: str = "",
    body_length_m: Optional[float] = None,
) -> None:
    """Answers questions on the standard input until it ends: the program of `simulator: Command(["python", "walk.py"])`.

    `simulate` gets a `Question` and returns channels by name; `declares` says of each parameter (from, to, default, unit), and
    `body_length_m` how long the robot is, for the metric `pose`. What the function prints goes to the standard error.

    >>> import io, sys
    >>> sys.stdin = io.StringIO('{"realgap": 1, "ask": "hello"}')
    >>> realgap.serve(lambda question: {"x_m": question.times_s}, {"speed": (0.0, 2.0, 1.0, "m/s")}, name="cart")
    {"realgap": 1, "name": "cart", "version": "", "parameters": [{"name": "speed", "from": 0.0, "to": 2.0, "default": 1.0, "unit": "m/s"}], "settings": []}
    >>> sys.stdin = sys.__stdin__
    """
    respond = _responder(simulate, declares, settings, name, version, body_length_m)
    output, sys.stdout = sys.stdout, sys.stderr
    try:
        for line in sys.stdin:
            if line.strip():
                output.write(respond(line) + "\n")
                output.flush()
    finally:
        sys.stdout = output


def responder(
    simulate: Simulate,
    declares: Declarations,
    settings: Sequence[Mapping[str, Any]],
    name: str,
    version: str,
) -> Tuple[Callable[[str], str], str]:
    """The function that answers lines, and what decides its answers."""
    # An object with a function `identity` says itself what decides its answers.
    identity = getattr(simulate, "identity", None)
    try:
        text = str(identity()) if callable(identity) else inspect.getsource(simulate)
    except (OSError, TypeError):
        text = repr(type(simulate))
    digest = hashlib.sha256(text.encode()).hexdigest()
    who = getattr(simulate, "__qualname__", type(simulate).__name__)
    length: Any = getattr(simulate, "body_length_m", None)
    length_m: Any = length() if callable(length) else None
    return (
        _responder(simulate, declares, settings, name, version, length_m),
        f"the function {who} sha256 {digest}",
    )


def _responder(
    simulate: Simulate,
    declares: Declarations,
    settings: Sequence[Mapping[str, Any]],
    name: str,
    version: str,
    body_length_m: Optional[float] = None,
) -> Callable[[str], str]:
    hello_fields: Dict[str, Any] = {
        "realgap": PROTOCOL,
        "name": name,
        "version": version,
        "parameters": [_declared(key, declares[key]) for key in declares],
        "settings": [dict(setting) for setting in settings],
    }
    if body_length_m is not None:
        hello_fields["body_length_m"] = body_length_m
    hello = json.dumps(hello_fields)

    def respond(line: str) -> str:
        asked = json.loads(line)
        if asked["ask"] == "hello":
            return hello
        commands = asked.get("commands", {})
        question = Question(
            parameters=asked["parameters"],
            times_s=asked["times_s"],
            duration_s=asked["duration_s"],
            seed=asked["seed"],
            setting=asked.get("setting", {}),
            recording=asked["recording"],
            start=asked["start"],
            commands=commands.get("channels", {}),
            command_times_s=commands.get("times_s", []),
            id=asked["id"],
        )
        try:
            channels = dict(simulate(question))
            times = channels.pop("t_s", None)
            # Packed arrays need no escapes, which `json` would look for in every letter of them.
            all_channels = ", ".join(f"{json.dumps(key)}: {_packed(values)}" for key, values in channels.items())
            at = "" if times is None else f', "times_s": {_packed(times)}'
        except Exception as error:  # One run fails, and the next may not.
            return json.dumps({"id": asked["id"], "failed": f"{type(error).__name__}: {error}"})
        return f'{{"id": {asked["id"]}{at}, "channels": {{{all_channels}}}}}'

    return respond


def _declared(name: str, declaration: Declaration) -> Dict[str, Any]:
    if isinstance(declaration, Mapping):
        return {"name": name, **declaration}
    keys = ("from", "to", "default", "unit")
    return {"name": name, **dict(zip(keys, declaration))}


def _packed(values: Sequence[float]) -> str:
    """The JSON of an array."""
    numbers = array("d", values)
    if len(numbers) < _PACKED:
        return json.dumps(_listed(numbers))
    if sys.byteorder == "big":
        numbers.byteswap()
    return '{"base64_f64": "' + base64.b64encode(numbers.tobytes()).decode("ascii") + '"}'


def _listed(numbers: "array[float]") -> List[float]:
    for number in numbers:
        if number != number or number in (float("inf"), float("-inf")):
            raise ValueError(f"{number} is no number that a run may have")
    return numbers.tolist()
