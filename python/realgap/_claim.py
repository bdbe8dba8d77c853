"""Statements of an answer about reality, with their evidence."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, Mapping, Optional


@dataclass(frozen=True)
class Claim:
    """A statement about reality: `text` is a sentence, `word` is its short form for a table, `numbers` from `count` recordings are its evidence.

    >>> [claim.says for claim in answer.summary.claims if claim.about == "best"]
    ['holds']
    """

    about: Literal[
        "model",
        "best",
        "engines",
        "set",
        "parameter",
        "difference",
        "parameters",
        "gap",
        "trust",
        "winner",
        "likeness",
        "distance",
        "over_time",
        "floor",
        "region",
        "ensemble",
        "reach",
        "success",
    ]
    name: str
    says: Literal["holds", "fails", "open"]
    word: str
    text: str
    numbers: Mapping[str, float]
    level: Optional[float]
    count: int
