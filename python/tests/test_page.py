"""Every example of docs/python.md runs as it stands there, with a short study and a short search."""

import re
import types

import numpy as np
import pytest

import realgap
from conftest import PROJECT, STAND_INS, study_text
from test_callback import SEARCH


def blocks():
    page = (PROJECT / "docs" / "python.md").read_text()
    return re.findall(r"```python\n(.*?)```", page, flags=re.DOTALL)


def quick():
    """The package, with short replacements of files that would take minutes."""
    package = types.SimpleNamespace(**{name: getattr(realgap, name) for name in realgap.__all__})

    def read_study(path, **wishes):
        return realgap.Study.from_text(study_text(), name="study", **wishes)

    package.Study = types.SimpleNamespace(
        of=lambda *words, **more: realgap.Study.of(*words, **{**more, "duration_s": 0.5}),
        read=read_study,
    )
    package.Search = types.SimpleNamespace(read=lambda path: realgap.Search.from_dict(SEARCH))
    return package


def test_the_examples_of_the_page_run(tmp_path, monkeypatch):
    optuna = pytest.importorskip("optuna")
    pytest.importorskip("pandas"), pytest.importorskip("matplotlib").use("agg")
    optuna.logging.set_verbosity(optuna.logging.WARNING)
    for folder in ("morphologies", "controllers", "arenas", "sensors"):
        (tmp_path / folder).symlink_to(PROJECT / folder)
    monkeypatch.chdir(tmp_path)
    real = realgap.Trajectory.read(STAND_INS / "run_00.csv")
    simulated = realgap.Trajectory.read(STAND_INS / "run_01.csv")
    names = {
        "realgap": quick(),
        "np": np,
        "optuna": optuna,
        "real": real,
        "simulated": simulated,
        "times_s": real.times_s,
        "positions_m": real.positions_m,
    }
    assert len(blocks()) >= 6
    for block in blocks():
        exec(block.replace("import realgap\n", ""), names)
    assert (tmp_path / "results" / "floor" / "points.csv").exists()
