"""Data of one's own: frames, arrays of commands, `start`, `evaluate`, `identify`, `replay`."""

import numpy as np
import pytest

import realgap
from conftest import PROJECT, STAND_INS, TRIPOD
from realgap._progress import Bar

TOSSES = PROJECT / "sweeps" / "cube_toss_fit.ron"
BEST = PROJECT / "sweeps" / "cube_toss_best.ron"


def test_a_frame_is_read_as_the_file_with_its_columns():
    pandas = pytest.importorskip("pandas")
    file = STAND_INS / "run_00.csv"
    real = realgap.Trajectory.read(file)
    frame = pandas.read_csv(file, comment="#")
    made = realgap.Trajectory.from_pandas(frame, name="mine")
    assert made.name == "mine" and np.array_equal(made.positions_m, real.positions_m)
    assert np.array_equal(made.times_s, real.times_s)
    degrees = pandas.DataFrame({"t_s": [0.0, 1.0], "knee_deg": [0.0, 90.0], "knee_command_rad": [0.0, 1.5]})
    knee = realgap.Trajectory.from_pandas(degrees)
    assert knee.joints["knee"].angles_rad[1] == pytest.approx(np.pi / 2)
    assert knee.joints["knee_command"].angles_rad.tolist() == [0.0, 1.5]
    with pytest.raises(realgap.Error, match="not a pandas frame"):
        realgap.Trajectory.from_pandas({"t_s": [0.0]})
    with pytest.raises(realgap.Error, match="without slashes"):
        realgap.Trajectory.from_pandas(frame, name="a/b")


def test_a_motion_is_an_array_of_positions(recordings):
    array = np.asarray(recordings[0])
    assert np.array_equal(array, recordings[0].positions_m)
    copy = np.array(recordings[0], dtype=np.float32)
    copy[0, 0] = 7.0
    assert recordings[0].positions_m[0, 0] != 7.0 and copy.dtype == np.float32


def test_recorded_commands_drive_the_servos(tripod):
    times_s = np.linspace(0.0, 0.5, 31)
    swing = {hinge: 0.5 * np.sin(8.0 * times_s) for hinge in tripod.hinges}
    run = realgap.simulate(tripod, duration_s=0.5, commands=swing, commands_at_s=times_s)
    still = realgap.simulate(
        tripod, duration_s=0.5, commands={hinge: 0.0 * times_s for hinge in swing}, commands_at_s=times_s
    )
    assert abs(run.joint_angles_rad).max() > 0.2 > abs(still.joint_angles_rad).max()

    def best(**options):
        real = realgap.Trajectory(run.times_s, run.positions_m, run.quaternions, **options)
        vary = {"floor.friction": (0.2, 0.8, 2)}
        follow = options.get("commands") is not None
        study = realgap.Study.of(
            tripod, real, vary, metric="rms", duration_s=0.5, score="single", commands=follow or None
        )
        return study.sweep(audit=False, progress=False).score

    # Doubling the recorded commands changes the runs: they are used.
    assert best(commands=swing) != best(commands={hinge: 2.0 * a for hinge, a in swing.items()})
    assert best(commands=swing) != best()
    with pytest.raises(realgap.UsageError, match="no recording has commands"):
        realgap.Study.of(tripod, run, {"floor.friction": (0.2, 0.8)}, metric="rms", commands=True)
    with pytest.raises(realgap.UsageError, match="commands without times"):
        realgap.simulate(tripod, commands=swing)
    with pytest.raises(realgap.UsageError, match="(?s)no hinge of this name.*leg_a"):
        realgap.simulate(tripod, commands={"tail": times_s}, commands_at_s=times_s)


def test_start_makes_the_study_of_the_command(tmp_path, command):
    own, other = tmp_path / "own.ron", tmp_path / "other.ron"
    files = [STAND_INS / f"run_0{k}.csv" for k in range(2)]
    started = realgap.start(files, TRIPOD, output=own)
    assert started.study.info["recordings"] == ["run_00", "run_01"]
    assert "read as follows" in str(started) and "stand-in" in [w.code for w in started.warnings]
    command("start", *files, TRIPOD, "-o", other)
    assert own.read_text().replace("own.ron", "other.ron") == other.read_text()


def test_what_files_leave_open_is_an_error_with_an_argument(tmp_path):
    place = tmp_path / "run.csv"
    rows = [f"{0.1 * k},{k},{0.5 * k}" for k in range(40)]
    place.write_text("\n".join(["t,x,y", *rows]))
    with pytest.raises(realgap.UsageError, match="(?s)open.*reading") as caught:
        realgap.start(place, cube=(0.1, 0.3), output=tmp_path / "study.ron")
    assert "--" not in str(caught.value), str(caught.value)
    started = realgap.start(
        place, cube=(0.1, 0.3), reading={"length": "cm", "time": "s"}, output=tmp_path / "study.ron"
    )
    assert started.study.recordings[0].positions_m[1, 0] == pytest.approx(0.01)
    with pytest.raises(realgap.UsageError, match="no such file"):
        realgap.start(tmp_path / "none*.csv", TRIPOD)
    with pytest.raises(realgap.UsageError, match="(?s)which robot.*cube="):
        realgap.start(place, reading={"length": "cm"}, output=tmp_path / "other.ron")


def test_evaluate_gives_the_errors_of_the_command(command):
    words = ("evaluate", TOSSES, "--limit-recordings", 3, "--parameters", BEST, "--rows", "--format", "json")
    import json

    said = json.loads(command(*words).stdout)
    study = realgap.Study.read(TOSSES, limit_recordings=3, parameters=BEST)
    found = study.evaluate(progress=False)
    assert found.report["position_percent"] == said["position_percent"]
    assert found.rows["recording"] == [row["recording"] for row in said["rows"]]
    assert [claim.about for claim in found.claims] == [claim["about"] for claim in said["claims"]]
    assert str(found).startswith("gap: ")
    double = study.at({"floor.friction": 0.5}).evaluate()
    assert double.report["position_percent"] != said["position_percent"]


def test_evaluate_needs_orientations_and_says_so(tripod, recordings):
    flat = [realgap.Trajectory(r.times_s, r.positions_m) for r in recordings]
    study = realgap.Study.of(tripod, flat, {"floor.friction": (0.2, 0.8)}, metric="rms", duration_s=0.5)
    with pytest.raises(realgap.Error, match="(?s)need orientations.*Study.gap"):
        study.evaluate()


def test_identify_gives_values_for_a_study(tmp_path):
    study = realgap.Study.read(TOSSES, limit_recordings=8)
    found = study.identify(progress=False)
    assert "recording.length_scale" in found.parameters
    found.write(tmp_path / "body.ron")
    assert realgap.read_parameters(tmp_path / "body.ron") == pytest.approx(found.parameters)
    assert "gravity_m_s2" in study.identify(explain="gravity").parameters
    with pytest.raises(realgap.UsageError, match="(?s)explanation.*gravity"):
        study.identify(explain="wind")


def test_a_replay_is_a_page_or_a_file(tmp_path, tripod, recordings):
    run = realgap.simulate(tripod, duration_s=0.5)
    page = realgap.replay(run, recordings)
    assert "<html" in page and "run_00" in page
    assert realgap.replay(recordings[0], robot=tripod, output=tmp_path / "run.glb") is None
    assert (tmp_path / "run.glb").read_bytes()[:4] == b"glTF"
    with pytest.raises(realgap.UsageError, match=r"(?s)cannot be written.*\.html"):
        realgap.replay(run, output=tmp_path / "run.txt")


@pytest.mark.parametrize("jobs", ["2", 1.5, True])
def test_a_number_of_the_wrong_kind_is_a_sentence(tripod, recordings, jobs):
    study = realgap.Study.of(tripod, recordings, {"floor.friction": (0.2, 0.8)}, metric="rms", duration_s=0.5)
    with pytest.raises(realgap.UsageError, match="(?s)jobs: not a whole number.*found.*allowed"):
        study.sweep(jobs=jobs)
    with pytest.raises(realgap.UsageError, match="(?s)progress: not a way"):
        study.sweep(progress=3)
    with pytest.raises(realgap.UsageError, match="(?s)folder: not a path"):
        study.sweep(folder=3)


def test_a_bar_counts_and_says_the_time_left(tripod, recordings, capsys):
    study = realgap.Study.of(
        tripod, recordings, {"floor.friction": (0.2, 0.8, 9)}, metric="rms", duration_s=2.0
    )
    study.sweep(progress=True)
    said = capsys.readouterr().err.split("\r")
    assert any("/9" in line for line in said), said
    assert not any(" 0 s left" in line for line in said), said
    study.sweep(progress=False)
    assert capsys.readouterr().err == ""


def test_a_bar_never_says_that_nothing_is_left_while_something_is():
    lines = []
    bar = Bar(lines.append, clock=iter([0.0, 0.0, 1.0, 1.5, 2.0]).__next__)
    for done in (0, 30, 39, 40):
        bar(done, 40, None, None)
    assert [line.rpartition("/40")[2] for line in lines] == [", under 1 s left", ", under 1 s left", ""]
    lines.clear()
    bar = Bar(lines.append, clock=iter([0.0, 0.0, 1.0]).__next__)
    bar(0, 40, None, None)
    bar(4, 40, None, None)
    assert lines[0].endswith(", 9 s left")
