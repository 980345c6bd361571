"""Examples and notebooks run at a tiny size."""

import importlib.util
import json
import os
import re
import subprocess
import sys
from hashlib import sha256
from pathlib import Path

import h5py
import jax
import nbformat
import numpy as np
import pytest

import microcosmos

EXAMPLES = Path(__file__).parents[2] / "examples"
TINY = {"body": {"nodes": 8}, "task": {"steps": 20, "fitness": "displacement"}}
SEARCH = {"generations": 2, "batch": 4, "block": 4}


@pytest.fixture(autouse=True)
def lenient():
    """QDax relies on rank promotion, which other tests of this process forbid."""
    with jax.numpy_rank_promotion("allow"):
        yield


def example(name, needs="jax"):
    """The module of an example; the test is skipped where its library is missing."""
    if importlib.util.find_spec(needs) is None:
        pytest.skip(f"{needs} is not installed: make peers")
    spec = importlib.util.spec_from_file_location(name, EXAMPLES / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.long
@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("emitter", ["iso+line", "neat"])
def test_their_map_elites_evolves_our_creatures_and_networks(emitter):
    module = example("qdax_map_elites", "qdax")
    repertoire = module.main(emitter, generations=3, batch=4, **TINY)
    assert np.isfinite(repertoire.fitnesses).any()


@pytest.mark.long
@pytest.mark.filterwarnings("ignore")
def test_their_cma_mega_climbs_our_slopes():
    module = example("qdax_map_elites", "qdax")
    longer = {**TINY, "task": {"steps": 100}}
    repertoire = module.main("cma-mega", generations=4, batch=8, **longer)
    assert np.isfinite(repertoire.fitnesses).sum() > 1


@pytest.mark.long
@pytest.mark.filterwarnings("ignore")
def test_their_emitters_work_in_our_search(tmp_path):
    module = example("qdax_emitter", "qdax")
    search = {**module.SPEC["search"], "generations": 3, "batch": 8, "block": 4}
    repertoire = module.main(tmp_path / "archive.h5", **TINY, search=search)
    assert np.isfinite(repertoire.fitnesses).any()


@pytest.mark.long
@pytest.mark.filterwarnings("ignore")
def test_pyribs_draws_our_archive(tmp_path):
    picture = example("ribs_heatmap", "ribs").main(tmp_path, **TINY, search=SEARCH)
    assert picture.read_bytes().startswith(b"\x89PNG")


@pytest.mark.long
@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("emitter", ["cma-mae", "iso+line"])
def test_their_schedulers_evolve_our_creatures(emitter):
    module = example("ribs_scheduler", "ribs")
    spec = microcosmos.parse(module.SPEC | TINY)
    fittest = module.main(emitter, generations=3, batch=4, **TINY)
    assert len(fittest) > 0
    evaluate = microcosmos.ribs_function(spec)
    solutions, objective = fittest.data(["solution", "objective"], return_type="tuple")
    np.testing.assert_array_equal(evaluate(solutions)[0], objective)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.long
def test_a_stiffness_is_recovered_within_a_hundredth_from_how_a_filament_straightens():
    module = example("stiffness")
    assert abs(module.main() / module.TRUE - 1) < 0.01


@pytest.mark.filterwarnings("ignore")
@pytest.mark.long
def test_a_gait_is_designed_for_a_path():
    losses = example("path").main(steps=40, updates=6)
    assert losses[-1] < losses[0]


@pytest.mark.filterwarnings("ignore")
@pytest.mark.long
def test_a_rest_shape_is_designed_for_a_viscosity():
    ((before, after),) = example("rest_shape").main((0.5,), steps=60, updates=2).values()
    assert after > before


@pytest.mark.long
@pytest.mark.filterwarnings("ignore")
def test_a_plugin_task_evolves_and_its_file_names_the_version(tmp_path):
    module = example("plugin_task")
    path = module.main(tmp_path / "plugin.h5", task={"steps": 20}, search=SEARCH)
    source = sha256((EXAMPLES / "plugin_task.py").read_bytes()).hexdigest()
    with h5py.File(path) as file:  # Without the module.
        spec = json.loads(bytes(file.attrs["spec"]))
    for part in (spec["task"], spec["body"], spec["archive"]["descriptors"][0]):
        assert part["plugin"]["source"] == source
    creature = json.loads(path.with_suffix(".best.json").read_bytes())
    assert creature["identity"]["task"]["plugin"]["source"] == source


@pytest.mark.long
@pytest.mark.filterwarnings("ignore")
def test_a_plugin_emitter_evolves_beside_a_built_in_one(tmp_path):
    module = example("plugin_emitter")
    search, task = module.SPEC["search"] | SEARCH, TINY["task"]
    path = module.main(tmp_path / "plugin.h5", task=task, search=search)
    with h5py.File(path) as file:
        names = json.loads(bytes(file.attrs["operators"]))
        made = {names[number] for number in file["lineage/operator"][:].tolist()}
    assert {"plugin_emitter.fifth", "iso+line"} <= made


@pytest.mark.long
def test_the_searches_of_the_library_page_run_and_find_what_they_print(capsys):
    page = (EXAMPLES.parent / "docs" / "library.md").read_text()
    part = page.partition("## Search of your own")[2].partition("\n## ")[0]
    vectors, networks = re.findall(r"```python\n(.*?)```", part, re.DOTALL)
    exec(vectors, {})
    score, coverage, best = map(float, capsys.readouterr().out.split())
    assert score > 90_000
    assert coverage > 0.9
    assert 290 < best <= 300
    exec(networks, {})
    fitness = float(capsys.readouterr().out.split()[0])
    assert 3.5 < fitness <= 4


NOTEBOOKS = sorted((Path(__file__).parents[2] / "examples" / "notebooks").glob("*.ipynb"))

BY_HAND = {"archive", "folding", "swimmer"}
WIDGET = "application/vnd.jupyter.widget-view+json"

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
    shown = {"image/png", "text/html"} if path.stem in BY_HAND else {"image/png", WIDGET}
    assert shown <= kinds


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_is_committed_without_outputs(path):
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert all(cell.outputs == [] and cell.execution_count is None for cell in code)
