"""The package is typed, so that type checkers find wrong uses."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[1]

# A program of a user with its types. Both checkers accept it in their strict mode.
PROGRAM = """
from typing import Mapping, Optional, Sequence

import numpy as np
import numpy.typing as npt

import realgap
from realgap.answer import Estimate, Interval, Proportion

robot = realgap.Robot.read("tripod.ron")
run = realgap.simulate(robot, duration_s=1.0, parameters={"floor.friction": 0.4}, joint="multibody")
length: float = run.net_displacement_m
angles: npt.NDArray[np.float64] = run.joint_angles_rad
real = realgap.Trajectory(np.arange(3), np.zeros((3, 3)))
either: list[realgap.Trajectory] = [real, run]
compared = realgap.compare(real, [real, run], metric="rms")
distance: float = float(compared) + compared.rows[1].distances["rms_m"]

study = realgap.Study.read("study.ron", points=5, metric="rms", set={"floor.restitution": 0.1}, reading={"length": "mm"})
study = realgap.Study.from_dict({"morphology": "tripod.ron", "parameters": [{"name": "floor.friction"}]}, folds=2)
study = realgap.Study.of(robot, either, {"floor.friction": (0.1, 0.9, 5)}, noise={"start_heading_rad": {"Normal": 0.02}})
answer = study.sweep(jobs=2)
best: dict[str, float] = answer.best
for verdict in answer.verdicts:
    wide: float = verdict.high - verdict.low
    interval: Optional[Interval] = verdict.interval
    print(f"{verdict.parameter} {verdict.best:.3g} {verdict.unit}", verdict.identified, verdict.text)
codes: list[str] = [warning.code for warning in answer.warnings]
lowest: float = float(answer.points.numbers("score").min())
audit = answer.summary.audit
if audit is not None:
    changes: list[Optional[float]] = [row.change for row in audit.rows]
frame = answer.to_polars()
raw: realgap.Json = answer.report["best"]

for metric in answer.fitted.gap(repeats=5).metrics:
    floor: Optional[Estimate] = metric.floor
draws = answer.posterior.to_pandas()
width: float = float(answer.profiles[0].high.max() - answer.profiles[0].low.min())
asked = realgap.Trajectory.from_pandas(draws, {"length": "mm"}, name="draws")
places: npt.NDArray[np.float64] = np.asarray(asked)
axes: object = answer.plot("map", parameters=["floor.friction", "floor.restitution"])
axes = answer.fitted.gap(progress=True).plot("confidence", ax=None)
started = realgap.start(["run.csv"], "tripod.ron", reading={"length": "cm"}, pd={"knee": (20.0, 1.0)})
errors: realgap.Table = started.study.evaluate().rows
identified: dict[str, float] = started.study.identify(explain="gravity").parameters
shown: Optional[str] = realgap.replay(run, [real], output="replay.html")
success = realgap.predict(robot).card.success
if success is not None:
    likely: Proportion = success.probability


def ends(one: npt.NDArray[np.float64], other: npt.NDArray[np.float64]) -> float:
    return float(np.linalg.norm(one[-1] - other[-1]))


def later(one: realgap.Trajectory, other: realgap.Trajectory) -> float:
    return abs(one.duration_s - other.duration_s)


own = [realgap.Metric("ends", ends), realgap.Metric("later", later, unit="s", whole=True)]
realgap.compare(real, run, metric=own)


class Dice:
    def __init__(self, dimensions: int, budget: int, seed: int) -> None:
        self.rng = np.random.default_rng(seed)

    def ask(self) -> Sequence[Sequence[float]]:
        return [[self.rng.random()]]

    def tell(self, points: Sequence[Sequence[float]], scores: Sequence[Optional[float]]) -> None:
        pass


study.tune(optimizer=realgap.Optimizer("dice", Dice), budget=9)


def gait(t_s: float) -> Mapping[str, float]:
    return {hinge: float(np.sin(t_s)) for hinge in robot.hinges}


def turning(repeats: list[realgap.Travel]) -> float:
    return min(abs(repeat.turned_rad) for repeat in repeats)


def step(sensed: realgap.Sensed) -> Optional[Mapping[str, float]]:
    near = sensed.readings["front"]
    if near is not None and near < 20.0 or any(heard.strength_dbm > -50.0 for heard in sensed.heard):
        return {hinge: 0.5 * angle for hinge, angle in sensed.angles_rad.items()}
    return None


realgap.simulate(robot, gait=gait)
steered = realgap.simulate(robot, controller="avoid.ron", seed=1, step=step, step_rate_hz=20.0)
read: npt.NDArray[np.float64] = steered.decisions.numbers("front")
ways: dict[str, realgap.Trajectory] = steered.others
found = realgap.Search.read("search.ron", seed=2).run(objective=turning)
survivors: list[int] = [finalist.card.rank for finalist in found.finalists if finalist.survives]
"""
# Mistakes that both checkers find, one per line.
SLIPS = """
realgap.simulate("tripod.ron")
wrong: str = run.net_displacement_m
realgap.Study.read("study.ron", pionts=5)
realgap.Study.read("study.ron", points="five")
realgap.Study.of(robot, ["run.csv"], {})
realgap.simulate(robot, joint="rubber")
answer.verdicts[0].bset
answer.verdicts[0]["best"]
realgap.Metric("wrong", later)
realgap.simulate(robot, step=gait)
"""


def checked(tmp_path, checker, text):
    """The lines of a program about which a checker complains, with its messages."""
    program = tmp_path / "program.py"
    program.write_text(text)
    if checker == "mypy":
        said = mypy("--strict", "--output", "json", program).stdout.splitlines()
        found = [json.loads(line) for line in said if line.startswith("{")]
        faults = [(fault["line"], fault["message"]) for fault in found]
    else:
        settings = {"include": ["program.py"], "extraPaths": [str(PACKAGE)], "typeCheckingMode": "strict"}
        (tmp_path / "pyrightconfig.json").write_text(json.dumps(settings))
        found = pyright(tmp_path)
        faults = [(fault["range"]["start"]["line"] + 1, fault["message"]) for fault in found]
    return {line: message for line, message in faults}


def mypy(*words):
    pytest.importorskip("mypy")
    words = [sys.executable, "-m", "mypy", "--cache-dir", ".mypy_cache", *map(str, words)]
    return subprocess.run(words, capture_output=True, text=True, cwd=PACKAGE)


def pyright(project):
    """What pyright finds; it is a program of its own, which needs the network when it runs for the first time."""
    pytest.importorskip("pyright", reason="SKIPPED: pyright is not installed")
    words = ["--outputjson", "--pythonpath", sys.executable, "-p", str(project)]
    words = [sys.executable, "-m", "pyright", *words]
    done = subprocess.run(words, capture_output=True, text=True)
    if not done.stdout.startswith("{"):
        pytest.skip(f"SKIPPED: pyright does not run here: {done.stdout[-200:]}{done.stderr[-200:]}")
    said = json.loads(done.stdout)
    assert said["summary"]["filesAnalyzed"] > 0, said
    return [fault for fault in said["generalDiagnostics"] if fault["severity"] == "error"]


def test_the_package_itself_is_sound():
    done = mypy()
    assert done.returncode == 0, done.stdout
    assert [(fault["file"], fault["message"]) for fault in pyright(PACKAGE)] == []


def test_the_stubs_are_those_of_the_compiled_half():
    pytest.importorskip("mypy")
    words = [sys.executable, "-m", "mypy.stubtest", "--ignore-disjoint-bases", "realgap._native"]
    done = subprocess.run(words, capture_output=True, text=True, cwd=PACKAGE)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("checker", ["mypy", "pyright"])
def test_a_program_that_uses_it_passes_the_strict_check_and_one_with_slips_does_not(tmp_path, checker):
    assert checked(tmp_path, checker, PROGRAM) == {}
    first = len(PROGRAM.splitlines()) + 1
    slips = range(first, first + len(SLIPS.strip().splitlines()))
    assert set(checked(tmp_path, checker, PROGRAM + SLIPS.lstrip())) == set(slips)
