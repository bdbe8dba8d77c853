"""A simulator of one's own: a function in a study, and the same function served to a command."""

import math
import sys
from pathlib import Path

import numpy as np
import pytest
import realgap

SPRING = '''
import math
import sys
import realgap


def spring(question):
    """A mass on a spring, released at rest: x = x0 cos(w t)."""
    w = math.sqrt(question.parameters["stiffness"] / question.parameters["mass"])
    x0 = question.start.get("x_m", 0.1)
    x = [x0 * math.cos(w * t) for t in question.times_s]
    print("one more run")
    return {"x_m": x, "y_m": [0.0] * len(x)}


DECLARES = {"stiffness": (1.0, 100.0, 30.0, "N/m"), "mass": (0.1, 10.0, 1.0, "kg")}

if __name__ == "__main__":
    realgap.serve(spring, DECLARES, name="spring")
'''


def recorded(stiffness: float, x0_m: float) -> realgap.Trajectory:
    times_s = np.arange(0.0, 2.0, 0.02)
    noise_m = 1e-4 * np.sin(1e4 * times_s)
    x_m = x0_m * np.cos(math.sqrt(stiffness) * times_s) + noise_m
    return realgap.Trajectory(times_s, np.column_stack([x_m, noise_m, 0 * x_m]), name=f"x{x0_m}")


def module() -> dict:
    made = {"__name__": "spring"}
    exec(SPRING, made)
    return made


def test_a_function_is_tuned_in_place_of_a_robot():
    made = module()
    runs = [recorded(42.0, 0.1), recorded(42.0, 0.2)]
    study = realgap.Study.of(
        recordings=runs,
        vary={"stiffness": (20.0, 60.0, 9)},
        simulate=made["spring"],
        declares=made["DECLARES"],
        metric="rms",
        name="spring",
    )
    best = study.sweep().best
    assert list(best) == ["sim.stiffness"]
    assert abs(best["sim.stiffness"] - 42.0) < 5.0


def test_an_exception_costs_a_run_and_is_named():
    made = module()

    def weak(question):
        if question.parameters["stiffness"] > 50.0:
            raise ArithmeticError("it broke")
        return made["spring"](question)

    study = realgap.Study.of(
        recordings=[recorded(42.0, 0.1), recorded(42.0, 0.2)],
        vary={"stiffness": (20.0, 60.0, 9)},
        simulate=weak,
        declares=made["DECLARES"],
        metric="rms",
    )
    answer = study.sweep()
    assert abs(answer.best["sim.stiffness"] - 42.0) < 5.0
    assert "diverged" in [warning.code for warning in answer.warnings]


def test_the_served_function_answers_the_command_and_only_with_consent(tmp_path: Path):
    (tmp_path / "spring.py").write_text(SPRING)
    for index, x0_m in enumerate((0.1, 0.2)):
        recorded(42.0, x0_m).write(tmp_path / f"run_{index}.csv")
    text = f'''(
        simulator: Command([{_ron(sys.executable)}, "spring.py"]),
        recordings: ["run_*.csv"],
        start: Settled,
        parameters: [(name: "stiffness", from: 20, to: 60, points: 9), (name: "mass", points: 2)],
        metric: "rms",
    )'''
    study = tmp_path / "study.ron"
    study.write_text(text)
    with pytest.raises(realgap.UsageError, match="consent"):
        realgap.Study.read(study)
    read = realgap.Study.read(study, allow_command=True)
    assert read.parameters == ["sim.stiffness", "sim.mass"]
    unknown = text.replace("stiffness", "stifness")
    study.write_text(unknown)
    with pytest.raises(realgap.InvalidError, match="stiffness"):
        realgap.Study.read(study, allow_command=True)


def _ron(path: str) -> str:
    return '"' + path.replace("\\", "\\\\") + '"'


def test_what_belongs_to_a_simulator_is_refused_without_one():
    with pytest.raises(realgap.UsageError, match="belong to a function"):
        realgap.Study.of(recordings=[], vary={}, declares={"stiffness": (1.0, 100.0, 30.0, "N/m")})
