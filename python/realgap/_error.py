"""Exceptions for the errors of the library, with the text that the command prints."""

from __future__ import annotations

from typing import Optional


class Error(Exception):
    """An error; its text says where it is, what was found, what is allowed, and what to do next.

    >>> try:
    ...     realgap.simulate(robot, parameters={"floor.frictoin": 0.4})
    ... except realgap.Error as error:
    ...     print(type(error).__name__, "floor.friction" in str(error))
    UsageError True
    """

    message: str = ""
    file: Optional[str] = None
    line: Optional[int] = None
    column: Optional[int] = None
    field: Optional[str] = None


class InvalidError(Error, ValueError):
    """A file or value does not have the form or range it must have.

    >>> realgap.Robot.from_text("(legs: 3)")
    Traceback (most recent call last):
    realgap._error.InvalidError: robot:1:...
    """


class UsageError(Error, ValueError):
    """A function was called wrongly.

    >>> study.sweep(jobs=0)
    Traceback (most recent call last):
    realgap._error.UsageError: jobs: not a number of threads...
    """


class ConflictError(Error):
    """The request clashes with what is already there, e.g. with a folder of other results.

    >>> issubclass(realgap.ConflictError, realgap.Error)
    True
    """


class FileError(Error):
    """The operating system refused: missing file, full disk, no permission.

    >>> realgap.Robot.read("nowhere.ron")
    Traceback (most recent call last):
    realgap._error.FileError: nowhere.ron: ...
    """


class CallbackError(Error):
    """A function of yours raised an exception, which is the cause of this one, or returned a value that cannot be used.

    >>> realgap.simulate(robot, gait=lambda t_s: {"leg_a": 1.0 / (t_s - t_s)})
    Traceback (most recent call last):
    realgap._error.CallbackError: the gait raised ZeroDivisionError: float division by zero...
    """


class Interrupted(Error, KeyboardInterrupt):
    """The user pressed Ctrl-C; the results so far are in the results folder, where one was given.

    >>> issubclass(realgap.Interrupted, KeyboardInterrupt)
    True
    """


def usage(
    message: str,
    *,
    field: Optional[str] = None,
    found: Optional[object] = None,
    allowed: Optional[str] = None,
    hint: Optional[str] = None,
) -> UsageError:
    """A usage error, in the form of all other errors."""
    text = f"{field}: {message}" if field else message
    for label, part in (("found:  ", found), ("allowed:", allowed), ("hint:   ", hint)):
        if part is not None:
            text += f"\n  {label} {part}"
    error = UsageError(text)
    error.message = message
    error.field = field
    return error
