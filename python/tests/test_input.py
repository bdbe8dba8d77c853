"""Errors about wrong input say what was found and what is allowed."""

import numpy as np
import pytest

import realgap
from conftest import STAND_INS, TRIPOD

TIMES = np.linspace(0.0, 1.0, 11)
PLACES = np.column_stack([TIMES, np.sin(TIMES), np.zeros(11)])


def refused(*words):
    return pytest.raises(realgap.Error, match="(?s)" + ".*".join(words))


def test_a_trajectory_keeps_the_bits_of_arrays_of_any_layout():
    made = realgap.Trajectory(TIMES, np.asfortranarray(PLACES))
    assert np.array_equal(made.times_s, TIMES) and np.array_equal(made.positions_m, PLACES)
    assert not made.positions_m.flags.writeable
    backwards = realgap.Trajectory(TIMES, PLACES[::-1])
    assert np.array_equal(backwards.positions_m, PLACES[::-1])
    narrow = realgap.Trajectory(TIMES.astype(">f4"), PLACES.astype(np.float32))
    assert np.array_equal(narrow.positions_m, PLACES.astype(np.float32).astype(float))
    flat = realgap.Trajectory([0, 1], [[0, 0], [1, 2]])
    assert flat.is_planar and flat.positions_m.tolist() == [[0, 0, 0], [1, 2, 0]]


@pytest.mark.parametrize(
    "times, places, words",
    [
        (TIMES[:-1], PLACES, ("positions_m", "wrong shape", "11 x 3", "10 x 3")),
        (TIMES, PLACES[:, 0], ("positions_m", "wrong shape", "found: +11", "11 x 3")),
        (TIMES, PLACES.T, ("positions_m", "wrong shape", "3 x 11")),
        (TIMES, PLACES.astype(complex), ("positions_m", "dtype complex128")),
        (TIMES, PLACES.astype(str), ("positions_m", "dtype <U")),
        (TIMES, PLACES.astype(object), ("positions_m", "dtype object")),
        (TIMES > 0, PLACES, ("times_s", "dtype bool")),
        ("0 1 2", PLACES, ("times_s", "text")),
        (TIMES, [[0, 0, 0], [1]], ("positions_m", "not an array")),
        (TIMES[::-1], PLACES, ("sample 1", "time does not increase")),
        ([0.0], [[0.0, 0.0, 0.0]], ("sample",)),
        ([], np.zeros((0, 3)), ("sample",)),
    ],
)
def test_wrong_lengths_and_kinds_are_refused(times, places, words):
    with refused(*words):
        realgap.Trajectory(times, places)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_a_number_that_is_not_finite_is_located(bad):
    places = PLACES.copy()
    places[4, 1] = bad
    with refused(r"positions_m\[4, 1\]", "not a finite number", str(bad)):
        realgap.Trajectory(TIMES, places)
    with refused("duration_s", "finite"):
        realgap.simulate(realgap.Robot.read(TRIPOD), duration_s=bad)
    with refused("set", "finite"):
        realgap.Study.from_text("", set={"floor.friction": bad})


def test_quaternions_are_checked():
    turned = np.tile([1.0, 0.0, 0.0, 0.0], (11, 1))
    assert np.array_equal(realgap.Trajectory(TIMES, PLACES, turned).quaternions, turned)
    turned[3] *= 1.5
    with refused(r"orientations\[3\]", "length 1.5"):
        realgap.Trajectory(TIMES, PLACES, turned)
    with refused("quaternions", "wrong shape", "11 x 3"):
        realgap.Trajectory(TIMES, PLACES, turned[:, :3])
    with refused("velocity alone"):
        realgap.Trajectory(TIMES, PLACES, velocities_m_s=PLACES)


def test_joints_and_velocities_are_returned_unchanged():
    made = realgap.Trajectory(
        TIMES, PLACES, velocities_m_s=PLACES, angular_velocities_body_rad_s=2 * PLACES,
        joints={"knee": TIMES},
    )  # fmt: skip
    assert np.array_equal(made.joints["knee"].angles_rad, TIMES)
    assert np.array_equal(made.angular_velocities_body_rad_s, 2 * PLACES)
    with refused("knee", "wrong shape"):
        realgap.Trajectory(TIMES, PLACES, joints={"knee": TIMES[1:]})


def test_a_robot_is_the_same_from_file_text_and_dict(tripod):
    text = realgap.Robot.from_text(TRIPOD.read_text())
    assert text.to_ron() == tripod.to_ron()
    cube = {
        "name": "pair",
        "defaults": {"side_m": 0.06, "mass_kg": 0.1},
        "modules": [
            {
                "name": "tail",
                "kind": {
                    "Active": {
                        "face": "PosX",
                        "axis": {"Tangent": {"axis": "PosY"}},
                        "servo": {"law": {"Velocity": {"gain_1_s": 20.0}}, "max_torque_nm": 0.5},
                        "gait": {"amplitude_rad": 0.6, "frequency_hz": np.float64(1.0)},
                    }
                },
            },
            {"name": "head", "kind": {"Passive": {}}},
        ],
        "glue": [{"parent": "tail", "face": "PosX", "child": "head"}],
    }
    pair = realgap.Robot.from_dict(cube)
    assert pair.modules == ["tail", "head"] and pair.hinges == ["tail"]
    assert realgap.Robot.from_text(pair.to_ron()).to_ron() == pair.to_ron()
    with refused("unknown field `colour`"):
        realgap.Robot.from_dict({**cube, "colour": "red"})
    with refused("head"):
        realgap.Robot.from_dict({**cube, "glue": [{**cube["glue"][0], "child": "hand"}]})
    with refused("numbers, texts"):
        realgap.Robot.from_dict({**cube, "glue": [object()]})


def test_errors_about_wrong_options_say_what_is_allowed(tripod, recordings):
    with refused("floor.frictoin", "floor.friction"):
        realgap.simulate(tripod, parameters={"floor.frictoin": 0.4})
    with refused("joint", "rubber", "multibody"):
        realgap.simulate(tripod, joint="rubber")
    with refused("metric", "pcaa"):
        realgap.compare(*recordings, metric="pcaa")
    with refused("`relative` is now called `fraction`"):
        realgap.compare(recordings[0], recordings[1], time="relative")
    with refused("associate", "nearest, interpolate"):
        realgap.compare(recordings[0], recordings[1], associate="next")
    with refused("no samples are matched"):
        realgap.compare(recordings[0], recordings[1], time="fraction", offset_s=0.5)
    vary = {"floor.friction": (0.2, 0.8, 3)}
    study = realgap.Study.of(tripod, recordings, vary, metric="rms", duration_s=0.5)
    for jobs in (0, -1, 10**6):
        with refused("jobs", str(jobs), "1 to"):
            study.sweep(jobs=jobs)
    with refused("resume", "exclude"):
        study.sweep(resume=True, restart=True)
    with refused("optimizer", "simplex", "nelder-mead"):
        study.tune(optimizer="simplex")
    with refused("budget", "at least"):
        study.tune(budget=1)
    with refused("repeats", "0"):
        study.ensemble(repeats=0, noise={"start_heading_rad": {"Normal": 0.02}})
    with refused("unknown field `wind`"):
        study.gap(repeats=3, noise={"wind": 1.0})
    with pytest.raises(TypeError, match="pionts"):
        realgap.Study.from_text("", pionts=3)
    with refused("unknown kind of trajectory file", "meta.ron|.csv"):
        realgap.Trajectory.read(STAND_INS / "meta.ron")


def test_runs_and_recordings_can_be_used_in_place_of_each_other(tripod, recordings):
    run = realgap.simulate(tripod, duration_s=0.5, rate_hz=30.0)
    copy = realgap.Trajectory(run.times_s, run.positions_m, run.quaternions, name=run.name)
    assert realgap.prepare(run).xy_m.tolist() == realgap.prepare(copy).xy_m.tolist()
    for motion in (run, copy, recordings[0]):
        compared = realgap.compare(motion, [run, recordings[1]], metric="rms")
        assert compared.distance(0) == float(realgap.compare(motion, copy, metric="rms"))
    vary = {"floor.friction": (0.2, 0.8, 2)}
    scores = [
        realgap.Study.of(tripod, motions, vary, metric="rms", duration_s=0.5).sweep().points["score"]
        for motions in (run, copy, (run,), [copy])
    ]
    assert scores[1:] == scores[:-1]
    # Both have the same properties.
    for motion in (run, copy):
        assert motion.net_displacement_m == np.hypot(*motion.displacement_m[:2])
        assert motion.duration_s == 0.5 and len(motion) == 16 and motion.picture().startswith(b"\x89PNG")


def test_the_error_about_a_path_in_place_of_an_object_says_how_to_read_it(tripod, recordings):
    vary = {"floor.friction": (0.2, 0.8, 3)}
    for call in (
        lambda: realgap.simulate(TRIPOD),
        lambda: realgap.predict("tripod.ron"),
        lambda: realgap.Study.of(str(TRIPOD), recordings, vary),
    ):
        with refused("robot: not a robot", "Robot.read"):
            call()
    for call in (
        lambda: realgap.compare(recordings[0], "run.csv"),
        lambda: realgap.compare("run.csv", recordings[0]),
        lambda: realgap.prepare(recordings[0].positions_m),
        lambda: realgap.Study.of(tripod, ["run.csv"], vary),
    ):
        with refused("not a trajectory", "Trajectory.read"):
            call()


def test_the_error_about_a_missing_file_names_it(tmp_path):
    for read in (realgap.Robot.read, realgap.Study.read, realgap.Search.read, realgap.Trajectory.read):
        with pytest.raises(realgap.FileError, match="nothing.csv"):
            read(tmp_path / "nothing.csv")


def test_a_folder_of_other_results_is_left_alone(study_file, tmp_path):
    study = realgap.Study.read(study_file)
    folder = tmp_path / "results"
    folder.mkdir()
    (folder / "points.csv").write_text("mine")
    with pytest.raises(realgap.ConflictError, match="points.csv"):
        study.sweep(folder=folder)
    assert (folder / "points.csv").read_text() == "mine"
    first = tmp_path / "first"
    study.sweep(folder=first)
    # Complete results of the same study are used as they are; those of another are not touched.
    assert study.sweep(folder=first).report == study.sweep().report
    other = realgap.Study.read(study_file, points=4)
    for how in ({}, {"resume": True}):
        with pytest.raises(realgap.ConflictError, match="folder=") as caught:
            other.sweep(folder=first, **how)
        assert "--" not in str(caught.value)
    assert other.sweep(folder=first, restart=True).report == other.sweep().report


def test_motions_are_compared_by_the_clock_since_their_starts_or_by_fractions(recordings):
    whole = recordings[0]
    late = realgap.Trajectory(whole.times_s + 100.5, whole.positions_m, whole.quaternions, name="late")
    with refused("no common time"):
        realgap.compare(whole, late, metric="ape")
    assert float(realgap.compare(whole, late, metric="ape", time="start")) < 1e-9
    assert float(realgap.compare(whole, late, metric="ape", offset_s=100.5)) < 1e-9
    found = realgap.compare(whole, late, metric="ape", offset_s="auto").rows[0]
    assert abs(found.offset_s - 100.5) < 0.05
    assert found.time == "clock" and found.matched > 0.9 * len(whole.times_s)
    turned = realgap.Trajectory(whole.times_s, 2.0 * whole.positions_m + 1.0, whole.quaternions)
    assert float(realgap.compare(whole, turned, metric="ape")) > 0.5
    assert float(realgap.compare(whole, turned, metric="ape", align="sim3")) < 1e-9
    assert realgap.compare(whole, turned, metric="ape", time="fraction").rows[0].matched is None
