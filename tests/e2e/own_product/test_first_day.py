"""A researcher's first day, from installing to deleting, as a script.

The client and its commands are those of the wheel, installed into a folder of its own and
run from another one; servers, workers, and the browser are real.
"""

import json
import os
import sqlite3
import subprocess
import sys
from collections.abc import Mapping
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
from drive import ROOT, Installation, running, wait_until
from playwright.sync_api import Page, expect
from small_runs import TINY

from microcosmos.client import Client, Run
from server.storage.mark import MARK

SEEDS, MORE = 3, 2
GENERATIONS = TINY["search"]["generations"]


class Laptop:
    """An empty folder, and the command that was installed from the wheel."""

    def __init__(self, folder: Path, environment: Mapping[str, str]):
        self.folder = folder
        self.environment = {**os.environ, **environment}

    def run(self, *arguments: str) -> str:
        """Run a command, which must succeed, and return its output."""
        done = subprocess.run(
            [sys.executable, "-P", "-m", "microcosmos.cli", *arguments],
            cwd=self.folder,
            env=self.environment,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=180,
        )
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout


@pytest.fixture
def laptop(tmp_path, product):
    """The wheel, built and installed as `pip install` does, without what it depends on."""
    folder, packages = tmp_path / "laptop", tmp_path / "packages"
    folder.mkdir()
    options = ["-q", "--disable-pip-version-check", "--no-deps", "--no-build-isolation"]
    subprocess.run(
        [sys.executable, "-m", "pip", "install", *options, "--target", packages, ROOT],
        check=True,
        timeout=120,
    )
    ours = {"PYTHONPATH": str(packages), "MICROCOSMOS_URL": product.url}
    return Laptop(folder, product.environment | ours)


@pytest.fixture
def elsewhere(product_settings, tmp_path):
    with (
        running(tmp_path / "elsewhere", product_settings | {"WORKERS": "0"}) as product,
        Client(product.url) as client,
    ):
        yield client


def test_a_first_day(laptop, product, elsewhere, anonymous_page):
    client = Client(product.url)
    first, *others = sweep(client, laptop)
    extend(laptop, first)
    fork = swim_in_another_viscosity(client, first)
    best = fork.archive().best()
    share = best.share(title="A first swimmer", credit="A. Founder", days=1)
    open_anonymously(anonymous_page, share.url, best.sha)
    import_elsewhere(laptop, elsewhere, client, best.sha)
    draw_the_contact_sheet(laptop, fork)
    kept = {run.id: product.archive(run.id) for run in (fork, *others)}
    delete_for_good(client, laptop, product, first)
    assert {run.id: product.archive(run.id) for run in (fork, *others)} == kept
    find_the_ancestors(client, best.sha)
    find_nothing_left_behind(product, first)
    client.close()


def sweep(client: Client, laptop: Laptop) -> list[Run]:
    """Three seeds in one request, watched from a terminal to their end."""
    made = client.submit(TINY, seeds=SEEDS, name="first day")
    laptop.run("watch", made.id)
    assert made.refresh().status_counts == {"finished": SEEDS}
    (case,) = made.summary().cases
    assert case["generation"][-1] == GENERATIONS
    assert case["runs"][-1] == SEEDS
    return list(made.runs())


def extend(laptop: Laptop, run: Run) -> None:
    """A run that is extended has the bytes of one that was longer from the start."""
    laptop.run("extend", run.id, str(MORE))
    laptop.run("watch", run.id)
    assert run.refresh().generation == GENERATIONS + MORE
    longer = {**run.spec, "search": {**run.spec["search"], "generations": GENERATIONS + MORE}}
    (laptop.folder / "longer.json").write_text(json.dumps(longer))
    laptop.run("evolve", "longer.json")
    pulled = run.pull(laptop.folder / "pulled.h5", quiet=True)
    assert pulled.read_bytes() == (laptop.folder / "longer.h5").read_bytes()


def swim_in_another_viscosity(client: Client, run: Run) -> Run:
    """Fork the best elite; the archive of the fork names it as an ancestor."""
    best = run.archive().best()
    viscosity = 2 * run.spec["world"]["viscosity"]
    fork = run.fork(creatures=[best], spec={"world": {"viscosity": viscosity}}, name="honey")
    assert fork.wait(300) == "finished"
    assert fork.spec["world"]["viscosity"] == viscosity
    assert client.run(fork.id).record["forked_from"]["run"] == run.id
    return fork


def open_anonymously(page: Page, link: str, sha: str) -> None:
    """The link shows the creature to a browser without any cookie."""
    page.goto(link)
    expect(page.get_by_role("heading", name="A first swimmer")).to_be_visible()
    expect(page.get_by_text("A. Founder").first).to_be_visible()
    expect(page.locator("canvas").first).to_be_visible(timeout=120_000)
    assert page.locator('meta[property="og:image"]').get_attribute("content")
    assert sha[:8] in page.content()


def import_elsewhere(laptop: Laptop, elsewhere: Client, client: Client, sha: str) -> None:
    """The file brings its name and its ancestors to another server."""
    whole = client.connection.read(f"creatures/{sha}", ancestors=True)
    assert whole["ancestors"]
    (laptop.folder / "swimmer.json").write_text(json.dumps(whole))
    laptop.run("import", "swimmer.json", "--url", elsewhere.url)
    there = elsewhere.creature(sha)
    assert there.identity == client.creature(sha).identity
    kept = {one["creature"] for one in there.ancestors(32)["items"] if one["stored"]}
    assert {one["sha256"] for one in whole["ancestors"]} <= kept


def draw_the_contact_sheet(laptop: Laptop, run: Run) -> None:
    laptop.run("pull", run.id, "--out", "honey.h5")
    laptop.run("figure", "sheet", "honey.h5", "sheet.pdf", "--columns", "2", "--rows", "1")
    assert (laptop.folder / "sheet.pdf").read_bytes().startswith(b"%PDF")
    caption = (laptop.folder / "sheet.caption.txt").read_text()
    assert f"{run.spec['world']['viscosity']:g}" in caption


def delete_for_good(client: Client, laptop: Laptop, product: Installation, run: Run) -> None:
    """Delete a run, restore it, delete it again, and let its day in the bin pass."""
    laptop.run("delete", run.id, "--yes")
    assert run.id not in {one.id for one in client.runs()}
    laptop.run("restore", run.id)
    assert run.id in {one.id for one in client.runs()}
    run.delete()
    with closing(sqlite3.connect(product.folder / "microcosmos.sqlite")) as database, database:
        database.execute("UPDATE runs SET purge_at = deleted_at WHERE deleted_at IS NOT NULL")
    wait_until(
        lambda: (
            not rows(product, "garbage_creatures")
            and not rows(product, "garbage_files")
            and not any(one.id == run.id for one in client.runs(deleted=True))
        ),
        60,
        "the run is gone",
    )


def find_the_ancestors(client: Client, sha: str) -> None:
    """The ancestors of the fork are still there, although their run is not."""
    kept = [one for one in client.creature(sha).ancestors(32)["items"] if one["stored"]]
    assert kept
    for one in kept:
        assert client.creature(one["creature"]).identity


def find_nothing_left_behind(product: Installation, run: Run) -> None:
    """No row of the run, no file without a row, and no creature that nobody knows."""
    tables = "generations elites results artifacts log_entries initial_creatures"
    for table in tables.split():
        assert not rows(product, f"{table} WHERE run_id = ?", run.id.replace("-", "")), table
    folder = product.folder / "artifacts"
    files = {str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()}
    assert files - {MARK} == {row[0] for row in rows(product, "artifacts", column="path")}
    used = "SELECT creature FROM elites UNION SELECT creature FROM initial_creatures "
    used += "UNION SELECT parent FROM parents"
    assert not rows(product, f"creatures WHERE sha256 NOT IN ({used})")


def rows(product: Installation, which: str, *values: Any, column: str = "*") -> list[Any]:
    with closing(sqlite3.connect(product.folder / "microcosmos.sqlite")) as database:
        return database.execute(f"SELECT {column} FROM {which}", values).fetchall()
