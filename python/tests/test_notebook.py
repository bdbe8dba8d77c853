"""The notebooks run from their first cell to their last, and find what they hide."""

from pathlib import Path

import pytest

NOTEBOOKS = Path(__file__).resolve().parents[1] / "notebooks"


@pytest.fixture(scope="module")
def executed():
    nbclient, nbformat = pytest.importorskip("nbclient"), pytest.importorskip("nbformat")
    pytest.importorskip("ipykernel")
    notebook = nbformat.read(NOTEBOOKS / "own_recordings.ipynb", as_version=4)
    assert not any(cell.get("outputs") for cell in notebook.cells), "outputs are not committed"
    where = {"metadata": {"path": str(NOTEBOOKS)}}
    return nbclient.NotebookClient(notebook, timeout=300, resources=where).execute()


def printed(notebook):
    cells = [cell for cell in notebook.cells if cell.cell_type == "code"]
    outputs = [output for cell in cells for output in cell.outputs]
    return "".join(output.get("text", "") for output in outputs)


def test_a_notebook_comes_from_recordings_to_a_verdict(executed):
    assert "inside of the interval: True" in printed(executed)


def test_a_notebook_shows_pictures_and_says_what_is_a_stand_in(executed):
    cells = [cell for cell in executed.cells if cell.cell_type == "code"]
    pages = [
        output["data"].get("text/html", "")
        for cell in cells
        for output in cell.outputs
        if output.output_type == "execute_result"
    ]
    assert sum(page.count("<img") for page in pages) >= 6
