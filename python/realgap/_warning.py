"""Warnings travel with the results that they are about."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Warning:
    """Something the reader of a result should know.

    `code` is stable, `message` is one sentence for people.

    >>> {warning.code for warning in study.warnings} <= {"stand-in", "known-limit", "estimated-velocity"}
    True
    """

    code: str
    message: str
