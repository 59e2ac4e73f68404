"""Notebooks under reports/notebooks: stored without what they print. `.ci/run` executes them."""

import json
from pathlib import Path

import pytest

FOLDER = Path(__file__).parents[2] / "reports" / "notebooks"
PATHS = sorted(FOLDER.glob("*.ipynb"))


def printed(notebook):
    """Ids of the cells that hold a result or a count of a run."""
    cells = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
    return [cell["id"] for cell in cells if cell["outputs"] or cell["execution_count"] is not None]


def test_there_are_notebooks():
    assert len(PATHS) >= 2


@pytest.mark.parametrize("path", PATHS, ids=lambda path: path.stem)
def test_a_notebook_is_short_checks_its_numbers_and_holds_no_results(path):
    notebook = json.loads(path.read_text(encoding="utf-8"))
    assert len(notebook["cells"]) <= 12
    assert any("assert " in line for cell in notebook["cells"] for line in cell["source"])
    assert printed(notebook) == []
    # Control: one result is seen.
    code = next(cell for cell in notebook["cells"] if cell["cell_type"] == "code")
    code["outputs"].append({"output_type": "stream", "name": "stdout", "text": ["1"]})
    assert printed(notebook) == [code["id"]]
