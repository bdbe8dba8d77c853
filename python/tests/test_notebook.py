"""The notebooks run from the first to the last cell, find their hidden values, and are committed with their current output."""

import os
from pathlib import Path

import pytest

NOTEBOOKS = Path(__file__).resolve().parents[1] / "notebooks"
NOTEBOOK = NOTEBOOKS / "own_recordings.ipynb"


def said(notebook):
    """The output of every cell of code, without pictures."""
    cells = [cell for cell in notebook.cells if cell.cell_type == "code"]
    return [
        [output.get("text") or output["data"].get("text/plain") for output in cell.outputs]
        for cell in cells
    ]


def pictures(notebook):
    cells = [cell for cell in notebook.cells if cell.cell_type == "code"]
    outputs = [output.get("data", {}) for cell in cells for output in cell.outputs]
    return sum(data.get("text/html", "").count("<img") for data in outputs)


@pytest.fixture(scope="module")
def stored_and_executed():
    nbclient, nbformat = pytest.importorskip("nbclient"), pytest.importorskip("nbformat")
    pytest.importorskip("ipykernel")
    stored = nbformat.read(NOTEBOOK, as_version=4)
    where = {"metadata": {"path": str(NOTEBOOKS)}}
    again = nbformat.read(NOTEBOOK, as_version=4)
    client = nbclient.NotebookClient(again, timeout=300, resources=where, record_timing=False)
    executed = client.execute()
    if os.environ.get("REALGAP_BLESS"):
        nbformat.write(executed, NOTEBOOK)
        stored = executed
    return stored, executed


def test_the_notebook_leads_from_recordings_to_a_verdict(stored_and_executed):
    everything = "".join(text for cell in said(stored_and_executed[1]) for text in cell)
    assert "inside of the interval: True" in everything


def test_the_notebook_is_committed_with_its_current_output(stored_and_executed):
    stored, executed = stored_and_executed
    assert said(stored) == said(executed), "REALGAP_BLESS=1 writes the outputs of today into it"
    assert pictures(stored) == pictures(executed) >= 6
