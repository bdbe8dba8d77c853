"""The fields of `summary.json` of a sweep or a tuning (schemas/answers/sweep.json)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, Mapping, Optional, Tuple

from ._claim import Claim
from ._statistic import Interval, Proportion
from ._warning import Warning


@dataclass(frozen=True)
class Best:
    """The best point, its score in the metric's unit: the mean over `settings` equally valid settings.

    `own_score` is the score of the study's own settings; its difference from `score` is numerical scatter.

    >>> list(answer.summary.best.parameters), answer.summary.best.settings
    (['floor.friction'], 16)
    """

    parameters: Mapping[str, float]
    score: float
    settings: int
    own_score: Optional[float]
    displacement_error_m: Optional[float]


@dataclass(frozen=True)
class Verdict:
    """The verdict of the recordings on one parameter.

    `low` and `high` are the ends of the values that are indistinguishable from the best value; `interval` is the central 90 % interval of the
    best value when reality is sampled again, `intervals` its parts where values between them are rejected; `identified` is
    false where the recordings do not determine the parameter within the searched range.

    >>> verdict = answer.verdicts[0]
    >>> verdict.parameter, verdict.low <= verdict.best <= verdict.high
    ('floor.friction', True)
    """

    parameter: str
    unit: str
    best: float
    low: float
    high: float
    interval: Optional[Interval]
    identified: bool
    text: str
    intervals: Tuple[Interval, ...] = ()


@dataclass(frozen=True)
class BestPointUncertainty:
    """The confidence in the best point: how many of all points are indistinguishable from it, including itself.

    >>> answer.summary.uncertainty.indistinguishable >= 1
    True
    """

    source: Literal["recordings", "runs"]
    level: float
    best_score_sd: float
    simulation_sd: float
    emulator_share: float
    indistinguishable: int
    points: int


@dataclass(frozen=True)
class Correlation:
    """How the best values of two parameters move together when reality is sampled again (Pearson).

    >>> answer.summary.correlations
    ()
    """

    first: str
    second: str
    value: float


@dataclass(frozen=True)
class Difference:
    """By how much a parameter differs between two sets of recordings: the first minus the second, with its 95 % interval.

    >>> answer.summary.differences
    ()
    """

    first: str
    second: str
    value: float
    low: float
    high: float


@dataclass(frozen=True)
class AuditRow:
    """The best point again, with one numerical setting changed; no score where it diverged.

    >>> any(row.coarser for row in answer.summary.audit.rows)
    True
    """

    setting: str
    coarser: bool
    score: Optional[float]
    change: Optional[float]


@dataclass(frozen=True)
class Audit:
    """The changes of the best score by numerical settings, which recordings cannot determine.

    `unresolved` are parameters whose whole range changes the score less than that, `shaken` those whose indistinguishable values
    change it less.

    >>> answer.summary.audit.largest_change >= 0.0
    True
    """

    rows: Tuple[AuditRow, ...]
    largest_change: float
    largest_coarser_change: float
    unresolved: Tuple[str, ...]
    shaken: Tuple[str, ...]


@dataclass(frozen=True)
class Fold:
    """One fold: the best values without some recordings, checked with these.

    >>> folds = realgap.Study.of(robot, recordings, {"floor.friction": (0.2, 0.8, 3)}, metric="rms", duration_s=0.5, folds=2)
    >>> [fold.held_out for fold in folds.sweep().summary.validation.folds]
    [('run_00',), ('run_01',)]
    """

    values: Tuple[float, ...]
    fit_score: float
    held_out_score: float
    held_out: Tuple[str, ...]


@dataclass(frozen=True)
class ChannelBand:
    """What predictions of one column leave open: what fitted recordings have more than the best run, and how bands hold.

    >>> realgap.answer.ChannelBand("hip_rad", "rad", -0.01, 0.01, 0.9, 100).channel
    'hip_rad'
    """

    channel: str
    unit: str
    rest_low: float
    rest_high: float
    held_out_share: float
    held_out_samples: int


@dataclass(frozen=True)
class Bands:
    """Bands of predictions of least squares (draws of the posterior, and what the fit leaves), and the share of samples in them.

    >>> answer.summary.validation is None    # where nothing is held out
    True
    """

    level: float
    draws: int
    held_out_share: float
    fitted_share: float
    held_out_runs: int
    channels: Tuple[ChannelBand, ...]


@dataclass(frozen=True)
class Validation:
    """The scores of the fit on recordings that were held out.

    >>> answer.summary.validation is None    # where nothing is held out
    True
    """

    split: str
    fit_score: float
    held_out_score: float
    difference_standard_error: float
    held_out_recordings: int
    folds: Tuple[Fold, ...]
    bands: Optional[Bands] = None


@dataclass(frozen=True)
class PoseErrors:
    """Pose errors of the best point: percent of the body length, and degrees.

    >>> answer.summary.pose is None    # of metrics of poses only
    True
    """

    position_percent: float
    rotation_deg: float


@dataclass(frozen=True)
class Partner:
    """The parameter that correlates most with another one, and their correlation.

    >>> realgap.answer.Partner("floor.restitution", 0.9).parameter
    'floor.restitution'
    """

    parameter: str
    correlation: float


@dataclass(frozen=True)
class Combination:
    """A ratio or a product of two parameters that recordings determine where they determine neither, with its 90 % interval.

    >>> [e.combination for e in tuned.summary.tuning.least_squares]    # of gauss-newton only
    []
    """

    name: str
    value: float
    low: float
    high: float


@dataclass(frozen=True)
class Agreement:
    """How good the posterior of least squares is: the next step in standard deviations, and runs at draws beside what it promises.

    `systematic` is the size of the errors in sizes of their noise, `descents` how many descents ended at the best point (None for a
    fit with one start): large errors where one alone ended may be those of a wrong minimum, and no parameter is called determined.

    >>> tuned.summary.tuning.agreement is None    # of gauss-newton only
    True
    """

    remaining: float
    checked: int
    effective: float
    excess: Optional[float]
    systematic: Optional[float] = None
    descents: Optional[int] = None


@dataclass(frozen=True)
class Estimated:
    """The estimate of a parameter by least squares with its 90 % interval, from the draws of the posterior.

    `is_told` says whether the recordings determine it; where they do not, `combination` may be what they do determine.

    >>> tuned.summary.tuning.least_squares    # of gauss-newton only
    ()
    """

    parameter: str
    value: float
    low: float
    high: float
    is_told: bool
    partner: Optional[Partner]
    combination: Optional[Combination] = None


@dataclass(frozen=True)
class InformationGain:
    """The information gain by one recording over the others, in bits: about all parameters (one bit halves their volume), and about each.

    For a recording that was not fitted, it is the gain that the fit would have with it.

    >>> tuned.summary.tuning.motions    # of gauss-newton only
    ()
    """

    recording: str
    is_fitted: bool
    bits: float
    parameters: Mapping[str, float]


@dataclass(frozen=True)
class Tuned:
    """How an optimizer chose the points: `design` of them fill the space first.

    >>> tuned.summary.tuning.optimizer, tuned.summary.tuning.termination
    ('nelder-mead', 'budget')
    """

    optimizer: str
    budget: int
    design: int
    evaluated: int
    termination: Literal["budget", "exhausted", "no_improvement", "interrupted"]
    least_squares: Tuple[Estimated, ...] = ()
    agreement: Optional[Agreement] = None
    lowest_score: Optional[float] = None
    motions: Tuple[InformationGain, ...] = ()


@dataclass(frozen=True)
class Misfit:
    """Where the nearest run departs from recordings that no parameters explain, and the one change of it that would help most.

    >>> fit = answer.summary.fit
    >>> fit is None or fit.misfit is None or fit.misfit.from_s < fit.misfit.to_s
    True
    """

    from_s: float
    to_s: float
    deviations: float
    change: Literal["mirrored", "lengths", "pace", "turning"]
    size: float
    share: float


@dataclass(frozen=True)
class ChannelFit:
    """The residuals of one channel beside the noise of the recordings; `systematic` is in standard deviations of that noise.

    >>> fit = answer.summary.fit
    >>> channels = fit.residuals.channels if fit and fit.residuals else ()
    >>> all(channel.noise > 0 for channel in channels)
    True
    """

    channel: str
    unit: str
    noise: float
    noise_source: Literal["high_frequencies", "resolution", "stated"]
    residual: float
    systematic: float


@dataclass(frozen=True)
class ResidualMisfit:
    """The part of the residuals that noise does not explain: in which channel (a position in `channels`), when, and what it follows.

    >>> fit = answer.summary.fit
    >>> fit is None or fit.residuals is None or fit.explains == (fit.residuals.misfit is None)
    True
    """

    channel: int
    from_s: float
    to_s: float
    pattern: Literal["lag", "offset", "position", "load", "growth", "drift", "scatter", "other"]
    size: float
    share: float


@dataclass(frozen=True)
class ResidualFit:
    """Whether the residuals of runs that start from recordings are noise: their rank among imitated recordings.

    >>> fit = answer.summary.fit
    >>> fit is None or fit.residuals is None or 0 < fit.residuals.p_value <= 1
    True
    """

    p_value: float
    imitations: int
    channels: Tuple[ChannelFit, ...]
    misfit: Optional[ResidualMisfit] = None


@dataclass(frozen=True)
class Fit:
    """Whether the best point explains the recordings: how far its runs are in noise floors, and the energy test's p; or what the
    residuals say, where runs start from recordings. `explains` is true where nothing could be `judged`.

    >>> fit = answer.summary.fit
    >>> fit is None or fit.noise_floors is None or fit.noise_floors >= 0
    True
    """

    judged: bool
    noise_floors: Optional[float]
    p_value: Optional[float]
    explains: bool
    discrepancy: float
    engine: Optional[str] = None
    misfit: Optional[Misfit] = None
    neighbours_p_value: Optional[float] = None
    residuals: Optional[ResidualFit] = None


@dataclass(frozen=True)
class RobotMisfit:
    """The distance of one robot of a study of many from its recordings: untuned, at the shared answer, at the best values of the other robots, at its own.

    >>> [robot.held_out for robot in answer.summary.transfer.robots] if answer.summary.transfer else []
    []
    """

    robot: str
    recordings: int
    untuned: float
    shared: float
    held_out: float
    without_it: Tuple[float, ...]
    refitted_among: int
    own: float
    closed: float


@dataclass(frozen=True)
class Transfer:
    """How well a floor that was tuned on the other robots fits each robot; only for a study of many robots.

    >>> answer.summary.transfer is None
    True
    """

    untuned: Tuple[float, ...]
    untuned_misfit: float
    held_out_misfit: float
    own_misfit: float
    closed: float
    closable: float
    own_parameters: Literal["none", "refitted", "as_they_came"]
    robots: Tuple[RobotMisfit, ...]


@dataclass(frozen=True)
class MetricFloors:
    """How many robots are within their noise floor by one metric, of those that have one.

    >>> [of.metric for of in answer.summary.reproduction.metrics] if answer.summary.reproduction else []
    []
    """

    metric: str
    within_floor: Proportion
    median_noise_floors: Optional[float]


@dataclass(frozen=True)
class RobotReproduction:
    """How the shared answer reproduces one robot of a study of many: distances of paths by `rms`, and net displacements.

    >>> [robot.likeness for robot in answer.summary.reproduction.robots] if answer.summary.reproduction else []
    []
    """

    robot: str
    likeness: Literal["within_floor", "alike", "goes_nowhere", "other_path"]
    distance_m: float
    floor_m: Optional[float]
    alike_m: float
    recorded_m: float
    recorded_sd_m: float
    simulated_m: float
    simulated_sd_m: float
    held: bool


@dataclass(frozen=True)
class Reproduction:
    """In how many robots of a study of many the shared answer does what was recorded, with 95 % Wilson intervals.

    >>> answer.summary.reproduction is None
    True
    """

    runs: int
    within_floor: Proportion
    alike: Proportion
    goes_nowhere: Proportion
    other_path: Proportion
    metrics: Tuple[MetricFloors, ...]
    displacement_held: Optional[Proportion]
    displacement_promise: float
    robots: Tuple[RobotReproduction, ...]


@dataclass(frozen=True)
class SweepSummary:
    """The whole answer of a sweep or a tuning.

    `points` of `points_total` were evaluated in `runs` simulations; `components` are shares of the variance, for metrics that
    project; `provenance` holds versions, settings and check sums of inputs.

    >>> answer.summary.points, answer.summary.complete, answer.summary.tuning
    (3, True, None)
    """

    study: str
    description: str
    complete: bool
    points: int
    runs: int
    points_total: int
    tuning: Optional[Tuned]
    diverged: int
    recordings: int
    metric: str
    unit: str
    best: Optional[Best]
    fit: Optional[Fit]
    uncertainty: Optional[BestPointUncertainty]
    verdicts: Tuple[Verdict, ...]
    claims: Tuple[Claim, ...]
    correlations: Tuple[Correlation, ...]
    differences: Tuple[Difference, ...]
    audit: Optional[Audit]
    validation: Optional[Validation]
    transfer: Optional[Transfer]
    reproduction: Optional[Reproduction]
    components: Optional[Tuple[float, ...]]
    pose: Optional[PoseErrors]
    provenance: Mapping[str, str]
    warnings: Tuple[Warning, ...]
