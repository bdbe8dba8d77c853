"""The fields of `ensemble.json`: repeats under noise (schemas/answers/ensemble.json)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, Mapping, Optional, Tuple

from ._claim import Claim
from ._json import Json
from ._statistic import EnergyTest, Interval, Proportion, Quantiles
from ._warning import Warning


@dataclass(frozen=True)
class Behaviour:
    """A group of repeats that do the same, with the path of the one in its middle.

    >>> [behaviour.kind for behaviour in forecast.behaviours.list][0]
    'as_predicted'
    """

    name: str
    kind: Literal["as_predicted", "turns_in_place", "other_path"]
    probability: Proportion
    representative: Optional[int]
    repeats: Tuple[int, ...]
    mean_displacement_m: float
    path_xy_m: Tuple[Tuple[float, float], ...]


@dataclass(frozen=True)
class Behaviours:
    """The behaviours: first the prediction, then the others by probability. Paths that are more than `cut_m` apart are different behaviours.

    >>> sum(behaviour.probability.count for behaviour in forecast.behaviours.list)
    5
    """

    cut_m: float
    list: Tuple[Behaviour, ...]


@dataclass(frozen=True)
class Region:
    """Concentric ellipses of position at one time; `covariance_m2` is xx, xy, yy, `radii` bound 50, 80 and 90 %.

    >>> len(forecast.envelope.regions[-1].radii)
    3
    """

    centre_m: Tuple[float, float]
    covariance_m2: Tuple[float, float, float]
    radii: Tuple[float, float, float]


@dataclass(frozen=True)
class Envelope:
    """Central regions over time.

    >>> len(forecast.envelope.times_s) == len(forecast.envelope.regions)
    True
    """

    times_s: Tuple[float, ...]
    regions: Tuple[Region, ...]


@dataclass(frozen=True)
class Forecast:
    """The distribution of repeats of a run under noise.

    Spreads are `None` where every repeat diverged; `band` holds whole paths and needs many repeats.

    >>> forecast.repeats, forecast.complete, forecast.band
    (5, True, None)
    """

    repeats: int
    repeats_asked: int
    complete: bool
    seed: int
    duration_s: float
    body_length_m: float
    displacement_m: Optional[Quantiles]
    speed_m_s: Optional[Quantiles]
    path_length_m: Optional[Quantiles]
    turned_rad: Optional[Quantiles]
    noise_free_displacement_m: Optional[float]
    diverged: Proportion
    behaviours: Behaviours
    envelope: Optional[Envelope]
    band: Optional[Envelope]
    noise: Json
    warnings: Tuple[Warning, ...]


@dataclass(frozen=True)
class Coverage:
    """How often reality lies in a region that should hold it with probability `level`.

    >>> ensemble.summary.reality.coverage[0].at_end.trials
    2
    """

    level: float
    over_time: float
    at_end: Proportion
    is_honest: bool
    whole_path: Optional[Proportion]


@dataclass(frozen=True)
class RealRun:
    """One recording against the repeats; its behaviour is `None` where no repeat did the same.

    >>> [run.recording for run in ensemble.summary.reality.runs]
    ['run_00', 'run_01']
    """

    recording: str
    net_displacement_m: float
    behaviour: Optional[str]
    distance_m: float
    time_inside: Tuple[float, float, float]
    ends_inside: Tuple[bool, bool, bool]
    in_band: Optional[Tuple[bool, bool, bool]]
    energy_score_m: float


@dataclass(frozen=True)
class Reality:
    """All recordings against the repeats: coverage, energy score (with the one expected of one more repeat), and whether both come from one distribution.

    >>> ensemble.summary.reality.energy_score_m > 0.0
    True
    """

    coverage: Tuple[Coverage, ...]
    energy_score_m: float
    expected_energy_score_m: float
    alike: Optional[EnergyTest]
    runs: Tuple[RealRun, ...]


@dataclass(frozen=True)
class Model:
    """Another valid model, and how far its results differ from those of the given model.

    >>> {model.source for model in prediction.card.model.models} <= {"numerics", "joints", "engine", "contact"}
    True
    """

    name: str
    source: Literal["numerics", "joints", "engine", "contact", "indistinguishable"]
    ratio: Optional[float]
    behaviours: Tuple[float, ...]


@dataclass(frozen=True)
class OpinionSource:
    """Who said what another engine would do: MuJoCo, which ran this robot, or the table of what it did with other robots, and why.

    >>> prediction.card.model.third_opinion.by in ("mujoco", "table")
    True
    """

    by: Literal["mujoco", "table"]
    mujoco_version: Optional[str]
    runs_m: Tuple[float, ...]
    not_asked: Optional[str]


@dataclass(frozen=True)
class ModelError:
    """How far the results of equally valid models differ: ranges of quantiles (5, 50, 95 %), behaviours and further runs.

    >>> far_m = prediction.card.model.further_run_m  # None of a vehicle, which no engine simulates
    >>> far_m.low <= far_m.high
    True
    """

    models: Tuple[Model, ...]
    repeats: int
    quantiles_m: Tuple[Interval, Interval, Interval]
    behaviours: Tuple[Interval, ...]
    third_opinion: Optional[OpinionSource]
    half_of_runs_m: Optional[Interval]
    further_run_m: Optional[Interval]
    other_engine_adds_m: Optional[Interval]


@dataclass(frozen=True)
class EnsembleCase:
    """The repeats of one start, named after the recording where every recording has its own start.

    >>> len(ensemble.summary.cases)
    1
    """

    case: str
    summary: Forecast
    reality: Optional[Reality]
    model: Optional[ModelError]
    in_further_runs: Optional[Proportion]


@dataclass(frozen=True)
class EnsembleSummary:
    """The whole answer of an ensemble.

    >>> ensemble.summary.complete, ensemble.summary.source
    (True, 'StandIn')
    """

    study: str
    morphology: str
    complete: bool
    parameters: Mapping[str, float]
    noise_from: str
    engine: str
    version: str
    source: Literal["Real", "StandIn"]
    reality: Optional[Reality]
    cases: Tuple[EnsembleCase, ...]
    claims: Tuple[Claim, ...]
    warnings: Tuple[Warning, ...]
