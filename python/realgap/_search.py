"""The search for a better robot."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from typing import Any, Callable, Dict, List, Mapping, Optional

from . import _native
from ._array import asked
from ._callback import number
from ._picture import drawn, page
from ._robot import Path, Robot
from ._run import Progress, file_name, folder_name, mode
from ._simulation import Parameters, _parameters
from ._table import Table

# What a robot is worth, larger is better, of what it did in its repeats: dicts with displacement_m, path_length_m, turned_rad
# and servo_j.
Objective = Callable[[List[Dict[str, Any]]], float]


@dataclass(frozen=True)
class Finalist:
    """One of the best robots, looked at again with new draws and other solver settings."""

    robot: Robot
    card: Dict[str, Any]
    text: str

    @property
    def survives(self) -> bool:
        """Whether it walks the same under other solver settings."""
        return bool(self.card["finals"]["survives"])

    def _repr_html_(self) -> str:
        return page(self.text, [self.robot.picture()])


class SearchResults:
    """The robots of a search."""

    def __init__(self, native: _native.Found) -> None:
        self._native = native

    @property
    def robots(self) -> Table:
        """A row a robot, in the order of the search."""
        return Table(json.loads(self._native.robots()))

    @property
    def best(self) -> Optional[Robot]:
        """The robot with the largest fitness in the search, with the luck of its draws; `None` where all failed."""
        native = self._native.best()
        return None if native is None else Robot(native)

    @property
    def finalists(self) -> List[Finalist]:
        """The best robots, best first; none where the objective was yours."""
        return [
            Finalist(Robot(robot), json.loads(card), text)
            for robot, card, text in self._native.finalists()
        ]

    def write(self, folder: Path) -> None:
        """Writes the tables and pictures that the command writes."""
        self._native.write(os.fspath(folder))

    def pictures(self) -> Dict[str, bytes]:
        """The pictures as PNG, by name."""
        return drawn(self._native.write)

    def __repr__(self) -> str:
        fitness = [value for value in self.robots["fitness"] if value is not None]
        best = f", best {max(fitness):.4g}" if fitness else ""
        return f"SearchResults of {self.robots.rows} robots{best}"

    def _repr_html_(self) -> str:
        pictures = self.pictures()
        wanted = ("gallery", "fitness", "paths", "archive")
        return page(repr(self), [pictures[name] for name in wanted if name in pictures])


class Search:
    """A search, ready to run. Use `Search.read`, `Search.from_text` or `Search.from_dict`."""

    def __init__(self, native: _native.Search) -> None:
        self._native = native
        self._info: Dict[str, Any] = json.loads(native.info())

    @classmethod
    def read(cls, path: Path, **wishes: Any) -> "Search":
        """A search from its RON file. Different from the file, if wished: `set`, `parameters`, `indistinguishable`, `seed`."""
        return cls._parsed(os.fspath(path), None, False, wishes)

    @classmethod
    def from_text(cls, text: str, *, name: str = "search", folder: Path = ".", **wishes: Any) -> "Search":
        """A search from RON; the files that it names are relative to `folder`."""
        return cls._parsed(file_name(folder, name), text, False, wishes)

    @classmethod
    def from_dict(
        cls, fields: Mapping[str, Any], *, name: str = "search", folder: Path = ".", **wishes: Any
    ) -> "Search":
        """A search from the fields of its file."""
        path = file_name(folder, name)
        return cls._parsed(path, asked("a search", **dict(fields)), True, wishes)

    @classmethod
    def _parsed(cls, path: str, text: Optional[str], is_json: bool, wishes: Dict[str, Any]) -> "Search":
        told = asked("a search", **_all_wishes(**wishes))
        return cls(_native.Search.parse(path, text, is_json, told))

    @property
    def name(self) -> str:
        """Its name."""
        return str(self._info["name"])

    @property
    def info(self) -> Dict[str, Any]:
        """Strategy, number of robots, repeats, objective."""
        return dict(self._info)

    def run(
        self,
        *,
        objective: Optional[Objective] = None,
        jobs: Optional[int] = None,
        folder: Optional[Path] = None,
        resume: bool = False,
        restart: bool = False,
        progress: Optional[Progress] = None,
    ) -> SearchResults:
        """Searches as `realgap search` does, and looks at the best again.

        With an `objective` of yours the search is in memory, and nothing is looked at again: a finalist is ranked by the
        objective of the file.
        """
        how = mode(resume, restart)
        if objective is None:
            return SearchResults(self._native.run(jobs, folder_name(folder), how, progress))
        if folder is not None:
            from ._error import usage

            raise usage(
                "a search for an objective in Python is kept in memory",
                field="folder",
                hint="write the results afterwards: SearchResults.write(folder)",
            )
        wanted = objective

        def fitness(repeats: str) -> float:
            return number(wanted(json.loads(repeats)), "the objective")

        return SearchResults(self._native.run_for(fitness, jobs, progress))

    def __repr__(self) -> str:
        info = self._info
        return f"Search {self.name}: {info['robots']} robots by {info['strategy']}, {info['objective']}"


def _all_wishes(
    *,
    set: Optional[Mapping[str, float]] = None,
    parameters: Parameters = None,
    indistinguishable: Optional[Path] = None,
    seed: Optional[int] = None,
) -> Dict[str, Any]:
    files, values = _parameters(parameters)
    return {
        "set": {**values, **dict(set or {})},
        "parameters": files,
        "indistinguishable": indistinguishable,
        "seed": seed,
    }
