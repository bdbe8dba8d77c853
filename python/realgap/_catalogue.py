"""Lists of parameters, metrics and optimizers, and the engine."""

from __future__ import annotations

import json
import os
from typing import Dict, List

from . import _native
from ._json import made
from ._run import Path
from ._table import Cell, Table


def _table(text: str) -> Table:
    rows: List[Dict[str, Cell]] = json.loads(text)
    return Table({name: [row[name] for row in rows] for name in rows[0]})


def parameters() -> Table:
    """Every named number that can be set, varied and tuned.

    >>> "floor.friction" in realgap.parameters()["name"]
    True
    """
    return _table(_native.parameters())


def metrics() -> Table:
    """Every metric.

    >>> "rms" in realgap.metrics()["name"]
    True
    """
    return _table(_native.metrics())


def optimizers() -> Table:
    """Every optimizer.

    >>> "cma-es" in realgap.optimizers()["name"]
    True
    """
    return _table(_native.optimizers())


def read_parameters(path: Path) -> Dict[str, float]:
    """The values of a file such as the `best.ron` of a sweep.

    >>> answer.write(folder / "values")
    >>> realgap.read_parameters(folder / "values" / "best.ron") == answer.best
    True
    """
    return made(Dict[str, float], _native.read_parameters(os.fspath(path)))


def engine() -> str:
    """The physics engine and its version.

    >>> realgap.engine().split("-")[0]
    'rapier3d'
    """
    return _native.versions()[1]
