"""Arrays in and out. A wrong shape, kind or number is an error before the array is used."""

from __future__ import annotations

from typing import Optional, Tuple

import numpy as np
import numpy.typing as npt

from ._error import usage

Floats = npt.NDArray[np.float64]


def given(values: npt.ArrayLike, name: str, shape: Tuple[Optional[int], ...]) -> Floats:
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
            hint="leave out samples that the tracker has lost",
        )
    return numbers


def sent(array: Floats) -> bytes:
    """The bytes of an array."""
    return array.tobytes()


def got(data: bytes, *shape: int) -> Floats:
    """The read-only array of these bytes."""
    return np.frombuffer(data, dtype="<f8").reshape(shape)
