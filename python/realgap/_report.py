"""A results folder as one page."""

from __future__ import annotations

import os
from typing import Optional

from . import _native
from ._run import Path


def report(folder: Path, output: Optional[Path] = None) -> str:
    """The HTML page of a results folder, as `realgap report` makes it; written to `output` where that is named.

    >>> answer.write(folder / "page")
    >>> "floor.friction" in realgap.report(folder / "page")
    True
    """
    page = _native.folder_page(os.fspath(folder))
    if output is not None:
        with open(output, "w", encoding="utf-8") as file:
            file.write(page)
    return page
