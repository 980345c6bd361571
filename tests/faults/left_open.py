"""A page that is left open on a running run for half an hour, looked at all the while.

Once a minute everything that the page does not need any more is collected; what is left, and
how many nodes its document has, is noted. The first third is for warming up. In the last
third the median may be larger than in the second by 5 % or 1 MB of memory, whichever is more,
and by 5 % or 50 nodes: what a run adds to its curves meanwhile is far less than that.
"""

import random
import statistics
import time
from collections.abc import Sequence
from typing import NamedTuple

from browser import launched
from drive import Installation
from playwright.sync_api import CDPSession, Page
from rich.console import Console
from rich.table import Table

SAMPLES = 30
SHARE, BYTES, NODES = 0.05, 1_000_000, 50
HOVER_S = 2.0
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
    "task": {"steps": 300},
    "archive": {
        "descriptors": [
            {"name": name, "low": 1e-4, "high": 100.0, "bins": 32, "scale": "log10"}
            for name in ("bending_effort", "stretching_effort")
        ]
    },
    "search": {"generations": 100_000, "batch": 64, "block": 16},
}
"""A generation takes a second or so, as those of real runs do; it is cancelled at the end."""


class Sample(NamedTuple):
    seconds: float
    parts: Sequence[float]
    """Bytes of each of `PARTS`."""
    nodes: int
    generation: int


def leave_open(place: Installation, console: Console, minutes: float) -> bool:
    """Tell whether the page uses no more memory at the end than in the middle."""
    run = place.submit(SPEC)
    place.reach(run, 2, seconds=300)
    with launched() as browser:
        page = browser.new_page(viewport={"width": 1280, "height": 900})
        page.add_init_script("localStorage.setItem('microcosmos:tour-taken', '1')")
        page.goto(f"{place.url}/runs/{run}")
        page.evaluate("window.neverReloaded = true")
        samples = watched(page, place, run, 60 * minutes)
        assert page.evaluate("window.neverReloaded")
    place.ask(run, "cancel")
    return judged(samples, console)


def watched(page: Page, place: Installation, run: str, seconds: float) -> list[Sample]:
    """Take samples at even distances, using the page in between."""
    session = page.context.new_cdp_session(page)
    session.send("HeapProfiler.enable")
    began, found = time.monotonic(), []
    for k in range(SAMPLES):
        until = began + seconds * (k + 1) / SAMPLES
        look_at_gallery(page)
        while time.monotonic() < until:
            hover_somewhere(page)
        generation = place.read(run)["generation"]
        found.append(sample(session, time.monotonic() - began, generation))
    return found


def look_at_gallery(page: Page) -> None:
    for query in ("?view=gallery", "?"):
        page.evaluate(MOVE, query)
        page.wait_for_timeout(1000 * HOVER_S)


def hover_somewhere(page: Page) -> None:
    """Point at a cell of the map, long enough to see its creature swim."""
    box = page.get_by_role("application").first.bounding_box()
    assert box
    x, y = random.random(), random.random()
    page.mouse.move(box["x"] + x * box["width"], box["y"] + y * box["height"], steps=5)
    page.wait_for_timeout(1000 * HOVER_S)


def sample(session: CDPSession, seconds: float, generation: int) -> Sample:
    session.send("HeapProfiler.collectGarbage")
    usage = session.send("Runtime.getHeapUsage")
    parts = [usage.get(part, 0.0) for part in PARTS]
    nodes = session.send("Memory.getDOMCounters")["nodes"]
    return Sample(seconds, parts, nodes, generation)


def judged(samples: Sequence[Sample], console: Console) -> bool:
    """Print the thirds of the samples, and whether the last is no more than the second."""
    size = len(samples) // 3
    thirds = [samples[i * size : (i + 1) * size] for i in range(3)]
    table = Table(
        "", "first third", "second", "last", "bar for the last", "", title="Left open"
    )
    heaps = [statistics.median(sum(one.parts) for one in third) for third in thirds]
    nodes = [statistics.median(one.nodes for one in third) for third in thirds]
    most_heap = heaps[1] + max(SHARE * heaps[1], BYTES)
    most_nodes = nodes[1] + max(SHARE * nodes[1], NODES)
    good = heaps[2] <= most_heap, nodes[2] <= most_nodes
    verdicts = ["holds" if one else "FAILS" for one in good]
    table.add_row("minutes", *(f"to {third[-1].seconds / 60:.1f}" for third in thirds), "", "")
    table.add_row("generation", *(f"to {third[-1].generation}" for third in thirds), "", "")
    table.add_row("heap, MB", *(f"{one / 1e6:.2f}" for one in (*heaps, most_heap)), verdicts[0])
    for i, part in enumerate(PARTS.values()):
        medians = (statistics.median(one.parts[i] for one in third) for third in thirds)
        table.add_row(f"  {part}", *(f"{one / 1e6:.2f}" for one in medians), "", "")
    table.add_row("nodes", *(f"{one:.0f}" for one in (*nodes, most_nodes)), verdicts[1])
    console.print(table)
    return all(good)
