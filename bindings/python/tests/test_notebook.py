"""The notebook runs from its first cell to its last."""

from pathlib import Path

import nbclient
import nbformat

NOTEBOOKS = Path(__file__).parent.parent / "notebooks"


def test_notebook_runs_to_its_end(tmp_path):
    files = sorted(NOTEBOOKS.glob("*.ipynb"))
    assert files
    for file in files:
        book = nbformat.read(file, as_version=4)
        nbclient.NotebookClient(book, timeout=300, resources={"metadata": {"path": str(tmp_path)}}).execute()
        pictures = [
            output
            for cell in book.cells
            for output in cell.get("outputs", [])
            if "image/png" in output.get("data", {})
        ]
        assert len(pictures) >= 3, file.name
