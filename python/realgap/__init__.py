"""How far is a simulated robot from the real one, what closes the gap, and how sure may we be?

The same library as the command `realgap`, with the same numbers to the last bit. Lengths are metres, angles radians, times
seconds; z is up, quaternions have their real part first. See docs/python.md.
"""

from ._callback import AskTell, Metric, Optimizer
from ._catalogue import engine, metrics, optimizers, parameters, read_parameters
from ._comparison import Comparison, compare
from ._error import (
    CallbackError,
    ConflictError,
    Error,
    FileError,
    Interrupted,
    InvalidError,
    UsageError,
)
from ._prediction import Ensemble, Gap, Prediction, predict
from ._report import report
from ._robot import Robot
from ._search import Finalist, Search, SearchResults
from ._simulation import Simulation, simulate
from ._study import Answer, Study
from ._table import Table
from ._trajectory import Joint, Prepared, Trajectory, prepare
from ._version import __version__

__all__ = [
    "Answer",
    "AskTell",
    "CallbackError",
    "Comparison",
    "ConflictError",
    "Ensemble",
    "Error",
    "FileError",
    "Finalist",
    "Gap",
    "Interrupted",
    "InvalidError",
    "Joint",
    "Metric",
    "Optimizer",
    "Prediction",
    "Prepared",
    "Robot",
    "Search",
    "SearchResults",
    "Simulation",
    "Study",
    "Table",
    "Trajectory",
    "UsageError",
    "__version__",
    "compare",
    "engine",
    "metrics",
    "optimizers",
    "parameters",
    "predict",
    "prepare",
    "read_parameters",
    "report",
    "simulate",
]
