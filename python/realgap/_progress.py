"""The progress of a run: a function of yours, or a bar, which notebooks show by themselves."""

from __future__ import annotations

import html
import sys
import time
from typing import Any, Callable, Optional, Union

from ._error import usage
from ._run import Progress

# None: a bar in notebooks and nothing elsewhere; True: a bar anywhere; False: nothing.
AnyProgress = Union[Progress, bool, None]
# A bar is drawn at most so often, in seconds.
EVERY_S = 0.2
# Shorter work shows no bar, in seconds.
QUIET_S = 0.5
WIDTH = 24


def shown(progress: AnyProgress) -> Optional[Progress]:
    """The function that is called with the progress, if there is one."""
    if progress is None:
        return Bar(_Cell()) if _is_notebook() else None
    if progress is False:
        return None
    if progress is True:
        return Bar(_Cell() if _is_notebook() else _on_standard_error)
    if callable(progress):
        return progress
    raise usage(
        "not a way to report the progress",
        field="progress",
        found=repr(progress),
        allowed="a function of (done, total, best, step), True for a bar, False for none",
    )


class Bar:
    """Shows the progress as a line of text: what is done, the count, the best score, and the time left.

    >>> from realgap._progress import Bar
    >>> lines = []
    >>> bar = Bar(lines.append, clock=iter([0.0, 1.0, 2.0]).__next__)
    >>> bar(0, 40, None, None)
    >>> bar(20, 40, 0.5, None)
    >>> lines[-1]
    'points ############............ 20/40, best 0.5, 1 s left'
    """

    def __init__(
        self, show: Callable[[str], object], clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._show, self._clock = show, clock
        self._begun = clock()
        self._step: Optional[str] = None
        self._step_begun: Optional[float] = None
        self._first = 0
        self._drawn: Optional[float] = None

    def __call__(
        self, done: int, total: int, best: Optional[float], step: Optional[str]
    ) -> None:
        now = self._clock()
        if self._step_begun is None or step != self._step:
            # Points of an earlier run do not count for the pace.
            self._step, self._step_begun, self._first = step, now, done
        is_last = total > 0 and done >= total
        if now - self._begun < QUIET_S:
            return
        if self._drawn is not None and now - self._drawn < EVERY_S and not is_last:
            return
        self._drawn = now
        self._show(self._line(done, total, best, now - self._step_begun))

    def _line(self, done: int, total: int, best: Optional[float], taken_s: float) -> str:
        what = self._step or "points"
        if total == 0:
            return f"{what}, {taken_s:.0f} s so far"
        filled = "#" * round(WIDTH * min(done, total) / total)
        parts = [f"{what} {filled:.<{WIDTH}} {done}/{total}"]
        if best is not None:
            parts.append(f"best {best:.4g}")
        new = done - self._first
        if new > 0 and done < total:
            left_s = taken_s / new * (total - done)
            # Nothing is left only at the end, so that a rounded zero would be wrong.
            parts.append(f"{left_s:.0f} s left" if left_s >= 1.0 else "under 1 s left")
        return ", ".join(parts)


def _is_notebook() -> bool:
    """Whether the code runs in a notebook; nothing is imported to find out."""
    ipython: Any = sys.modules.get("IPython")
    shell: Any = None if ipython is None else ipython.get_ipython()
    return shell is not None and type(shell).__name__ == "ZMQInteractiveShell"


class _Cell:
    """The output of a notebook's cell that a bar renews."""

    def __init__(self) -> None:
        self._handle: Any = None

    def __call__(self, line: str) -> None:
        display: Any = sys.modules["IPython"].display
        style = "font-family:monospace;white-space:pre"
        made = display.HTML(f'<span style="{style}">{html.escape(line)}</span>')
        if self._handle is None:
            self._handle = display.display(made, display_id=True)
        else:
            self._handle.update(made)


def _on_standard_error(line: str) -> None:
    sys.stderr.write(f"\r{line:<100}")
    sys.stderr.flush()
