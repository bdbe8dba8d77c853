"""Options of all functions that take long."""

from __future__ import annotations

import os
from typing import Callable, Dict, List, Mapping, Optional, Sequence, Tuple, Union

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
    return None if folder is None else os.fspath(folder)


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
    return [os.fspath(file) for file in parameters], {}
