"""Metrics and optimizers of your own, as Python functions and objects."""

from __future__ import annotations

import numbers
from typing import (
    Callable, List, Literal, Optional, Protocol, Sequence, SupportsFloat, Tuple, Union, cast, overload,
)  # fmt: skip

import numpy as np

from . import _native
from ._array import Floats, got
from ._trajectory import Trajectory

# The history that the library passes to an optimizer: points, and their scores where they have one.
EvaluatedPoint = List[Tuple[List[float], Optional[float]]]


def number(value: object, who: str) -> float:
    """The finite number that a callback returned."""
    if not _is_number(value):
        raise TypeError(f"{who} must give a number, not {type(value).__name__} {value!r}")
    made = float(cast("SupportsFloat", value))
    if not np.isfinite(made):
        raise ValueError(f"{who} must give a finite number, not {made}")
    return made


def _is_number(value: object) -> bool:
    if isinstance(value, np.ndarray):
        return value.ndim == 0
    return isinstance(value, (numbers.Real, np.number)) and not isinstance(value, bool)


class Metric:
    """A distance between two motions, written in Python.

    `distance(real, simulated)` gets the two prepared paths, 182 x 2 arrays (start at the origin, net displacement along +x), or,
    with `whole=True`, the two `Trajectory` objects; it returns a number, 0 for equal motions and never negative. It may be called
    from several threads, one at a time, and must return the same number for the same motions. A results folder identifies a
    metric by its name, so change the name when you change the function.

    >>> ends = realgap.Metric("ends", lambda real, simulated: np.linalg.norm(real[-1] - simulated[-1]))
    >>> float(realgap.compare(recordings[0], recordings[0], metric=ends))
    0.0
    """

    @overload
    def __init__(
        self,
        name: str,
        distance: Callable[[Floats, Floats], SupportsFloat],
        *,
        unit: str = "m",
        doc: str = "written in Python",
        whole: Literal[False] = False,
    ) -> None: ...
    @overload
    def __init__(
        self,
        name: str,
        distance: Callable[[Trajectory, Trajectory], SupportsFloat],
        *,
        unit: str = "m",
        doc: str = "written in Python",
        whole: Literal[True],
    ) -> None: ...
    def __init__(
        self,
        name: str,
        distance: Callable[..., SupportsFloat],
        *,
        unit: str = "m",
        doc: str = "written in Python",
        whole: bool = False,
    ) -> None:
        def of_paths(real: bytes, simulated: bytes) -> float:
            return checked(distance(path(real), path(simulated)))

        def of_trajectories(real: _native.Trajectory, simulated: _native.Trajectory) -> float:
            return checked(distance(Trajectory._of(real), Trajectory._of(simulated)))

        def checked(value: object) -> float:
            made = number(value, f"the metric {name!r}")
            if made < 0.0:
                raise ValueError(f"the metric {name!r} must not be negative: {made}")
            return made

        def path(data: bytes) -> Floats:
            return got(data, len(data) // 16, 2)

        self.name = name
        self._native = _native.OwnMetric(
            name, unit, doc, whole, of_trajectories if whole else of_paths
        )

    def __repr__(self) -> str:
        return f"Metric {self.name}"


AnyMetric = Union[str, Metric]


def native_metric(metric: Optional[AnyMetric]) -> Union[str, _native.OwnMetric, None]:
    """A metric as the native half takes it."""
    return metric._native if isinstance(metric, Metric) else metric


class AskTell(Protocol):
    """The interface of an optimizer that chooses points: `ask` returns points, `tell` receives their scores.

    >>> class Dice:
    ...     def __init__(self, dimensions: int, budget: int, seed: int) -> None:
    ...         self.rng, self.dimensions = np.random.default_rng(seed), dimensions
    ...     def ask(self) -> list[list[float]]:
    ...         return [list(self.rng.random(self.dimensions))]
    ...     def tell(self, points, scores) -> None:
    ...         pass
    >>> study.tune(optimizer=realgap.Optimizer("dice", Dice, design=2), budget=4).summary.points
    4
    """

    # Returns the next points, with a coordinate from 0 to 1 per parameter; an empty list ends the tuning.
    def ask(self) -> Sequence[Sequence[float]]: ...

    # Receives scores of points: small is good, `None` means that the simulation diverged. The first call has the first design, which
    # the optimizer did not choose.
    def tell(self, points: Sequence[Sequence[float]], scores: Sequence[Optional[float]]) -> None: ...


class Optimizer:
    """An optimizer written in Python.

    `make(dimensions, budget, seed)` makes an object with `ask` and `tell`. The same seed must give the same points, because an
    interrupted tuning continues by asking again; other points are an error. `design` is the number of space-filling points before
    the first `ask` (default: ten per parameter), `batch` the largest number of points of one `ask`.

    >>> realgap.Optimizer("mine", lambda dimensions, budget, seed: None, batch=8)
    Optimizer mine
    """

    def __init__(
        self,
        name: str,
        make: Callable[[int, int, int], AskTell],
        *,
        batch: int = 1,
        design: Optional[int] = None,
    ) -> None:
        self.name = name
        self.batch = batch
        self.design = design
        self._make = make

    def _proposer(self) -> "_Proposer":
        return _Proposer(self._make)

    def __repr__(self) -> str:
        return f"Optimizer {self.name}"


class _Proposer:
    """Translates the whole history, which the library passes every time, into calls of ask and tell."""

    def __init__(self, make: Callable[[int, int, int], AskTell]) -> None:
        self._make = make
        self._asked: Optional[AskTell] = None
        self._known: EvaluatedPoint = []

    def __call__(
        self, problem: Tuple[int, int, int], design: EvaluatedPoint, evaluated: EvaluatedPoint
    ) -> List[List[float]]:
        history = design + evaluated
        if self._asked is None or history[: len(self._known)] != self._known:
            # This is another tuning, e.g. of a fold, or the same tuning from its beginning.
            self._asked, self._known = self._make(*problem), []
        new = history[len(self._known) :]
        if new:
            self._asked.tell([point for point, _ in new], [score for _, score in new])
        self._known = history
        return [[float(x) for x in point] for point in self._asked.ask()]
