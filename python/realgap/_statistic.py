"""Numbers with their uncertainty, and tests."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, Optional


@dataclass(frozen=True)
class Interval:
    """An interval from `low` to `high`.

    >>> 0.3 in realgap.answer.Interval(0.1, 0.4)
    True
    """

    low: float
    high: float

    def __contains__(self, value: float) -> bool:
        return self.low <= value <= self.high


@dataclass(frozen=True)
class Proportion:
    """How often something happened in so many trials: its share, with the 95 % Wilson interval.

    >>> ensemble.summary.cases[0].summary.diverged.trials
    5
    """

    count: int
    trials: int
    share: float
    low: float
    high: float


@dataclass(frozen=True)
class Quantiles:
    """The distribution of a number over repeats, in its own unit.

    >>> far_m = prediction.card.prediction.displacement_m
    >>> far_m.q05 <= far_m.q50 <= far_m.q95
    True
    """

    mean: float
    standard_deviation: float
    q05: float
    q25: float
    q50: float
    q75: float
    q95: float


@dataclass(frozen=True)
class Estimate:
    """A number with its 95 % interval over recordings; the ends are `None` where there are too few recordings.

    >>> gap.metrics[0].floor.value > 0.0
    True
    """

    value: float
    low: Optional[float]
    high: Optional[float]


@dataclass(frozen=True)
class EnergyTest:
    """The energy test of whether two samples come from one distribution; p is computed from permutations.

    >>> 0.0 < gap.metrics[0].alike.p_value <= 1.0
    True
    """

    distance: float
    # Distance between the samples divided by the distance within them; `None` where nothing within them differs.
    ratio: Optional[float]
    p_value: float
    permutations: int


@dataclass(frozen=True)
class SampleTest:
    """A two-sided test of two samples.

    >>> gap.summary.displacement.mann_whitney.method
    'exact'
    """

    statistic: float
    p_value: float
    method: Literal["exact", "asymptotic"]
