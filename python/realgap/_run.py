"""Options of all functions that take long."""

from __future__ import annotations

import os
from typing import Callable, Dict, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np

from ._error import usage

Path = Union[str, "os.PathLike[str]"]
# Values by name, or files with values such as the `best.ron` of a sweep.
Parameters = Union[Mapping[str, float], Path, Sequence[Path], None]
# Called with: done, total, the best score so far, and the name of the step. After the last point `done` and `total` count the runs
# of a step by name; `total` is 0 where a step has no runs.
Progress = Callable[[int, int, Optional[float], Optional[str]], object]


def mode(resume: bool, restart: bool) -> str:
    """The mode for a folder that holds results already."""
    if resume and restart:
        raise usage("resume and restart exclude each other", field="resume")
    return "resume" if resume else "restart" if restart else "start"


def folder_name(folder: Optional[Path]) -> Optional[str]:
    """A folder as the native half takes it."""
    return None if folder is None else path_name(folder, "folder")


def path_name(path: Path, field: str) -> str:
    """A path as the native half takes it."""
    if isinstance(path, (str, os.PathLike)):
        return os.fspath(path)
    raise usage("not a path", field=field, found=repr(path), allowed="a text or a pathlib.Path")


def whole(name: str, value: Optional[int]) -> Optional[int]:
    """A whole number, or none; numbers of numpy are numbers, too."""
    if value is None:
        return None
    if isinstance(value, (int, np.integer)) and not isinstance(value, bool):
        return int(value)
    raise usage("not a whole number", field=name, found=repr(value), allowed="a whole number, or None")


def file_name(folder: Path, name: str) -> str:
    """A path for a text without a file, as if it lay in this folder: paths in the text are relative to the folder."""
    return os.path.join(os.fspath(folder), f"{name}.ron")


def files_and_values(parameters: Parameters) -> Tuple[List[str], Dict[str, float]]:
    """Parameters as the native half takes them."""
    if parameters is None:
        return [], {}
    if isinstance(parameters, Mapping):
        return [], dict(parameters)
    if isinstance(parameters, (str, os.PathLike)):
        return [os.fspath(parameters)], {}
    if not isinstance(parameters, Sequence):
        raise usage(
            "not values of parameters",
            field="parameters",
            found=repr(parameters),
            allowed='{"floor.friction": 0.4}, or files such as "results/best.ron"',
        )
    return [path_name(file, "parameters") for file in parameters], {}
