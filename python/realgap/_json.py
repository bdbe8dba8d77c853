"""JSON to and from the native half, and its conversion to typed values."""

from __future__ import annotations

import dataclasses
import json
import math
import os
from collections.abc import Mapping as AbstractMapping
from functools import lru_cache
from typing import (
    Any, Dict, List, Mapping, Sequence, Type, TypeVar, Union, cast, get_args, get_origin, get_type_hints,
)  # fmt: skip

import numpy as np

from ._error import usage

# JSON from the native half.
Json = Union[None, bool, int, float, str, List["Json"], Dict[str, "Json"]]
JsonObject = Dict[str, Json]
# Values that may be passed to it: JSON, and values that become JSON without a loss.
Given = Union[
    None, bool, int, float, str, "np.generic[Any]", "np.ndarray[Any, Any]", "os.PathLike[str]",
    Sequence["Given"], Mapping[str, "Given"],
]  # fmt: skip

T = TypeVar("T")


def parsed(text: str) -> JsonObject:
    """An object that the library wrote."""
    return cast(JsonObject, json.loads(text))


def made(kind: Type[T], text: str) -> T:
    """JSON of the library as a value with fields. Fields that the type does not have are left out."""
    return cast(T, typed(kind, json.loads(text)))


def many(kind: Type[T], text: str) -> List[T]:
    """A JSON list of the library as values with fields."""
    return [cast(T, typed(kind, each)) for each in json.loads(text)]


def typed(kind: Any, value: Any) -> Any:
    """A JSON value, converted to the type `kind`."""
    if kind is float:
        # JSON cannot represent numbers that are not finite, so the library writes null.
        return math.nan if value is None else float(value)
    if dataclasses.is_dataclass(kind):
        hints = _fields(cast(type, kind))
        listed = isinstance(value, list)
        fields: Dict[str, Any] = dict(zip(hints, cast(List[Any], value))) if listed else value
        known = {name: typed(hint, fields[name]) for name, hint in hints.items() if name in fields}
        return cast(type, kind)(**known)
    origin, inner = get_origin(kind), get_args(kind)
    if origin is Union and len(inner) == 2 and type(None) in inner:
        return None if value is None else typed(inner[0], value)
    if origin is tuple:
        kinds = inner[:1] * len(value) if inner[-1] is ... else inner
        return tuple(typed(each, part) for each, part in zip(kinds, value))
    if origin is AbstractMapping:
        return {name: typed(inner[1], part) for name, part in value.items()}
    return value


@lru_cache(maxsize=None)
def _fields(kind: type) -> Dict[str, Any]:
    return get_type_hints(kind)


def asked(what: str, /, **options: object) -> str:
    """Keyword arguments as JSON, with all the bits of their numbers."""
    try:
        return json.dumps(options, allow_nan=False, default=_plain)
    except ValueError as error:
        for name, value in options.items():
            if not _is_sound(value):
                raise usage(
                    "not a finite number", field=name, found=value, allowed="finite numbers"
                ) from error
        raise usage(f"{what}: {error}") from error
    except TypeError as error:
        raise usage(f"{what}: {error}", allowed="numbers, texts, lists and dicts") from error


def _is_sound(value: object) -> bool:
    try:
        json.dumps(value, allow_nan=False, default=_plain)
    except (TypeError, ValueError):
        return False
    return True


def _plain(value: Any) -> Any:
    """Numbers of numpy and paths as JSON values."""
    if isinstance(value, np.generic):
        return cast(object, value.item())
    if isinstance(value, np.ndarray):
        return value.tolist()
    if hasattr(value, "__fspath__"):
        return value.__fspath__()
    raise TypeError(f"{type(value).__name__} is not a number, a text, a list or a dict")
