"""The memory of a page that shows a running run for half an hour.

Once a minute everything that the page does not need any more is collected; what is left, and
how many nodes its document has, is noted. The first third is for warming up. In the last
third the median may be larger than in the second by 5 % or 1 MB of memory, whichever is more,
and by 5 % or 50 nodes: what a run adds to its curves meanwhile is far less than that.
"""

import os
import random
import statistics
import time
from collections.abc import Sequence

import rich
from browser import launched
from drive import Installation
from playwright.sync_api import Page
from rich.table import Table

SAMPLES = 30
MINUTES = float(os.environ.get("MINUTES", "30"))
SHARE = 0.05
MORE = {"heap": 1.0, "nodes": 50}
"""Growth that the last third may always show: megabytes and number."""
HOVER_MS = 2000
PARTS = {
    "usedSize": "objects of scripts",
    "backingStorageSize": "arrays behind them, as of replays",
    "embedderHeapUsedSize": "the document's own",
}
MOVE = """
(query) => {
  history.pushState(null, "", location.pathname + query);
  dispatchEvent(new PopStateEvent("popstate"));
}
"""
SPEC = {
    "experiment": "quality-diversity",
    "seed": 7,
    "world": {"width": 64, "height": 64},
    "task": {"steps": 400},
    "archive": {
        "descriptors": [
            {"name": name, "low": 1e-4, "high": 100.0, "bins": 32, "scale": "log10"}
            for name in ("bending_effort", "stretching_effort")
        ]
    },
    "search": {"generations": 100_000, "batch": 64, "block": 16},
}
"""A generation takes a second or so, as those of real runs do; it is cancelled at the end."""


def leave_open(product: Installation) -> bool:
    """Tell whether the page uses no more memory at the end than in the middle."""
    run = product.submit(SPEC)
    product.reach(run, 2, seconds=300)
    with launched() as browser:
        page = browser.new_page(viewport={"width": 1280, "height": 900})
        page.add_init_script("localStorage.setItem('microcosmos:tour-taken', '1')")
        page.goto(f"{product.url}/runs/{run}")
        page.evaluate("window.neverReloaded = true")
        samples = measured(page, product, run)
        assert page.evaluate("window.neverReloaded")
    product.ask(run, "cancel")
    return judged(samples)


def measured(page: Page, product: Installation, run: str) -> list[dict[str, float]]:
    """Measure the page at equal intervals, using it in between."""
    session = page.context.new_cdp_session(page)
    session.send("HeapProfiler.enable")
    began, found = time.monotonic(), []
    for k in range(SAMPLES):
        until = began + 60 * MINUTES * (k + 1) / SAMPLES
        for query in ("?view=gallery", "?"):
            page.evaluate(MOVE, query)
            page.wait_for_timeout(HOVER_MS)
        while time.monotonic() < until:
            hover_somewhere(page)
        session.send("HeapProfiler.collectGarbage")
        usage = session.send("Runtime.getHeapUsage")
        parts = {title: usage.get(part, 0.0) / 1e6 for part, title in PARTS.items()}
        sample = {
            "minutes": (time.monotonic() - began) / 60,
            "generation": product.read(run)["generation"],
            "heap": sum(parts.values()),
            **parts,
            "nodes": session.send("Memory.getDOMCounters")["nodes"],
        }
        found.append(sample)
    return found


def hover_somewhere(page: Page) -> None:
    """Point at a cell of the map, long enough to see its creature swim."""
    box = page.get_by_role("application").first.bounding_box()
    assert box
    x, y = random.random(), random.random()
    page.mouse.move(box["x"] + x * box["width"], box["y"] + y * box["height"], steps=5)
    page.wait_for_timeout(HOVER_MS)


def judged(samples: Sequence[dict[str, float]]) -> bool:
    """Print medians of each third; tell whether the last is no larger than the second."""
    size, good = len(samples) // 3, True
    columns = ("first third", "second", "last", "bar for the last", "")
    table = Table("median", *columns, title="Left open; memory in MB")
    for name in samples[0]:
        values = [one[name] for one in samples]
        thirds = [statistics.median(values[k * size : (k + 1) * size]) for k in range(3)]
        cells = [f"{third:.2f}" for third in thirds]
        if name in MORE:
            bar = thirds[1] + max(SHARE * thirds[1], MORE[name])
            good &= thirds[2] <= bar
            cells += [f"{bar:.2f}", "holds" if thirds[2] <= bar else "FAILS"]
        table.add_row(name, *cells)
    rich.print(table)
    return good
