"""The committed schemas are JSON Schemas by the reference implementation's measure, and answers and inputs fit them."""

import json

import pytest
from jsonschema import Draft202012Validator

import realgap

from conftest import PROJECT

SCHEMAS = sorted((PROJECT / "schemas").glob("*/*.json"))


def schema(path):
    return json.loads((PROJECT / "schemas" / f"{path}.json").read_text())


def faults(path, value):
    return [error.message for error in Draft202012Validator(schema(path)).iter_errors(value)]


@pytest.mark.parametrize("file", SCHEMAS, ids=lambda file: f"{file.parent.name}/{file.stem}")
def test_a_schema_is_a_schema(file):
    Draft202012Validator.check_schema(json.loads(file.read_text()))


def test_answers_fit_their_schemas(command, study_file):
    said = command("parameters", "--format", "json").stdout
    assert faults("answers/parameters", json.loads(said)) == []
    answer = realgap.Study.read(study_file).sweep()
    assert answer.report["schema_version"] == 1
    assert faults("answers/sweep", answer.report) == []
    assert faults("answers/sweep", {**answer.report, "schema_version": 2}) != []
    assert faults("answers/sweep", {**answer.report, "best": None, "metric": 3}) != []


def test_a_dictionary_that_is_a_robot_fits_the_schema_and_one_that_does_not_is_none():
    cube = {"side_m": 0.06, "mass_kg": 0.1}
    robot = {"name": "one", "modules": [{"name": "a", "kind": {"Passive": cube}}]}
    assert faults("files/robot", robot) == []
    assert realgap.Robot.from_dict(robot).name == "one"
    wrong = {"name": "one", "modules": [{"name": "a", "kind": {"Passive": {**cube, "mass_g": 1}}}]}
    assert faults("files/robot", wrong) != []
    with pytest.raises(realgap.Error, match="mass_g"):
        realgap.Robot.from_dict(wrong)
