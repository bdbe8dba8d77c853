"""The fields of `gap.json` (schemas/answers/gap.json)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, Mapping, Optional, Tuple

from ._claim import Claim
from ._json import Json
from ._statistic import EnergyTest, Estimate, Proportion, SampleTest
from ._warning import Warning


@dataclass(frozen=True)
class GapAndRatio:
    """A gap, and its ratio to the noise floor: at 1, a run is as near to a recording as another recording is.

    >>> gap.metrics[0].ideal.ratio.value > 0.0
    True
    """

    gap: Estimate
    ratio: Optional[Estimate]


@dataclass(frozen=True)
class MetricGap:
    """Noise floor (real against real), gap and ratio by one metric.

    `ideal` is the run without noise, `repeats` the mean over repeats; `alike` tests whether repeats and recordings come from one distribution.

    >>> gap.metrics[0].metric, gap.metrics[0].unit
    ('rms', 'm')
    """

    metric: str
    unit: str
    floor: Optional[Estimate]
    ideal: Optional[GapAndRatio]
    repeats: Optional[GapAndRatio]
    alike: Optional[EnergyTest]


@dataclass(frozen=True)
class Fitness:
    """How far the robot gets: recordings against repeats under noise.

    >>> gap.summary.displacement.real_mean_m > 0.0
    True
    """

    real_mean_m: float
    simulated_mean_m: float
    mann_whitney: SampleTest
    kolmogorov_smirnov: SampleTest


@dataclass(frozen=True)
class OverTime:
    """Root mean square distance from the recordings at each of the prepared times.

    `real_mean_m` is the error of the mean of the other recordings: no prediction can be expected to have a smaller one.

    >>> len(gap.summary.over_time.times_s)
    182
    """

    times_s: Tuple[float, ...]
    ideal_m: Optional[Tuple[float, ...]]
    simulated_mean_m: Optional[Tuple[float, ...]]
    real_mean_m: Optional[Tuple[float, ...]]


@dataclass(frozen=True)
class Confidence:
    """The probability, at each time, that a real run lies inside the region of this level, which the repeats give.

    >>> gap.summary.confidence.inside[0].trials
    2
    """

    level: float
    times_s: Tuple[float, ...]
    inside: Tuple[Proportion, ...]
    over_time: float
    over_time_interval: Tuple[float, float]
    below_half_s: Optional[float]
    surely_below_half_s: Optional[float]


@dataclass(frozen=True)
class GapSummary:
    """The whole answer of a gap.

    >>> gap.summary.recordings, gap.summary.repeats
    (2, 5)
    """

    study: str
    morphology: str
    parameters: Mapping[str, float]
    complete: bool
    recordings: int
    source: Literal["Real", "StandIn"]
    starts: int
    repeats: int
    seed: int
    metrics: Tuple[MetricGap, ...]
    displacement: Optional[Fitness]
    over_time: OverTime
    confidence: Optional[Confidence]
    claims: Tuple[Claim, ...]
    noise: Json
    engine: str
    version: str
    warnings: Tuple[Warning, ...]
