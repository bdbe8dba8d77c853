"""What everything that takes long has in common."""

from __future__ import annotations

import os
from typing import Callable, Dict, List, Mapping, Optional, Sequence, Tuple, Union

from ._error import usage

Path = Union[str, "os.PathLike[str]"]
# Values by name, or files of them such as the `best.ron` of a sweep.
Parameters = Union[Mapping[str, float], Path, Sequence[Path], None]
# Called with: done, total, the best score so far, and what is finished at the end.
Progress = Callable[[int, int, Optional[float], Optional[str]], object]


def mode(resume: bool, restart: bool) -> str:
    """What is to happen with results that are there already."""
    if resume and restart:
        raise usage("resume and restart exclude each other", field="resume")
    return "resume" if resume else "restart" if restart else "start"


def folder_name(folder: Optional[Path]) -> Optional[str]:
    """A folder as the library takes it."""
    return None if folder is None else os.fspath(folder)


def file_name(folder: Path, name: str) -> str:
    """What a text without a file is called: as if it lay in this folder, where the files that it names begin."""
    return os.path.join(os.fspath(folder), f"{name}.ron")


def files_and_values(parameters: Parameters) -> Tuple[List[str], Dict[str, float]]:
    """Parameters as the library takes them."""
    if parameters is None:
        return [], {}
    if isinstance(parameters, Mapping):
        return [], dict(parameters)
    if isinstance(parameters, (str, os.PathLike)):
        return [os.fspath(parameters)], {}
    return [os.fspath(file) for file in parameters], {}
