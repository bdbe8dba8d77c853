"""The search for a better robot."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from typing import Callable, Dict, List, Mapping, Optional, SupportsFloat

from . import _native
from ._callback import number
from ._card import FinalistCard
from ._error import usage
from ._json import Given, JsonObject, asked, made, many, parsed
from ._picture import drawn, page
from ._robot import Robot
from ._progress import AnyProgress, shown
from ._run import Parameters, Path, file_name, files_and_values, folder_name, mode, whole
from ._table import Table


@dataclass(frozen=True)
class Travel:
    """The motion of a robot in one repeat, in numbers.

    >>> realgap.Travel(displacement_m=0.1, path_length_m=0.2, turned_rad=0.0, servo_j=None).path_length_m
    0.2
    """

    displacement_m: float
    path_length_m: float
    turned_rad: float
    servo_j: Optional[float]


# A function that returns the fitness of a robot from its repeats; larger is better.
Objective = Callable[[List[Travel]], SupportsFloat]


@dataclass(frozen=True)
class Finalist:
    """One of the best robots, simulated again with fresh seeds and other solver settings.

    >>> found.finalists[0].card.robot == found.finalists[0].robot.name
    True
    """

    robot: Robot
    card: FinalistCard
    text: str

    @property
    def survives(self) -> bool:
        """Whether it walks the same under other solver settings.

        >>> found.finalists[0].survives == all(rerun.survives for rerun in found.finalists[0].card.reruns)
        True
        """
        return self.card.survives

    def _repr_html_(self) -> str:
        return page(self.text, [self.robot.picture()])


class SearchResults:
    """The robots of a search.

    >>> found.robots.rows
    6
    """

    def __init__(self, native: _native.Found) -> None:
        self._native = native

    @property
    def robots(self) -> Table:
        """One row per robot, in the order of the search.

        >>> "fitness" in found.robots
        True
        """
        return Table(json.loads(self._native.robots()))

    @property
    def best(self) -> Optional[Robot]:
        """The robot with the largest fitness in the search, which is partly luck of its draws; `None` where all robots failed.

        >>> found.best.name in found.robots["robot"]
        True
        """
        native = self._native.best()
        return None if native is None else Robot(native)

    @property
    def finalists(self) -> List[Finalist]:
        """The best robots, best first; empty where the objective was a function of yours.

        >>> len(found.finalists)
        1
        """
        return [
            Finalist(Robot(robot), made(FinalistCard, card), text)
            for robot, card, text in self._native.finalists()
        ]

    def write(self, folder: Path) -> None:
        """Writes the tables and pictures that the command writes.

        >>> found.write(folder / "search")
        >>> (folder / "search" / "history.csv").exists()
        True
        """
        self._native.write(os.fspath(folder))

    def pictures(self) -> Dict[str, bytes]:
        """The pictures as PNG, by name.

        >>> "gallery" in found.pictures()
        True
        """
        return drawn(self._native.write)

    def __repr__(self) -> str:
        fitness = [value for value in self.robots["fitness"] if value is not None]
        best = f", best {max(map(float, fitness)):.4g}" if fitness else ""
        return f"SearchResults of {self.robots.rows} robots{best}"

    def _repr_html_(self) -> str:
        pictures = self.pictures()
        wanted = ("gallery", "fitness", "paths", "archive")
        return page(repr(self), [pictures[name] for name in wanted if name in pictures])


@dataclass(frozen=True)
class _Info:
    name: str
    strategy: str
    robots: int
    objective: str


class Search:
    """A search, ready to run. Use `Search.read`, `Search.from_text` or `Search.from_dict`.

    >>> search
    Search quick: 6 robots by evolution, displacement, 20 % quantile
    """

    def __init__(self, native: _native.Search) -> None:
        self._native = native
        self._info = made(_Info, native.info())

    @classmethod
    def read(
        cls,
        path: Path,
        *,
        set: Optional[Mapping[str, float]] = None,
        parameters: Parameters = None,
        posterior: Optional[Path] = None,
        seed: Optional[int] = None,
    ) -> "Search":
        """A search from its RON file; arguments override the file. `posterior` is the results folder of a sweep or tuning.

        >>> realgap.Search.read("sweeps/best_robot.ron", seed=7).info["seed"]
        7
        """
        wishes = _wishes(set, parameters, posterior, seed)
        return cls(_native.Search.parse(os.fspath(path), None, False, wishes))

    @classmethod
    def from_text(
        cls,
        text: str,
        *,
        name: str = "search",
        folder: Path = ".",
        set: Optional[Mapping[str, float]] = None,
        parameters: Parameters = None,
        posterior: Optional[Path] = None,
        seed: Optional[int] = None,
    ) -> "Search":
        """A search from RON; the files that it names are relative to `folder`.

        >>> text = "(strategy: Evolution(population: 4, generations: 2), duration_s: 0.5, repeats: 2)"
        >>> realgap.Search.from_text(text).info["robots"]
        6
        """
        wishes = _wishes(set, parameters, posterior, seed)
        return cls(_native.Search.parse(file_name(folder, name), text, False, wishes))

    @classmethod
    def from_dict(
        cls,
        fields: Mapping[str, Given],
        *,
        name: str = "search",
        folder: Path = ".",
        set: Optional[Mapping[str, float]] = None,
        parameters: Parameters = None,
        posterior: Optional[Path] = None,
        seed: Optional[int] = None,
    ) -> "Search":
        """A search from the fields of its file.

        >>> fields = {"strategy": {"Evolution": {"population": 4, "generations": 2}}, "duration_s": 0.5, "repeats": 2}
        >>> realgap.Search.from_dict(fields, seed=3).info["seed"]
        3
        """
        text = asked("a search", **dict(fields))
        wishes = _wishes(set, parameters, posterior, seed)
        return cls(_native.Search.parse(file_name(folder, name), text, True, wishes))

    @property
    def name(self) -> str:
        """Its name.

        >>> search.name
        'quick'
        """
        return self._info.name

    @property
    def info(self) -> JsonObject:
        """Strategy, number of robots, repeats, objective.

        >>> search.info["repeats"]
        2
        """
        return parsed(self._native.info())

    def run(
        self,
        *,
        objective: Optional[Objective] = None,
        jobs: Optional[int] = None,
        folder: Optional[Path] = None,
        resume: bool = False,
        restart: bool = False,
        progress: AnyProgress = None,
    ) -> SearchResults:
        """Searches as `realgap search` does, and simulates the best robots again.

        With an `objective` of yours, the search is kept in memory and has no finalists, because these are ranked by the objective of
        the file.

        >>> search.run(objective=lambda repeats: min(repeat.path_length_m for repeat in repeats)).finalists
        []
        """
        how = mode(resume, restart)
        if objective is None:
            return SearchResults(self._native.run(whole("jobs", jobs), folder_name(folder), how, shown(progress)))
        if folder is not None:
            raise usage(
                "a search with an objective in Python is kept in memory",
                field="folder",
                hint="write the results afterwards: SearchResults.write(folder)",
            )
        wanted = objective

        def fitness(repeats: str) -> float:
            return number(wanted(many(Travel, repeats)), "the objective")

        return SearchResults(self._native.run_for(fitness, whole("jobs", jobs), shown(progress)))

    def __repr__(self) -> str:
        info = self._info
        return f"Search {self.name}: {info.robots} robots by {info.strategy}, {info.objective}"


def _wishes(
    set: Optional[Mapping[str, float]],
    parameters: Parameters,
    posterior: Optional[Path],
    seed: Optional[int],
) -> str:
    files, values = files_and_values(parameters)
    return asked(
        "a search",
        set={**values, **(set or {})},
        parameters=files,
        posterior=posterior,
        seed=seed,
    )
