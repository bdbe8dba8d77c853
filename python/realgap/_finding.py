"""Answers without a search: how well values predict recordings, and what recordings say without a fit."""

from __future__ import annotations

import json
from typing import Dict, List, Literal, Tuple, cast

from . import _native
from ._claim import Claim
from ._json import JsonObject, many, parsed, typed
from ._picture import page
from ._run import Path, path_name
from ._table import Cell, Table
from ._warning import Warning

# What an apparent gravity that differs from the stated one is due to.
Explanation = Literal["length-scale", "gravity"]


class _Finding:
    def __init__(self, native: _native.Finding) -> None:
        self._native = native

    @property
    def report(self) -> JsonObject:
        """Everything as JSON, as the command prints it with `--format json`.

        >>> tosses = realgap.Study.read("sweeps/cube_toss_fit.ron", limit_recordings=4, parameters="sweeps/cube_toss_best.ron")
        >>> tosses.evaluate().report["position_percent"]["mean"] > 0.0
        True
        """
        return parsed(self._native.report())

    @property
    def warnings(self) -> Tuple[Warning, ...]:
        """Warnings about the answer.

        >>> tosses = realgap.Study.read("sweeps/cube_toss_fit.ron", limit_recordings=4, parameters="sweeps/cube_toss_best.ron")
        >>> [warning.code for warning in tosses.evaluate().warnings]
        ['few-recordings']
        """
        return tuple(many(Warning, self._native.warnings()))

    def __str__(self) -> str:
        return self._native.text()

    def __repr__(self) -> str:
        return self._native.text()

    def _repr_html_(self) -> str:
        return page(str(self), [], self.warnings)


class Evaluation(_Finding):
    """How well the values of a study predict its recordings, each simulated once.

    >>> tosses = realgap.Study.read("sweeps/cube_toss_fit.ron", limit_recordings=4, parameters="sweeps/cube_toss_best.ron")
    >>> print(str(tosses.evaluate())[:4])
    gap:
    """

    @property
    def claims(self) -> Tuple[Claim, ...]:
        """The verdict: gap, values and trust.

        >>> tosses = realgap.Study.read("sweeps/cube_toss_fit.ron", limit_recordings=4, parameters="sweeps/cube_toss_best.ron")
        >>> [claim.about for claim in tosses.evaluate().claims]
        ['gap', 'parameters', 'trust']
        """
        return tuple(cast(Claim, typed(Claim, one)) for one in cast(List[JsonObject], self.report["claims"]))

    @property
    def rows(self) -> Table:
        """One row a recording: its errors.

        >>> tosses = realgap.Study.read("sweeps/cube_toss_fit.ron", limit_recordings=4, parameters="sweeps/cube_toss_best.ron")
        >>> tosses.evaluate().rows.rows
        4
        """
        rows = cast(List[JsonObject], self.report.get("rows", []))
        columns: Dict[str, List[Cell]] = {}
        for name in rows[0] if rows else ():
            cells = [row.get(name) for row in rows]
            if not any(isinstance(cell, (dict, list)) for cell in cells):
                columns[name] = cast(List[Cell], cells)
        return Table(columns)


class Identification(_Finding):
    """What recordings say without a fit.

    >>> found = realgap.Study.read("sweeps/cube_toss_fit.ron", limit_recordings=8).identify()
    >>> "fly" in str(found)
    True
    """

    @property
    def parameters(self) -> Dict[str, float]:
        """The values that free flight gives, for `set=` of a study; none for recordings of joints.

        >>> found = realgap.Study.read("sweeps/cube_toss_fit.ron", limit_recordings=8).identify()
        >>> "recording.length_scale" in found.parameters
        True
        """
        return cast(Dict[str, float], json.loads(self._native.parameters()))

    def write(self, path: Path) -> None:
        """Writes the values for `parameters=`, as `realgap study identify -o` does.

        >>> realgap.Study.read("sweeps/cube_toss_fit.ron", limit_recordings=8).identify().write(folder / "body.ron")
        """
        self._native.write(path_name(path, "path"))
