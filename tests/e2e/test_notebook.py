"""A notebook in JupyterLab: its widgets show, hover, select and play."""

import os
import re
import secrets
import socket
import subprocess
import sys
import time
from importlib.util import find_spec

import httpx
import nbformat
import pytest
from drive import ROOT
from playwright.sync_api import Locator, Page, expect

NOTEBOOK = ROOT / "examples" / "notebooks" / "publish.ipynb"
START_S = 60
RUN_MS = 240_000


@pytest.fixture
def lab(tmp_path):
    """The address of a notebook in a JupyterLab of its own, with a token."""
    if find_spec("jupyterlab") is None:
        pytest.skip("jupyterlab is not installed: make lab")
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    notebook.cells.append(nbformat.v4.new_code_cell('print("chosen", *shown.creatures)'))
    (tmp_path / "work").mkdir()
    nbformat.write(notebook, tmp_path / "work" / "study.ipynb")
    token, port = secrets.token_hex(16), free_port()
    folders = {
        f"JUPYTER_{name}_DIR": str(tmp_path / name) for name in ("CONFIG", "DATA", "RUNTIME")
    }
    environment = (
        os.environ | folders | {"MICROCOSMOS_NOTEBOOK": "tiny", "JAX_PLATFORMS": "cpu"}
    )
    environment |= {"IPYTHONDIR": str(tmp_path / "ipython"), "JUPYTER_TOKEN": token}
    command = [sys.executable, "-m", "jupyterlab", "--no-browser", "--ip=127.0.0.1"]
    command += [f"--port={port}", "--ServerApp.port_retries=0", "--allow-root"]
    command += [f"--ServerApp.root_dir={tmp_path / 'work'}", "--LabApp.news_url="]
    with (tmp_path / "log").open("wb") as log:
        process = subprocess.Popen(command, env=environment, stdout=log, stderr=log)
        try:
            address = f"http://127.0.0.1:{port}"
            wait_for(f"{address}/api/status?token={token}", process)
            yield f"{address}/lab/tree/study.ipynb?token={token}"
        finally:
            process.terminate()
            process.wait(30)


def free_port() -> int:
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


def wait_for(url: str, process: subprocess.Popen) -> None:
    deadline = time.monotonic() + START_S
    while time.monotonic() < deadline and process.poll() is None:
        try:
            if httpx.get(url).is_success:
                return
        except httpx.TransportError:
            time.sleep(0.2)
    pytest.fail(f"JupyterLab does not answer; its status is {process.poll()}")


def changes(part: Locator) -> bool:
    """Tell whether the pixels of an element change within a few seconds."""
    first = part.screenshot()
    return any(part.screenshot() != first for _ in range(20))


def hover_a_creature(page: Page, plot: Locator) -> None:
    """Move the pointer over the map until a creature is shown beside its cell."""
    plot.scroll_into_view_if_needed()
    box = plot.bounding_box()
    assert box
    for bin in range(12 * 12):
        x, y = (bin // 12 + 0.5) / 12, (bin % 12 + 0.5) / 12
        page.mouse.move(box["x"] + x * box["width"], box["y"] + y * box["height"])
        if plot.locator("[data-inset] canvas").count():
            return
    pytest.fail("no cell of the map shows a creature")


CHOSEN = re.compile("^chosen")


@pytest.mark.long
def test_widgets_in_jupyterlab_show_hover_play_and_tell_python_what_is_selected(lab, new_page):
    page = new_page()
    page.goto(lab)
    page.locator(".jp-Notebook .jp-Cell").first.wait_for()
    expect(page.get_by_role("button", name="Python 3 (ipykernel) | Idle")).to_be_visible()
    page.get_by_role("menuitem", name="Run", exact=True).click()
    page.get_by_role("menuitem", name="Run All Cells", exact=True).click()
    about = page.locator(".microcosmos .about").first
    expect(about).to_contain_text("generation 3 · 1 cell selected", timeout=RUN_MS)
    output = page.locator(".jp-OutputArea-output", has_text=CHOSEN)
    expect(output).to_have_text(re.compile("chosen [0-9a-f]{64}"), timeout=RUN_MS)
    fittest = output.inner_text()

    player = page.locator(".microcosmos .player")
    stage = player.locator(".stage")
    stage.scroll_into_view_if_needed()
    assert changes(stage)
    player.get_by_role("button", name="Pause").click()
    assert not changes(stage)

    plot = page.locator(".microcosmos .map-plot").first
    hover_a_creature(page, plot)
    expect(page.locator(".microcosmos .elite-measures").first).to_contain_text(
        re.compile(r"Fitness \S+.*Symmetry \S+.*Mean curvature \S+.*Generation \d")
    )
    assert changes(plot.locator("[data-inset] canvas"))
    page.mouse.down()
    page.mouse.up()
    last = page.locator(".jp-Notebook .jp-CodeCell").last
    last.locator(".cm-content").click()
    page.keyboard.press("Control+Enter")
    expect(output).not_to_have_text(fittest)
    expect(output).to_contain_text(CHOSEN)
