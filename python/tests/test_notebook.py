"""The notebook runs, and shows its picture."""

from __future__ import annotations

from pathlib import Path

import nbformat
from nbclient import NotebookClient


def test_the_notebook_runs_and_shows_the_verdict_with_a_picture():
    path = Path(__file__).parents[1] / "examples" / "slope.ipynb"
    notebook = nbformat.read(path, as_version=4)
    place = {"metadata": {"path": str(path.parent)}}
    NotebookClient(notebook, timeout=300, kernel_name="python3", resources=place).execute()
    shown = [
        output["data"]["text/html"]
        for cell in notebook.cells
        if cell.cell_type == "code"
        for output in cell.outputs
        if "text/html" in output.get("data", {})
    ]
    assert sum("<svg" in text for text in shown) == 2  # comparison and diagnosis
    assert any("slope" in text and "<svg" in text for text in shown)
