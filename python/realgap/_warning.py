"""Warnings travel with the results that they are about."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Warning:
    """Something the reader of a result should know.

    `code` is stable, `message` is one sentence for people.

    >>> [warning.message for warning in answer.warnings if warning.code == "stand-in"]
    ['the recordings are stand-ins made by a simulator, not recorded from hardware']
    """

    code: str
    message: str
