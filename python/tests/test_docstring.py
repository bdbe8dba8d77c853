"""Every public docstring has an example, and every example gives the output below it."""

import doctest
import inspect

import numpy as np
import pytest

import realgap
from conftest import PROJECT


def public():
    """Classes, their methods and properties, and functions, by the names that people use."""
    for module in (realgap, realgap.answer):
        for name in (*module.__all__, "Warning"):
            thing = getattr(module, name)
            if inspect.isclass(thing):
                yield name, thing
                if getattr(thing, "_is_protocol", False):
                    continue  # Users write its methods; the example of the class shows them.
                for member, value in vars(thing).items():
                    documented = isinstance(value, (property, classmethod, staticmethod))
                    if not member.startswith("_") and (documented or inspect.isfunction(value)):
                        yield f"{name}.{member}", value
            elif inspect.isfunction(thing):
                yield name, thing


NAMED = {**dict(public()), "Trajectory()": realgap.Trajectory.__init__, "answer": realgap.answer}


@pytest.fixture(scope="module")
def cast(tmp_path_factory):
    """The objects of the examples, as the docstring of the package makes them."""
    pytest.importorskip("pandas"), pytest.importorskip("polars")
    names = {"realgap": realgap, "np": np, "folder": tmp_path_factory.mktemp("examples")}
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(PROJECT)
        run(realgap.__doc__, "realgap", names)
        yield names


def run(text, name, names):
    flags = doctest.ELLIPSIS
    example = doctest.DocTestParser().get_doctest(text, {}, name, None, None)
    example.globs = names
    said = []
    doctest.DocTestRunner(optionflags=flags).run(example, out=said.append, clear_globs=False)
    assert not said, "".join(said)


@pytest.mark.parametrize("name", NAMED)
def test_the_example_of_a_docstring_gives_the_output_below_it(name, cast):
    text = inspect.getdoc(NAMED[name])
    assert text, "no docstring"
    assert ">>>" in text, "no example"
    run(text, name, dict(cast))
