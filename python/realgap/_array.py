"""Arrays in and out, checked: a wrong shape, kind or number is said before it is used."""

from __future__ import annotations

import json
from typing import Any, Optional, Tuple

import numpy as np
import numpy.typing as npt

from ._error import usage

Floats = npt.NDArray[np.float64]


def given(values: Any, name: str, shape: Tuple[Optional[int], ...]) -> Floats:
    """An array of finite numbers of this shape; `None` stands for any length."""
    if isinstance(values, str):
        raise usage("not numbers", field=name, found=f"the text {values!r}", allowed="an array of numbers")
    try:
        array = np.asarray(values)
    except ValueError as error:
        raise usage("not an array", field=name, found=str(error), allowed="rows of equal length") from error
    if array.dtype.kind not in "fiu":
        raise usage(
            "not real numbers", field=name, found=f"dtype {array.dtype}", allowed="float or integer numbers"
        )
    fits = array.ndim == len(shape) and all(
        wanted is None or wanted == found for wanted, found in zip(shape, array.shape)
    )
    if not fits:
        wanted = " x ".join("n" if length is None else str(length) for length in shape)
        found = " x ".join(str(length) for length in array.shape)
        raise usage("wrong shape", field=name, found=found or "a single number", allowed=wanted)
    numbers = np.ascontiguousarray(array, dtype="<f8")
    if not np.isfinite(numbers).all():
        index = tuple(int(i) for i in np.argwhere(~np.isfinite(numbers))[0])
        place = ", ".join(str(i) for i in index)
        raise usage(
            "not a finite number",
            field=f"{name}[{place}]",
            found=numbers[index],
            allowed="finite numbers",
            hint="leave samples out that the tracker has lost",
        )
    return numbers


def sent(array: Floats) -> bytes:
    """The bytes of an array."""
    return array.tobytes()


def got(data: bytes, *shape: int) -> Floats:
    """The array of bytes; nobody can write into it."""
    return np.frombuffer(data, dtype="<f8").reshape(shape)


def asked(what: str, /, **options: Any) -> str:
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


def _is_sound(value: Any) -> bool:
    try:
        json.dumps(value, allow_nan=False, default=_plain)
    except (TypeError, ValueError):
        return False
    return True


def _plain(value: Any) -> Any:
    """Numbers of numpy and paths, as JSON knows them."""
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, np.ndarray):
        return value.tolist()
    if hasattr(value, "__fspath__"):
        return value.__fspath__()
    raise TypeError(f"{type(value).__name__} is not a number, a text, a list or a dict")
