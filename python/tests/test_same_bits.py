"""Results in Python equal those of the command, to the last byte."""

import json

import numpy as np
import pytest

import realgap
from conftest import STAND_INS, TRIPOD


def files_of(folder):
    """The files of a results folder that depend on the study alone."""
    found = {}
    for file in sorted(folder.rglob("*")):
        # The command leaves a page of its own, which names the command; Python makes one with `report`. The checksums include it.
        without = {"timing.json", "report.html", "page.json", "SHA256SUMS"}
        if file.is_file() and file.name not in without and not file.name.startswith("."):
            found[str(file.relative_to(folder))] = file.read_bytes()
    return found


def assert_same_folder(ours, theirs):
    ours, theirs = files_of(ours), files_of(theirs)
    assert ours.keys() == theirs.keys()
    assert len(ours) > 2
    for name in ours:
        assert ours[name] == theirs[name], name


def test_a_simulation_has_the_bytes_of_the_command(command, tripod, tmp_path):
    command(
        "simulate", TRIPOD, "--duration", 1.5, "--set", "floor.friction=0.4", "--rate", 50,
        "-o", tmp_path / "c.csv", "--parts", tmp_path / "c_parts.csv",
    )  # fmt: skip
    run = realgap.simulate(
        tripod, duration_s=1.5, parameters={"floor.friction": 0.4}, rate_hz=50.0
    )
    # With all parts asked for, the command writes the joints into the motion, too.
    run.write_parts(tmp_path / "p_parts.csv")
    assert (tmp_path / "p_parts.csv").read_bytes() == (tmp_path / "c_parts.csv").read_bytes()
    command("simulate", TRIPOD, "--duration", 1.5, "--set", "floor.friction=0.4", "--rate", 50,
            "-o", tmp_path / "c.csv", "--force")  # fmt: skip
    run.write(tmp_path / "p.csv")
    assert (tmp_path / "p.csv").read_bytes() == (tmp_path / "c.csv").read_bytes()


def test_the_arrays_of_a_simulation_are_what_the_command_writes(command, tripod, tmp_path):
    parts = tmp_path / "parts.csv"
    command("simulate", TRIPOD, "--duration", 1, "--parts", parts)
    run = realgap.simulate(tripod, duration_s=1.0)
    columns = np.genfromtxt(parts, delimiter=",", names=True)
    assert np.array_equal(run.times_s, columns["t_s"])
    for axis, name in enumerate("xyz"):
        assert np.array_equal(run.positions_m[:, axis], columns[f"{name}_m"])
        for part in range(len(tripod.parts)):
            expected = columns[f"part{part}_{name}_m"]
            assert np.array_equal(run.part_positions_m[:, part, axis], expected)
    for number, name in enumerate("wxyz"):
        for part in range(len(tripod.parts)):
            expected = columns[f"part{part}_q{name}"]
            assert np.array_equal(run.part_quaternions[:, part, number], expected)
    for number, hinge in enumerate(tripod.hinges):
        assert np.array_equal(run.joint_angles_rad[:, number], columns[f"{hinge}_rad"])


def test_a_sweep_leaves_the_folder_of_the_command(command, study_file, tmp_path):
    command("sweep", study_file, "-o", tmp_path / "c", "--jobs", 2)
    study = realgap.Study.read(study_file)
    answer = study.sweep(folder=tmp_path / "p", jobs=1)
    assert_same_folder(tmp_path / "p", tmp_path / "c")
    summary = json.loads((tmp_path / "c" / "summary.json").read_text())
    assert answer.report == summary
    # In memory and from text, the same.
    text = realgap.Study.from_text(study_file.read_text(), name="friction", folder=tmp_path)
    again = text.sweep(jobs=2)
    assert again.report == summary
    assert again.points.to_dict() == answer.points.to_dict()


def test_a_study_of_dicts_and_one_of_objects_give_the_scores_of_its_file(
    study_file, tripod, recordings
):
    expected = realgap.Study.read(study_file).sweep().points.to_dict()
    fields = {
        "morphology": str(TRIPOD),
        "recordings": [str(STAND_INS / "run_0[01].csv")],
        "start": "Settled",
        "duration_s": 0.5,
        "parameters": [{"name": "floor.friction", "from": 0.2, "to": 0.8, "points": 3}],
        "metric": "rms",
        "noise": {"start_heading_rad": {"Normal": 0.02}},
    }
    of_dict = realgap.Study.from_dict(fields, name="friction")
    assert of_dict.sweep().points.to_dict() == expected
    shorter = realgap.Study.from_dict({**fields, "duration_s": 2.0}, name="friction", duration_s=0.5)
    assert shorter.sweep().points.to_dict() == expected
    vary = {"floor.friction": (0.2, 0.8, 3)}
    made = realgap.Study.of(
        tripod, recordings, vary, name="friction", metric="rms", duration_s=0.5
    )
    assert made.sweep().points.to_dict() == expected


def test_recordings_of_a_fit_are_marked_as_in_sample(study_file):
    answer = realgap.Study.read(study_file).sweep()
    fitted = answer.fitted
    assert fitted.info["set"] == answer.best
    assert "in-sample" in [warning.code for warning in fitted.warnings]
    again = realgap.Study.read(study_file).at(answer.best)
    assert "in-sample" not in [warning.code for warning in again.warnings]
    # The one run without noise is that of the best point; every repeat draws its parameters from all that fit as well.
    carried, alone = (study.gap(repeats=4).metrics[0] for study in (fitted, again))
    assert (carried.floor, carried.ideal) == (alone.floor, alone.ideal)
    assert carried.repeats != alone.repeats


def test_a_tuning_leaves_the_folder_of_the_command(command, study_file, tmp_path):
    how = ("--optimizer", "nelder-mead", "--budget", 14)
    command("tune", study_file, *how, "-o", tmp_path / "c")
    study = realgap.Study.read(study_file)
    study.tune(optimizer="nelder-mead", budget=14, folder=tmp_path / "p", jobs=1)
    assert_same_folder(tmp_path / "p", tmp_path / "c")


def test_a_prediction_leaves_the_folder_of_the_command(command, tripod, tmp_path):
    command("predict", TRIPOD, "--duration", 0.5, "--repeats", 6, "-o", tmp_path / "c",
            "--model-error", "off")  # fmt: skip
    realgap.predict(tripod, duration_s=0.5, repeats=6, folder=tmp_path / "p", model_error=False)
    ours, theirs = files_of(tmp_path / "p"), files_of(tmp_path / "c")
    assert ours.keys() == theirs.keys()
    assert ours["repeats.csv"] == theirs["repeats.csv"]
    assert ours["prediction.png"] == theirs["prediction.png"]
    ours, theirs = (json.loads(f["prediction.json"]) for f in (ours, theirs))
    for card in (ours, theirs):
        # The advice differs between the command and Python.
        card["warnings"] = [warning["code"] for warning in card["warnings"]]
    assert ours == theirs


def test_a_gap_and_an_ensemble_say_what_the_command_says(command, study_file, tmp_path):
    study = realgap.Study.read(study_file, set={"floor.friction": 0.4})
    command("gap", study_file, "--set", "floor.friction=0.4", "--repeats", 5, "-o", tmp_path / "c")
    study.gap(repeats=5, folder=tmp_path / "p")
    assert_same_folder(tmp_path / "p", tmp_path / "c")
    said = command("ensemble", study_file, "--set", "floor.friction=0.4", "--repeats", 5,
                   "--model-error", "off", "-o", tmp_path / "e", "--format", "json")  # fmt: skip
    theirs = json.loads(said.stdout)
    ours = study.ensemble(repeats=5, model_error=False).report
    for report in (ours, theirs):
        report.pop("noise_from")
    assert ours == theirs


def test_a_comparison_says_what_the_command_says(command, recordings):
    files = [STAND_INS / "run_00.csv", STAND_INS / "run_01.csv"]
    theirs = json.loads(command("compare", *files, "--format", "json").stdout)
    ours = realgap.compare(recordings[0], recordings[1]).report
    for row in theirs:
        row.pop("pca_components")
        row.pop("pca_4_coefficients_m")
        assert row.pop("schema_version") == 1
        row.pop("warnings")
    for row in ours:
        row.pop("warnings")
    assert ours == theirs


def test_an_error_has_the_text_of_the_command(command, tmp_path):
    broken = tmp_path / "robot.ron"
    broken.write_text(TRIPOD.read_text().replace("mass_kg", "mas_kg", 1))
    said = command("simulate", broken, check=False)
    assert said.returncode == 1
    try:
        realgap.Robot.read(broken)
        raise AssertionError("a broken robot was read")
    except realgap.InvalidError as error:
        assert said.stderr.strip() == f"error: {error}"
        assert error.file == str(broken) and error.line is not None


def test_who_says_what_another_engine_would_do_is_chosen_and_named(tripod):
    def asked(**options):
        return realgap.predict(tripod, duration_s=0.5, repeats=4, **options).card.model.third_opinion

    said = asked(other_engine="table")
    assert (said.by, said.mujoco_version, said.runs_m, said.not_asked) == ("table", None, (), None)
    with pytest.raises(realgap.Error, match="auto, mujoco, table"):
        asked(other_engine="isaac")
    with pytest.raises(realgap.Error, match="other_engine"):
        asked(other_engine="table", model_error=False)
