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
from browser import collect_complaints
from playwright.sync_api import Browser
from small_runs import TINY

from microcosmos.archive.file import load
from microcosmos.client import Client, Replay

GUIDE = Path(__file__).parents[2] / "docs" / "client.md"


def test_a_run_is_driven_by_commands_and_read_by_the_client(
    shared, product_settings, tmp_path, browser
):
    address = shared.product.url
    (tmp_path / "tiny.json").write_text(json.dumps(TINY | {"seed": 77}))
    environment = os.environ | product_settings | {"MICROCOSMOS_URL": address}
    submitted = ("-m", "microcosmos.cli", "submit", "tiny.json", "--watch", "--name", "mine")
    id, *lines = output_of(submitted, tmp_path, environment)
    assert "finished" in lines[-1]
    with Client(address) as client:
        run = client.run(id[:8])
        assert (run.name, run.status, run.generation) == ("mine", "finished", 3)
        pulled = output_of(("-m", "microcosmos.cli", "pull", id), tmp_path, environment)[0]
        compare_with_the_file(run, tmp_path / pulled)
        best = run.archive().best()
        play(best.replay(), browser, tmp_path)
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


def output_of(arguments: tuple[str, ...], folder: Path, environment: dict) -> list[str]:
    command = [sys.executable, *arguments]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
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


def play(replay: Replay, browser: Browser, folder: Path) -> None:
    """As a notebook shows it: in a frame, off the network, moving."""
    (folder / "notebook.html").write_text(f"<!doctype html>{replay._repr_html_()}")
    page, complaints, asked = browser.new_page(), [], []
    collect_complaints(page, complaints)
    page.on("request", lambda request: asked.append(request.url))
    page.goto((folder / "notebook.html").as_uri())
    frame = page.frame_locator("iframe")
    step = frame.locator("#step")
    frame.get_by_role("button", name="Pause").click()
    slider = frame.get_by_role("slider", name="Frame")
    slider.press("Home")
    assert step.inner_text() == "step 0"
    first = picture(frame)
    slider.press("End")
    assert step.inner_text() == f"step {replay.motion.step(replay.motion.frames - 1)}"
    assert picture(frame) != first
    assert complaints == []
    assert {url.partition(":")[0] for url in asked} <= {"file", "about", "data"}
    page.close()


def picture(frame) -> str:
    return frame.locator("canvas").evaluate("canvas => canvas.toDataURL()")
