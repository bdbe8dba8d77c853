"""The base class of all results: a text, a report, warnings, files and pictures."""

from __future__ import annotations

import os
from typing import Dict, Generic, Optional, Protocol, Tuple, Type, TypeVar

from ._json import JsonObject, made, parsed
from ._picture import drawn, page
from ._run import Path
from ._warning import Warning


class _Native(Protocol):
    def text(self) -> str: ...
    def report(self) -> str: ...
    def write(self, folder: str) -> None: ...


class _Summary(Protocol):
    @property
    def warnings(self) -> Tuple[Warning, ...]: ...


N = TypeVar("N", bound=_Native)
S = TypeVar("S", bound=_Summary)


class Result(Generic[N, S]):
    """The members of every answer; `print` shows the text of the command.

    >>> str(gap) == repr(gap)
    True
    """

    # The pictures that a notebook shows; None means all.
    _shown: Optional[Tuple[str, ...]] = None

    def __init__(self, native: N, kind: Type[S]) -> None:
        self._native = native
        self._summary = made(kind, native.report())

    @property
    def report(self) -> JsonObject:
        """Everything as JSON, as in the file of the results folder.

        >>> gap.report["study"], gap.report["schema_version"]
        ('study', 1)
        """
        return parsed(self._native.report())

    @property
    def warnings(self) -> Tuple[Warning, ...]:
        """Warnings about the result.

        >>> "few-recordings" in [warning.code for warning in gap.warnings]
        True
        """
        return self._summary.warnings

    def write(self, folder: Path) -> None:
        """Writes the tables and pictures that the command writes.

        >>> gap.write(folder / "gap")
        >>> (folder / "gap" / "gap.json").exists()
        True
        """
        self._native.write(os.fspath(folder))

    def pictures(self) -> Dict[str, bytes]:
        """The pictures as PNG, by name.

        >>> sorted(answer.pictures())
        ['components', 'curve', 'trajectories', 'verdict']
        """
        return drawn(self._native.write)

    def __str__(self) -> str:
        return self._native.text()

    def __repr__(self) -> str:
        return self._native.text()

    def _repr_html_(self) -> str:
        pictures = self.pictures()
        shown = [pictures[name] for name in self._shown or pictures if name in pictures]
        return page(str(self), shown, self.warnings)
