"""The client and the commands over the whole product; its creatures play and check."""

import csv
import io
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
from small_runs import TINY

from microcosmos.archive.file import load
from microcosmos.client import Client

GUIDE = Path(__file__).parents[2] / "docs" / "client.md"


def test_a_run_is_driven_by_commands_and_read_by_the_client(shared, product_settings, tmp_path):
    address = shared.product.url
    (tmp_path / "tiny.json").write_text(json.dumps(TINY | {"seed": 77}))
    environment = os.environ | product_settings | {"MICROCOSMOS_URL": address}
    submitted = ("-m", "microcosmos", "submit", "tiny.json", "--watch", "--name", "mine")
    (id,) = output_of(submitted, tmp_path, environment, said := [])
    assert "finished" in said[-1], "progress goes to standard error"
    with Client(address) as client:
        run = client.run(id[:8])
        assert (run.name, run.status, run.generation) == ("mine", "finished", 3)
        pulled = output_of(("-m", "microcosmos", "pull", id), tmp_path, environment)[0]
        compare_with_the_file(run, tmp_path / pulled)
        best = run.archive().best()
        assert best.poses().creature == best.sha
        assert best.save(tmp_path / "best.csv").read_text().startswith("step,node,x,y\n")


def test_the_example_in_the_client_guide_works(shared, product_settings, tmp_path):
    examples = re.findall(r"```python\n(.*?)```", GUIDE.read_text(), re.DOTALL)
    (example,) = (text for text in examples if "mc.Client" in text)
    spec = '{"experiment": "quality-diversity", "search": {"generations": 10}}'
    for written, small in ((spec, repr(TINY)), ("http://127.0.0.1:8000", shared.product.url)):
        assert written in example
        example = example.replace(written, small)
    *_, last = output_of(("-c", example), tmp_path, os.environ | product_settings)
    assert last.endswith("True")
    assert (tmp_path / "first.h5").exists()


def output_of(
    arguments: tuple[str, ...], folder: Path, environment: dict, said: list[str] | None = None
) -> list[str]:
    command = [sys.executable, *arguments]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    if said is not None:
        said += done.stderr.splitlines()
    return done.stdout.splitlines()


def compare_with_the_file(run, pulled: Path) -> None:
    tree, _ = load(pulled.read_bytes())
    archive, lineage = run.archive(), run.lineage()
    np.testing.assert_array_equal(archive.fitness, tree["archive"]["fitness"])
    np.testing.assert_array_equal(archive.cell, tree["archive"]["cell"])
    assert set(archive.creature) <= set(lineage["creature"])
    assert len(lineage["parents"]) == len(tree["lineage"]["creature"])
    np.testing.assert_array_equal(run.curves()["qd_score"], tree["curves"]["qd_score"])
    text = run._connection.ask("GET", f"runs/{run.id}/archive.csv").text
    table = list(csv.DictReader(io.StringIO(text)))
    columns = archive.columns()
    assert list(columns) == [name for name in table[0] if not name.startswith("solution_")]
    for name, values in columns.items():
        written = [row[name] for row in table]
        if name == "creature":
            assert list(values) == written
        else:
            np.testing.assert_allclose(values, np.array(written, np.float32), rtol=1e-6)
