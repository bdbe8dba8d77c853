"""The package is typed, and using it wrongly is found before it runs."""

import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("mypy")
PACKAGE = Path(__file__).resolve().parents[1]

PROGRAM = """
import numpy as np
import realgap

robot = realgap.Robot.read("tripod.ron")
run = realgap.simulate(robot, duration_s=1.0, parameters={"floor.friction": 0.4})
length: float = run.net_displacement_m
real = realgap.Trajectory(np.arange(3), np.zeros((3, 3)))
distance: float = float(realgap.compare(real, run.trajectory, metric="rms"))
study = realgap.Study.of(robot, real, {"floor.friction": (0.1, 0.9, 5)}, metric="rms")
best: dict[str, float] = study.sweep(jobs=2).best
"""


def mypy(*words):
    words = [sys.executable, "-m", "mypy", "--cache-dir", ".mypy_cache", *map(str, words)]
    return subprocess.run(words, capture_output=True, text=True, cwd=PACKAGE)


def test_the_package_itself_is_sound():
    done = mypy()
    assert done.returncode == 0, done.stdout


def test_the_stubs_are_those_of_the_compiled_half():
    words = [sys.executable, "-m", "mypy.stubtest", "--ignore-disjoint-bases", "realgap._native"]
    done = subprocess.run(words, capture_output=True, text=True, cwd=PACKAGE)
    assert done.returncode == 0, done.stdout + done.stderr


def test_a_program_that_uses_it_is_checked(tmp_path):
    good = tmp_path / "good.py"
    good.write_text(PROGRAM)
    done = mypy("--strict", good)
    assert done.returncode == 0, done.stdout
    bad = tmp_path / "bad.py"
    bad.write_text(PROGRAM + 'realgap.simulate("tripod.ron")\nwrong: str = run.net_displacement_m\n')
    done = mypy("--strict", bad)
    assert done.stdout.count("error:") == 2, done.stdout
