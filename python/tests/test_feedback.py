"""A gait with feedback: a function that gets readings and messages of the robot, and returns commands of its servos."""

import math
import signal
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import realgap
from conftest import PROJECT, TRIPOD

AVOID = PROJECT / "controllers" / "tripod_avoid.ron"


def spring(sensed):
    """Every servo half way back from where it is."""
    return {hinge: 0.5 * angle for hinge, angle in sensed.angles_rad.items()}


def test_a_step_is_called_at_a_fixed_rate_and_its_commands_hold_until_the_next_call(tripod):
    times_s = []

    def step(sensed):
        times_s.append(sensed.time_s)
        return {hinge: 0.3 if sensed.time_s > 0.45 else 0.0 for hinge in tripod.hinges}

    run = realgap.simulate(tripod, duration_s=1.0, rate_hz=100.0, step=step, step_rate_hz=20.0)
    assert len(times_s) == 20
    assert np.diff(times_s) == pytest.approx(0.05, abs=0.003)
    angles, late = run.joint_angles_rad, run.times_s > 0.9
    early = (run.times_s > 0.3) & (run.times_s < 0.45)
    assert angles[early] == pytest.approx(0.0, abs=0.05)
    assert angles[late] == pytest.approx(0.3, abs=0.05)
    assert run.decisions.rows == 20
    assert run.decisions.numbers("t_s") == pytest.approx(times_s, abs=1e-6)


def test_a_step_gets_the_current_angles_and_the_current_place(tripod):
    known = []
    run = realgap.simulate(tripod, duration_s=1.0, rate_hz=480.0, step=known.append, step_rate_hz=10.0)
    free = realgap.simulate(tripod, duration_s=1.0, rate_hz=480.0)
    # A step that returns no commands does not change the motion.
    assert run.positions_m.tobytes() == free.positions_m.tobytes()
    for sensed in known:
        row = int(round(sensed.time_s * 480.0))
        angles = [sensed.angles_rad[hinge] for hinge in tripod.hinges]
        assert angles == pytest.approx(run.joint_angles_rad[row], abs=1e-9)
        assert sensed.position_m == pytest.approx(run.positions_m[row], abs=1e-9)


def test_many_threads_get_the_bits_of_one(tripod):
    def bits(_):
        run = realgap.simulate(
            tripod, duration_s=3.0, controller=AVOID, seed=4, step=spring, step_rate_hz=40.0
        )
        return run.positions_m.tobytes(), tuple(run.decisions["front"])

    alone = bits(0)
    for workers in (1, 2, 4):
        with ThreadPoolExecutor(workers) as pool:
            assert set(pool.map(bits, range(workers))) == {alone}


def test_a_controller_gives_the_bytes_of_the_command(command, tripod, tmp_path):
    files = [tmp_path / name for name in ("c.csv", "c_way.csv", "p.csv", "p_way.csv")]
    command(
        "simulate", TRIPOD, "--controller", AVOID, "--seed", 3, "--duration", 8,
        "-o", files[0], "--decisions", files[1],
    )  # fmt: skip
    run = realgap.simulate(tripod, duration_s=8.0, controller=AVOID, seed=3)
    run.write(files[2])
    run.write_decisions(files[3])
    assert files[2].read_bytes() == files[0].read_bytes()
    assert files[3].read_bytes() == files[1].read_bytes()
    assert run.decisions["robot"] == ["robot"] * 80


def test_a_function_in_place_of_rules_stops_before_the_box(tripod, tmp_path):
    blind = tmp_path / "blind.ron"
    text = AVOID.read_text().replace("../arenas", str(PROJECT / "arenas"))
    blind.write_text(text[: text.index("    rules:")] + ")")

    def stop(sensed):
        near.append(sensed.readings["front"] is not None and sensed.readings["front"] < 20.0)
        return dict(sensed.angles_rad) if any(near) else None

    near = []
    run = realgap.simulate(tripod, duration_s=25.0, controller=blind, seed=1, step=stop)
    # The near face of the box is at x = 0.86 m, and the tripod walks towards it from 0.36 m.
    way = run.decisions.numbers("x_m")
    assert any(near) and 0.55 < way[-1] < 0.75
    assert way.max() - way[-1] < 0.02


def test_robots_hear_where_the_others_were(tripod, tmp_path):
    (tmp_path / "radio.ron").write_text(
        'Radio(propagation: "thickness", values: [-40.0, 2.0, 0.0, 600.0], shadowing_sd_db: 0.0)'
    )
    (tmp_path / "hall.ron").write_text('(name: "hall", size_m: (4.0, 3.0), boundary: Open)')
    crew = tmp_path / "crew.ron"
    crew.write_text(
        """(arena: "hall.ron", rate_hz: 10, name: "one", start: (x_m: 1.0, y_m: 1.0),
        others: [(name: "two", x_m: 1.0, y_m: 2.0)],
        radio: (model: "radio.ron", every_s: 0.5, latency_s: 0.15))"""
    )
    told = {"one": [], "two": []}
    run = realgap.simulate(tripod, duration_s=1.0, controller=crew, step=lambda s: told[s.robot].append(s))
    assert list(run.others) == ["two"] and len(told["one"]) == len(told["two"]) == 10
    assert told["one"][1].heard == ()
    heard, sender = told["one"][-1].heard[0], told["two"]
    assert heard.robot == "two" and heard.arrived_s - heard.sent_s == pytest.approx(0.15)
    then = min(sender, key=lambda sensed: abs(sensed.time_s - heard.sent_s))
    assert heard.position_m == pytest.approx(then.position_m, abs=1e-9)
    assert run.others["two"].positions_m[0, 1] == pytest.approx(1.0, abs=0.01)


class Enough(Exception):
    """An exception of a user."""


def test_an_exception_in_a_step_is_raised_unchanged(tripod):
    thrown = Enough("at last")

    def step(sensed):
        if sensed.time_s > 0.3:
            raise thrown

    with pytest.raises(Enough) as caught:
        realgap.simulate(tripod, duration_s=1.0, step=step)
    assert caught.value is thrown
    # The next run is not affected.
    assert len(realgap.simulate(tripod, duration_s=0.5, step=lambda sensed: None)) == 31


@pytest.mark.parametrize(
    "commands, kind, words",
    [
        ({"leg_x": 0.1}, realgap.UsageError, "no servo of this name"),
        ({"leg_a": math.nan}, realgap.CallbackError, "finite number"),
        ({"leg_a": "far"}, realgap.CallbackError, "must give a number, not str"),
        ([0.1, 0.2], realgap.CallbackError, "a dict of angles by hinge"),
        (0.3, realgap.CallbackError, "a dict of angles by hinge"),
    ],
)
def test_invalid_commands_are_refused_with_the_allowed_values(tripod, commands, kind, words):
    with pytest.raises(kind, match=words):
        realgap.simulate(tripod, duration_s=0.5, step=lambda sensed: commands)


@pytest.mark.parametrize(
    "options, words",
    [
        ({"step_rate_hz": 10.0}, "nothing decides"),
        ({"seed": 1}, "without a controller"),
        ({"step": spring, "seed": 1}, "without a controller"),
        ({"step": spring, "step_rate_hz": 0.0}, "step_rate_hz"),
        ({"step": spring, "step_rate_hz": math.inf}, "step_rate_hz"),
        ({"step": spring, "step_rate_hz": 1e5}, "at most once a timestep"),
        ({"controller": AVOID, "arena": "arenas/paper000.ron"}, "an arena of its own"),
        ({"controller": TRIPOD}, "rate_hz|controller"),
    ],
)
def test_options_that_do_not_go_together_are_refused(tripod, options, words):
    with pytest.raises(realgap.Error, match=words):
        realgap.simulate(tripod, duration_s=0.5, **options)


@pytest.mark.parametrize("step", [None, spring])
def test_ctrl_c_ends_a_long_run_with_and_without_feedback_within_a_second(tripod, step):
    pressed_s = []

    def press():
        pressed_s.append(time.process_time())
        signal.raise_signal(signal.SIGINT)

    timer = threading.Timer(0.5, press)
    timer.start()
    with pytest.raises(realgap.Interrupted, match="interrupted at t_s"):
        realgap.simulate(tripod, duration_s=3600.0, rate_hz=1.0, step=step)
    ended_s = time.process_time()
    timer.join()
    assert ended_s - pressed_s[0] < 1.0


def test_ctrl_c_in_a_step_is_not_treated_as_its_error(tripod):
    def step(sensed):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        realgap.simulate(tripod, duration_s=0.5, step=step)
