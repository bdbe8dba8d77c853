"""The committed schemas are valid by the reference implementation, and answers and inputs are valid by them."""

import collections.abc
import dataclasses
import json
import math
from typing import Literal, Union, get_args, get_origin, get_type_hints

import pytest
from jsonschema import Draft202012Validator

import realgap

from conftest import PROJECT
from realgap._json import made

SCHEMAS = sorted((PROJECT / "schemas").glob("*/*.json"))


def schema(path):
    return json.loads((PROJECT / "schemas" / f"{path}.json").read_text())


def faults(path, value):
    return [error.message for error in Draft202012Validator(schema(path)).iter_errors(value)]


@pytest.mark.parametrize("file", SCHEMAS, ids=lambda file: f"{file.parent.name}/{file.stem}")
def test_a_schema_is_a_schema(file):
    Draft202012Validator.check_schema(json.loads(file.read_text()))


def test_answers_fit_their_schemas(command, study_file):
    said = command("study", "parameters", "--format", "json").stdout
    assert faults("answers/parameters", json.loads(said)) == []
    answer = realgap.Study.read(study_file).sweep()
    assert answer.report["schema_version"] == 1
    assert faults("answers/sweep", answer.report) == []
    assert faults("answers/sweep", {**answer.report, "schema_version": 2}) != []
    assert faults("answers/sweep", {**answer.report, "best": None, "metric": 3}) != []


def test_the_schema_of_a_robot_accepts_and_refuses_the_same_dictionaries_as_the_package():
    cube = {"side_m": 0.06, "mass_kg": 0.1}
    robot = {"name": "one", "modules": [{"name": "a", "kind": {"Passive": cube}}]}
    assert faults("files/robot", robot) == []
    assert realgap.Robot.from_dict(robot).name == "one"
    wrong = {"name": "one", "modules": [{"name": "a", "kind": {"Passive": {**cube, "mass_g": 1}}}]}
    assert faults("files/robot", wrong) != []
    with pytest.raises(realgap.Error, match="mass_g"):
        realgap.Robot.from_dict(wrong)


def kinds(schema, definitions):
    """What a schema allows, without null: a set of the names of JSON's kinds, and the schema that says so."""
    if "$ref" in schema:
        return kinds(definitions[schema["$ref"].rsplit("/", 1)[-1]], definitions)
    for word in ("anyOf", "oneOf"):
        if word in schema:
            parts = [part for part in schema[word] if part != {"type": "null"}]
            if len(parts) == 1 or all("const" in part for part in parts):
                return kinds(parts[0], definitions) if len(parts) == 1 else ({"string"}, schema)
    kind = schema.get("type", [])
    return set([kind] if isinstance(kind, str) else kind) - {"null"}, schema


PLAIN = {str: "string", int: "integer", float: "number", bool: "boolean"}


def assert_says(kind, schema, definitions, where):
    """A type has the fields of the schema, neither more nor fewer, with their kinds."""
    allowed, schema = kinds(schema, definitions)
    origin, inner = get_origin(kind), get_args(kind)
    if kind in PLAIN:
        assert PLAIN[kind] in allowed, (where, allowed)
    elif origin is Literal:
        assert sorted(inner) == sorted(part["const"] for part in schema["oneOf"]), where
    elif origin is Union and type(None) in inner and len(inner) == 2:
        assert_says(inner[0], schema, definitions, where)
    elif origin is Union:
        assert where.endswith(".noise"), (where, "only what was given to a study is untyped")
    elif origin is tuple or dataclasses.is_dataclass(kind) and "array" in allowed:
        parts = schema.get("prefixItems") or [schema["items"]]
        types = inner if origin is tuple else list(get_type_hints(kind).values())
        for part, item in zip(types, parts * (len(types) if len(parts) == 1 else 1)):
            if part is not ...:
                assert_says(part, item, definitions, f"{where}[]")
    elif dataclasses.is_dataclass(kind):
        hints = get_type_hints(kind)
        assert set(hints) == set(schema["properties"]) - {"schema_version"}, f"{where}: {kind}"
        for name, hint in hints.items():
            assert_says(hint, schema["properties"][name], definitions, f"{where}.{name}")
    else:
        assert origin is collections.abc.Mapping and allowed == {"object"}, (where, kind)
        assert_says(inner[1], schema["additionalProperties"], definitions, f"{where}[]")


@pytest.mark.parametrize(
    "answer, kind",
    [
        ("sweep", realgap.answer.SweepSummary),
        ("gap", realgap.answer.GapSummary),
        ("ensemble", realgap.answer.EnsembleSummary),
        ("predict", realgap.answer.FinalistCard),
    ],
)
def test_the_types_of_answers_have_the_fields_of_their_schemas(answer, kind):
    whole = schema(f"answers/{answer}")
    assert_says(kind, whole, whole["$defs"], answer)
    if kind is realgap.answer.FinalistCard:
        every = {field.name for field in dataclasses.fields(realgap.answer.Card)}
        assert every == set(whole["required"]) - {"schema_version"}


def test_numbers_that_are_not_finite_become_nan_and_unknown_fields_are_left_out():
    interval = made(realgap.Interval, '{"low": null, "high": 1.5, "middle": 1.0}')
    assert math.isnan(interval.low) and interval.high == 1.5
    assert made(realgap.Interval, "[0.5, 1.5]") == realgap.Interval(0.5, 1.5)
    estimate = made(realgap.answer.Estimate, '{"value": 1.0, "low": null, "high": null}')
    assert estimate.low is None
    with pytest.raises(TypeError, match="high"):
        made(realgap.Interval, '{"low": 0.5}')
    with pytest.raises(dataclasses.FrozenInstanceError):
        interval.low = 0.0
