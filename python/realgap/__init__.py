"""How far is a simulated robot from the real one, what closes the gap, and how sure may we be?

The same library as the command `realgap`, with the same numbers to the last bit. Lengths are metres, angles radians, times
seconds; z is up, quaternions have their real part first. See docs/python.md.

The examples of this package use these objects, and a `folder` to write into. They run in a clone of the repository:

>>> robot = realgap.Robot.read("morphologies/tripod.ron")
>>> run = realgap.simulate(robot, duration_s=0.5)
>>> recordings = [realgap.Trajectory.read(f"real_trajectories/tripod_standin/run_0{k}.csv") for k in range(2)]
>>> study = realgap.Study.of(
...     robot,
...     recordings,
...     {"floor.friction": (0.2, 0.8, 3)},
...     metric="rms",
...     duration_s=0.5,
...     noise={"start_heading_rad": {"Normal": 0.02}},
... )
>>> answer = study.sweep()
>>> tuned = study.tune(optimizer="nelder-mead", budget=12)
>>> ensemble = answer.fitted.ensemble(repeats=5, model_error=False)
>>> forecast = ensemble.summary.cases[0].summary
>>> gap = answer.fitted.gap(repeats=5)
>>> prediction = realgap.predict(robot, duration_s=0.5, repeats=5)
>>> search = realgap.Search.from_dict(
...     {
...         "strategy": {"Evolution": {"population": 4, "generations": 2}},
...         "duration_s": 0.5,
...         "repeats": 2,
...         "finalists": {"count": 1, "repeats": 3},
...     },
...     name="quick",
... )
>>> found = search.run()
"""

from . import answer
from ._answer import Answer, Profile
from ._callback import AskTell, Metric, Optimizer
from ._catalogue import engine, metrics, optimizers, parameters, read_parameters
from ._comparison import Comparison, Distances, compare
from ._error import (
    CallbackError,
    ConflictError,
    Error,
    FileError,
    Interrupted,
    InvalidError,
    UsageError,
)
from ._feedback import Heard, Sensed
from ._finding import Evaluation, Identification
from ._json import Json, JsonObject
from ._prediction import Ensemble, Gap, Prediction, predict
from ._replay import replay
from ._report import report
from ._result import Result
from ._robot import Robot
from ._search import Finalist, Search, SearchResults, Travel
from ._simulation import EnergyBalance, Simulation, simulate
from ._statistic import Interval
from ._simulator import Question, serve
from ._start import Started, start
from ._study import Study
from ._sweep import Verdict
from ._table import Table
from ._trajectory import Joint, Prepared, Trajectory, prepare
from ._version import __version__
from ._warning import Warning as Warning  # Not in __all__: there is a built-in of this name.

__all__ = [
    "Answer",
    "AskTell",
    "CallbackError",
    "Comparison",
    "ConflictError",
    "Distances",
    "EnergyBalance",
    "Ensemble",
    "Error",
    "Evaluation",
    "FileError",
    "Finalist",
    "Gap",
    "Heard",
    "Identification",
    "Interrupted",
    "Interval",
    "InvalidError",
    "Joint",
    "Json",
    "JsonObject",
    "Metric",
    "Optimizer",
    "Prediction",
    "Prepared",
    "Profile",
    "Question",
    "Result",
    "Robot",
    "Search",
    "SearchResults",
    "Sensed",
    "Simulation",
    "Started",
    "Study",
    "Table",
    "Trajectory",
    "Travel",
    "UsageError",
    "Verdict",
    "__version__",
    "answer",
    "compare",
    "engine",
    "metrics",
    "optimizers",
    "parameters",
    "predict",
    "prepare",
    "read_parameters",
    "replay",
    "report",
    "serve",
    "simulate",
    "start",
]
