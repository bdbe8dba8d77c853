"""The notebooks run from their first cell to their last, find what they hide, and are stored with what they show.

    REALGAP_BLESS=1 python -m pytest -c python/pyproject.toml python/tests/test_notebook.py    # writes what they show
"""

import base64
import os
import re
import subprocess
import sys

import pytest

from conftest import PROJECT

NOTEBOOK = PROJECT / "python" / "notebooks" / "own_recordings.ipynb"
# More than this nobody wants to load for a page.
LARGEST_BYTES = 300_000
PICTURE = re.compile(r"data:image/png;base64,([A-Za-z0-9+/=]+)")


@pytest.fixture(scope="module")
def executed(tmp_path_factory):
    nbclient, nbformat = pytest.importorskip("nbclient"), pytest.importorskip("nbformat")
    pytest.importorskip("ipykernel")
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    where = {"metadata": {"path": str(NOTEBOOK.parent)}}
    client = nbclient.NotebookClient(
        notebook, timeout=300, resources=where, record_timing=False, store_widget_state=False
    )
    client.execute()
    if os.environ.get("REALGAP_BLESS") == "1":
        keep(notebook, tmp_path_factory.mktemp("pictures"))
        nbformat.write(notebook, NOTEBOOK)
    return notebook


def keep(notebook, folder):
    """Leaves out what depends on the machine, and makes pictures small."""
    notebook.metadata = {
        "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
        "language_info": {"name": "python"},
    }

    def small(found):
        (folder / "large.png").write_bytes(base64.b64decode(found[1]))
        shrink = [sys.executable, PROJECT / "tools" / "shrink_png.py", "large.png", "small.png"]
        subprocess.run(shrink, check=True, cwd=folder)
        return "data:image/png;base64," + base64.b64encode((folder / "small.png").read_bytes()).decode()

    for output in outputs(notebook):
        if "text/html" in output.get("data", {}):
            output["data"]["text/html"] = PICTURE.sub(small, output["data"]["text/html"])


def outputs(notebook):
    return [output for cell in notebook.cells for output in cell.get("outputs", [])]


def said(notebook):
    """What cells print and what they give, as text."""
    return [output.get("text") or output["data"]["text/plain"] for output in outputs(notebook)]


def test_a_notebook_comes_from_recordings_to_a_verdict(executed):
    assert "inside of the interval: True" in "".join(said(executed))


def test_a_notebook_shows_pictures_and_what_it_shows_is_stored(executed):
    stored = pytest.importorskip("nbformat").read(NOTEBOOK, as_version=4)
    assert said(stored) == said(executed), "REALGAP_BLESS=1 writes what the notebook shows now"
    for notebook in (stored, executed):
        pages = [output.get("data", {}).get("text/html", "") for output in outputs(notebook)]
        assert sum(len(PICTURE.findall(page)) for page in pages) >= 6


def test_a_stored_notebook_is_small_and_knows_nothing_of_the_machine():
    text = NOTEBOOK.read_text()
    assert len(text.encode()) < LARGEST_BYTES
    for word in (str(PROJECT), "/home/", "/root/", "/tmp/", "/work/", "Traceback"):
        assert word not in PICTURE.sub("", text), word
