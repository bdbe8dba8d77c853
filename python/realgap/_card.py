"""The fields of a prediction card (schemas/answers/predict.json)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Mapping, Optional, Tuple

from ._claim import Claim
from ._forecast import Forecast, ModelError
from ._statistic import Interval, Proportion
from ._warning import Warning


@dataclass(frozen=True)
class SuccessRange:
    """The range of a probability over equally valid models, and the probability in an engine that was not simulated.

    >>> prediction.card.success.range.models.low >= 0.0
    True
    """

    models: Interval
    other_engine: float


@dataclass(frozen=True)
class Success:
    """The probability that a robot gets far enough; `rule` says how the distance was chosen.

    >>> prediction.card.success.probability.trials
    5
    """

    least_displacement_m: float
    rule: str
    probability: Proportion
    range: Optional[SuccessRange]


@dataclass(frozen=True)
class DivergenceRate:
    """How fast a small difference grows in a run of this length.

    >>> prediction.card.growth.duration_s
    0.5
    """

    rate_1_s: float
    duration_s: float
    body_length_m: float


@dataclass(frozen=True)
class Card:
    """What a robot will do, how likely it is, and in `not_covered` what no number here takes into account.

    >>> prediction.card.robot, prediction.card.noise_from
    ('tripod', 'estimate')
    """

    robot: str
    success: Optional[Success]
    parameters: Mapping[str, float]
    noise_from: Optional[str]
    engine: str
    version: str
    growth: Optional[DivergenceRate]
    prediction: Forecast
    model: Optional[ModelError]
    claims: Tuple[Claim, ...]
    not_covered: Tuple[str, ...]
    warnings: Tuple[Warning, ...]


@dataclass(frozen=True)
class CostOfTransport:
    """The mechanical cost of transport of a robot: mean energy of its servos, per metre, and per metre and weight.

    >>> economy = found.finalists[0].card.economy
    >>> economy is None or economy.servo_j > 0.0
    True
    """

    servo_j: float
    joules_per_metre: float
    cost_of_transport: float
    residual_share: float


@dataclass(frozen=True)
class Rerun:
    """A robot simulated again under other solver settings, with the draws by which it was chosen.

    >>> len(found.finalists[0].card.reruns) > 0
    True
    """

    settings: str
    mean_displacement_m: Optional[float]
    change: Optional[float]
    failure: Optional[str]
    survives: bool


@dataclass(frozen=True)
class FinalistCard(Card):
    """The card of one of the best robots of a search, with its fitness in the search and with fresh seeds.

    >>> found.finalists[0].card.rank
    1
    """

    rank: int
    survives: bool
    objective: str
    unit: str
    search_fitness: Optional[float]
    fitness: Optional[float]
    economy: Optional[CostOfTransport]
    reruns: Tuple[Rerun, ...]
