"""What there is: parameters, metrics, optimizers, and the engine."""

from __future__ import annotations

import json
import os
from typing import Any, Dict, List

from . import _native
from ._robot import Path
from ._table import Table


def _table(text: str) -> Table:
    rows: List[Dict[str, Any]] = json.loads(text)
    return Table({name: [row[name] for row in rows] for name in rows[0]})


def parameters() -> Table:
    """Every named number that can be set, varied and tuned."""
    return _table(_native.parameters())


def metrics() -> Table:
    """Every metric."""
    return _table(_native.metrics())


def optimizers() -> Table:
    """Every optimizer."""
    return _table(_native.optimizers())


def read_parameters(path: Path) -> Dict[str, float]:
    """The values of a file such as the `best.ron` of a sweep."""
    return dict(json.loads(_native.read_parameters(os.fspath(path))))


def engine() -> str:
    """The physics engine and its version."""
    return _native.versions()[1]
