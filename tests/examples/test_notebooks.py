"""Each notebook runs from its first cell to its last, at a tiny size, without a warning."""

import os
import subprocess
import sys
from pathlib import Path

import nbformat
import pytest

NOTEBOOKS = sorted((Path(__file__).parents[2] / "examples" / "notebooks").glob("*.ipynb"))

EXECUTE = """
import sys
import nbformat
from nbclient import NotebookClient
notebook = nbformat.read(sys.argv[1], as_version=4)
NotebookClient(notebook, timeout=300).execute()
nbformat.write(notebook, sys.argv[2])
"""
"""In a process of its own: sockets of kernels do not survive those of other tests."""


@pytest.fixture
def tiny(monkeypatch, tmp_path_factory):
    """The kernel's environment: small sizes, and programs shared with other tests."""
    cache = os.environ.get("MICROCOSMOS_TEST_COMPILED") or tmp_path_factory.mktemp("compiled")
    for name, value in {
        "MICROCOSMOS_NOTEBOOK": "tiny",
        "JAX_COMPILATION_CACHE_DIR": str(cache),
        "JAX_PLATFORMS": "cpu",
        "IPYTHONDIR": str(tmp_path_factory.mktemp("ipython")),
    }.items():
        monkeypatch.setenv(name, value)


@pytest.mark.long
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs_to_its_end_without_a_warning(path, tiny, tmp_path):
    command = [sys.executable, "-c", EXECUTE, str(path), "done.ipynb"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-4000:]
    notebook = nbformat.read(tmp_path / "done.ipynb", as_version=4)
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    warned = [o.text for o in outputs if o.output_type == "stream" and o.name == "stderr"]
    assert warned == []
    kinds = {kind for output in outputs for kind in output.get("data", {})}
    assert {"image/png", "text/html"} <= kinds


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_is_kept_without_outputs(path):
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert all(cell.outputs == [] and cell.execution_count is None for cell in code)


def test_there_are_three():
    assert [path.stem for path in NOTEBOOKS] == ["archive", "folding", "swimmer"]
