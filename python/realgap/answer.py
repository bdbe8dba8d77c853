"""What answers say, as values with fields: those of the JSON files (`schemas/answers`), by the same names.

A number that JSON has no word for, because it is not finite, is NaN.

>>> answer.summary.verdicts[0].parameter
'floor.friction'
"""

from ._card import Card, Economy, FinalistCard, Growth, Rerun, Success, SuccessRange
from ._claim import Claim
from ._forecast import (
    Behaviour,
    Behaviours,
    Coverage,
    EnsembleCase,
    EnsembleSummary,
    Envelope,
    Forecast,
    Model,
    ModelError,
    Reality,
    RealRun,
    Region,
)
from ._gap import Confidence, Fitness, GapAndRatio, GapSummary, MetricGap, OverTime
from ._statistic import EnergyTest, Estimate, Interval, Proportion, Quantiles, SampleTest
from ._sweep import (
    Audit,
    AuditRow,
    Best,
    Correlation,
    Estimated,
    Fit,
    Fold,
    HowSure,
    MetricFloors,
    Partner,
    PoseErrors,
    Reproduction,
    RobotMisfit,
    RobotReproduction,
    SweepSummary,
    Transfer,
    Tuned,
    Validation,
    Verdict,
)
from ._warning import Warning

__all__ = [
    "Audit",
    "AuditRow",
    "Behaviour",
    "Behaviours",
    "Best",
    "Card",
    "Claim",
    "Confidence",
    "Correlation",
    "Coverage",
    "Economy",
    "EnergyTest",
    "EnsembleCase",
    "EnsembleSummary",
    "Envelope",
    "Estimate",
    "Estimated",
    "FinalistCard",
    "Fit",
    "Fitness",
    "Fold",
    "Forecast",
    "GapAndRatio",
    "GapSummary",
    "Growth",
    "HowSure",
    "Interval",
    "MetricFloors",
    "MetricGap",
    "Model",
    "ModelError",
    "OverTime",
    "Partner",
    "PoseErrors",
    "Proportion",
    "Quantiles",
    "RealRun",
    "Reality",
    "Region",
    "Reproduction",
    "Rerun",
    "RobotMisfit",
    "RobotReproduction",
    "SampleTest",
    "Success",
    "SuccessRange",
    "SweepSummary",
    "Transfer",
    "Tuned",
    "Validation",
    "Verdict",
    "Warning",
]
