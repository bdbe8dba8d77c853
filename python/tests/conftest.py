"""Fixtures of the tests: the project's files, the command, a small study."""

import os
import subprocess
from pathlib import Path

import pytest

import realgap

PROJECT = Path(__file__).resolve().parents[2]
TRIPOD = PROJECT / "morphologies" / "tripod.ron"
STAND_INS = PROJECT / "real_trajectories" / "tripod_standin"


def _command() -> Path:
    named = os.environ.get("REALGAP_COMMAND")
    if named:
        return Path(named).resolve()
    return PROJECT / "target" / "debug" / "realgap"


@pytest.fixture(scope="session")
def command():
    """Runs the command and returns the completed process."""
    program = _command()
    if not program.exists():
        pytest.skip(f"SKIPPED: no command to compare with at {program}; cargo build makes it")

    def run(*words, check=True, **options):
        done = subprocess.run(
            [str(program), *map(str, words)], capture_output=True, text=True, **options
        )
        if check:
            assert done.returncode == 0, done.stderr
        return done

    run.program = program
    return run


@pytest.fixture(scope="session")
def tripod():
    return realgap.Robot.read(TRIPOD)


@pytest.fixture(scope="session")
def recordings():
    return [realgap.Trajectory.read(STAND_INS / f"run_0{k}.csv") for k in range(2)]


STUDY = """Study(
    morphology: "{project}/morphologies/tripod.ron",
    recordings: ["{project}/real_trajectories/tripod_standin/run_0[01].csv"],
    start: Settled,
    duration_s: {duration_s},
    parameters: [(name: "floor.friction", from: 0.2, to: 0.8, points: {points})],
    metric: "rms",
    noise: Noise(start_heading_rad: Normal(0.02), friction_run_relative: LogNormal(0.05)),
)
"""


def study_text(duration_s=0.5, points=3):
    return STUDY.format(project=PROJECT, duration_s=duration_s, points=points)


@pytest.fixture
def study_file(tmp_path):
    """A study that takes a moment."""
    path = tmp_path / "friction.ron"
    path.write_text(study_text())
    return path
