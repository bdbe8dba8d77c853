"""Exceptions: what the library says of an error, with the text that the command prints."""

from __future__ import annotations

from typing import Optional


class Error(Exception):
    """Says where, what was found, what is allowed, and what to do next."""

    message: str = ""
    file: Optional[str] = None
    line: Optional[int] = None
    column: Optional[int] = None
    field: Optional[str] = None


class InvalidError(Error, ValueError):
    """A file or value does not have the form or range it must have."""


class UsageError(Error, ValueError):
    """A function was called wrongly."""


class ConflictError(Error):
    """The request clashes with what is already there, e.g. with a folder of other results."""


class FileError(Error):
    """The operating system refused: missing file, full disk, no permission."""


class CallbackError(Error):
    """A function of yours raised an exception, which is the cause of this one, or gave something that cannot be used."""


class Interrupted(Error, KeyboardInterrupt):
    """Ctrl-C; what was done so far is in the results folder, where there is one."""


def usage(
    message: str,
    *,
    field: Optional[str] = None,
    found: Optional[object] = None,
    allowed: Optional[str] = None,
    hint: Optional[str] = None,
) -> UsageError:
    """A wrong use, in the form of all other errors."""
    text = f"{field}: {message}" if field else message
    for label, part in (("found:  ", found), ("allowed:", allowed), ("hint:   ", hint)):
        if part is not None:
            text += f"\n  {label} {part}"
    error = UsageError(text)
    error.message = message
    error.field = field
    return error
