"""The speed of the page in Chromium on two cores; prints a table and asserts nothing.

A small search finds creatures, which fill archives of 10,000 and 65,536 cells. The page reports
times: the mark `map` after the archive is drawn, the measure `map-draw` around each
drawing, the mark `inset` at the first frame of a hovered creature.
"""

import gzip
import os
import statistics
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "faults"))

from births import body_of, drag, serve_bodies, write_births
from browser import launched
from drive import ROOT, Installation, running
from large import creatures_of, write_run
from measuring import BLOCKS, FRAMES, NOTES, work_of_frames
from playwright.sync_api import Browser, Page, ViewportSize
from playwright.sync_api import TimeoutError as Late
from rich.console import Console
from rich.table import Table

from microcosmos_server.services.services import connect
from microcosmos_server.settings import Settings

CORES = 2
SETTINGS = {"MICROCOSMOS_DEMONSTRATION": "false"}
WINDOW: ViewportSize = {"width": 1280, "height": 900}
WALL: ViewportSize = {"width": 1600, "height": 1600}
PHONE: ViewportSize = {"width": 390, "height": 844}
SECONDS = 5
"""In which frames are counted."""
TRAILS_MS = 3000
"""Time until the trails of the tank have grown."""
SCROLLED_MS = 300
"""Time until a part of the page that has become visible is loaded."""
TIMES = 5
REDRAWS = 60
HOVERS = 30
TILE = 36
"""Side of a tile in pixels."""
PATIENCE_MS = 120_000
"""How long a slow machine may take for a step."""
CREATURES, BIRTHS, GENERATIONS = 400, 100_000, 150
MEDIUM, LARGE = 100, 256
"""Cells along each side of the two large archives."""


def main() -> None:
    os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[:CORES])
    with (
        tempfile.TemporaryDirectory() as folder,
        running(Path(folder) / "data", SETTINGS) as product,
    ):
        runs = prepare(product)
        with launched() as browser:
            Console(width=110).print(table(browser, product, runs))


def prepare(product: Installation) -> tuple[str, str, str, str]:
    """Carry out a search, and fill archives with what it found."""
    found = searched(product)
    services = connect(Settings(data=product.folder))
    creatures = creatures_of(services, found)[:CREATURES]
    side = round(CREATURES**0.5)
    runs = (
        write_run(services, found, MEDIUM, MEDIUM**2, creatures),
        write_run(services, found, LARGE, LARGE**2, creatures),
        write_run(services, found, side, side**2, creatures),
        write_births(services, found, BIRTHS),
    )
    services.close()
    return runs


def searched(product: Installation) -> str:
    """A run of the demonstration, long enough for as many creatures."""
    experiments = product.http.get("/api/v1/experiments").raise_for_status().json()
    search = next(one for one in experiments if one["experiment"] == "quality-diversity")
    spec = search["presets"][0]["spec"]
    spec["search"]["generations"] = GENERATIONS
    run = product.submit(spec)
    product.wait(run, "finished", seconds=600)
    return run


def table(browser: Browser, product: Installation, runs: tuple[str, str, str, str]) -> Table:
    first, largest, square, births = (f"{product.url}/runs/{run}" for run in runs)
    wall = f"{square}?view=gallery&tile={TILE}"
    body = body_of(product, runs[2])
    measures: list[tuple[str, str, Callable[[], str]]] = [
        (
            f"first paint of a run with {MEDIUM**2:,} cells",
            "≤ 1 s",
            lambda: paint(browser, first),
        ),
        (f"redraw of {LARGE**2:,} cells", "≤ 16 ms", lambda: redraw(browser, largest)),
        ("pointing at them, one after another", "", lambda: sweep(browser, largest)),
        ("playing their history", "", lambda: play(browser, largest)),
        ("pointer on a cell to its first frame", "≤ 50 ms", lambda: hover(browser, square)),
        (f"gallery of {CREATURES}, all moving", "≤ 1.5 s", lambda: gallery(browser, wall)),
        ("first moving creature of the tank", "≤ 1.5 s", lambda: tank(browser, product.url)),
        ("tank, of each frame", "≤ 12 ms", lambda: frames(browser, product.url, WINDOW, 1)),
        (
            "the same on a phone, 4 times slower",
            "≤ 12 ms",
            lambda: frames(browser, product.url, PHONE, 4),
        ),
        (f"tree of {BIRTHS:,} births, drawn", "", lambda: grow(browser, births)),
        (
            "frames while it is dragged, at three zooms",
            "≤ 12 ms",
            lambda: pan(browser, births, body),
        ),
        (
            "script of a page, gzipped",
            "≤ 110 kB, runs 70",
            lambda: script(browser, product, runs[2]),
        ),
    ]
    rows = Table("", "bar", "found", title=f"The page in Chromium on {CORES} cores")
    for name, bar, measure in measures:
        rows.add_row(name, bar, measured(measure))
    return rows


def measured(measure: Callable[[], str]) -> str:
    """The result of a measurement, or the part of the page that is missing."""
    try:
        return measure()
    except Late as error:
        print(error.message, file=sys.stderr)
        return f"not there: {error.message.splitlines()[0]}"


@contextmanager
def opened(browser: Browser, url: str, window: ViewportSize = WINDOW) -> Iterator[Page]:
    """Open a page in a new context, in which nothing is cached."""
    with browser.new_context(viewport=window) as context:
        page = context.new_page()
        page.add_init_script(NOTES)
        page.set_default_timeout(PATIENCE_MS)
        page.goto(url)
        yield page


def until_noted(page: Page, name: str, after: float = 0.0) -> float:
    """The time of the first mark of a name after another time."""
    script = (
        "([name, after]) => window.noted.find((n) => n.name === name && n.startTime > after)"
    )
    return page.wait_for_function(script, arg=[name, after]).json_value()["startTime"]


def until_elites(page: Page, count: int) -> None:
    page.get_by_text(f"{count:,} elites").first.wait_for()


def paint(browser: Browser, url: str) -> str:
    """Time from the navigation to the drawn map."""
    times = []
    for _ in range(TIMES):
        with opened(browser, url) as page:
            until_elites(page, MEDIUM**2)
            times.append(until_noted(page, "map") / 1000)
    return f"{statistics.median(times):.2f} s, slowest {max(times):.2f} s, of {TIMES}"


def redraw(browser: Browser, url: str) -> str:
    """Time of a drawing, repeated by changes of the theme."""
    with opened(browser, url) as page:
        until_elites(page, LARGE**2)
        until_noted(page, "map")
        page.evaluate("window.noted.length = 0")
        for k in range(REDRAWS):
            before = page.evaluate("performance.now()")
            page.emulate_media(color_scheme=("dark", "light")[k % 2])
            until_noted(page, "map-draw", before)
        drawings = "window.noted.filter((n) => n.name === 'map-draw').map((n) => n.duration)"
        times = page.evaluate(drawings)
    tenth = statistics.quantiles(times, n=10)[-1]
    return f"{statistics.median(times):.1f} ms, one in ten over {tenth:.1f} ms, of {len(times)}"


def sweep(browser: Browser, url: str) -> str:
    """Frames per second while the pointer moves over the largest archive."""
    with opened(browser, url) as page:
        until_elites(page, LARGE**2)
        return f"{page.evaluate(FRAMES, [SECONDS, True]):.0f} frames/s"


def play(browser: Browser, url: str) -> str:
    """Frames per second while the history of the largest archive is played."""
    with opened(browser, url) as page:
        until_elites(page, LARGE**2)
        page.get_by_role("button", name="Play the history").click()
        page.get_by_text(f"{LARGE**2:,} elites").first.wait_for(state="detached")
        return f"{page.evaluate(FRAMES, [SECONDS, False]):.0f} frames/s"


def hover(browser: Browser, url: str) -> str:
    """Time from a pointer event to the first frame of the creature, over several cells."""
    side = round(CREATURES**0.5)
    times = []
    with opened(browser, url) as page:
        until_noted(page, "map")
        box = page.get_by_role("application").first.bounding_box()
        assert box
        for k in range(min(HOVERS, side**2)):
            x, y = ((part + 0.5) / side for part in divmod((7 * k) % side**2, side))
            page.mouse.move(box["x"] + x * box["width"], box["y"] + y * box["height"])
            moved = page.evaluate("window.moved")
            times.append(until_noted(page, "inset", moved) - moved)
            page.wait_for_timeout(200)
    return f"{statistics.median(times):.0f} ms, slowest {max(times):.0f} ms, of {len(times)}"


def gallery(browser: Browser, url: str) -> str:
    """Time from the navigation until all creatures move, and frames per second."""
    side, times = round(CREATURES**0.5), []
    for _ in range(TIMES):
        with opened(browser, url, WALL) as page:
            times.append(until_noted(page, "gallery") / 1000)
            page.locator("[data-gallery] canvas").first.scroll_into_view_if_needed()
            rate = page.evaluate(FRAMES, [SECONDS, False])
            before = page.evaluate(BLOCKS, side)
            page.wait_for_timeout(700)
            after = page.evaluate(BLOCKS, side)
    moving = sum(one != other for one, other in zip(before, after, strict=False))
    slowest = f"{statistics.median(times):.2f} s, slowest {max(times):.2f} s, of {TIMES}"
    return f"{slowest}; {rate:.0f} frames/s, {moving} tiles moving"


def tank(browser: Browser, url: str) -> str:
    """Time from the navigation to the first drawn creatures of the tank."""
    times = []
    for _ in range(TIMES):
        with opened(browser, url) as page:
            times.append(until_noted(page, "tank") / 1000)
    return f"{statistics.median(times):.2f} s, slowest {max(times):.2f} s, of {TIMES}"


def frames(browser: Browser, url: str, window: ViewportSize, slower: int) -> str:
    """Time of the page's main thread for each frame of the tank."""
    with opened(browser, url, window) as page:
        until_noted(page, "tank")
        page.wait_for_timeout(TRAILS_MS)
        count = page.get_by_role("application").first.get_attribute("aria-label") or ""
        spent, rate = work_of_frames(page, SECONDS, slower)
    return f"{spent:.1f} ms at {rate:.0f} frames/s; {' '.join(count.split()[2:5])}"


def grow(browser: Browser, births: str) -> str:
    """Time from the navigation to the drawn tree, once the server has it."""
    times = []
    for _ in range(TIMES):
        with opened(browser, f"{births}/tree") as page:
            times.append(until_noted(page, "tree") / 1000)
    return f"{statistics.median(times[1:]):.2f} s, the first time {times[0]:.2f} s"


def pan(browser: Browser, births: str, stream: bytes) -> str:
    """Work in the frames of a drag, with bodies."""
    with opened(browser, births) as page:
        serve_bodies(page, stream)
        page.goto(f"{births}/tree")
        until_noted(page, "tree")
        return drag(page)


def script(browser: Browser, product: Installation, run: str) -> str:
    """Size of the scripts that each page loads, gzipped."""
    files = (ROOT / "web" / "dist").rglob("*.js")
    sizes = {file.name: len(gzip.compress(file.read_bytes())) / 1000 for file in files}
    archive = product.http.get(f"/api/v1/runs/{run}/archive").raise_for_status().json()
    paths = {
        "a run": f"/runs/{run}",
        "a tree": f"/runs/{run}/tree",
        "a creature": f"/creatures/{archive['creature'][0]}?run={run}",
        "a new run": "/new",
        "a comparison": f"/compare?runs={run}",
        "the runs": "/",
    }
    loaded = {
        name: sum(sizes[file] for file in scripts(browser, product.url + path) & sizes.keys())
        for name, path in paths.items()
    }
    each = ", ".join(f"{size:.1f} kB for {name}" for name, size in loaded.items())
    return f"{max(loaded.values()):.1f} kB: {each}; all there are: {sum(sizes.values()):.1f} kB"


def scripts(browser: Browser, url: str) -> set[str]:
    """Names of the files that a page loads, scrolled to its end."""
    with opened(browser, url) as page:
        page.get_by_role("main").wait_for()
        for _ in range(10):  # Parts far below are loaded when they become visible.
            page.mouse.wheel(0, 900)
            page.wait_for_timeout(SCROLLED_MS)
        names = "performance.getEntriesByType('resource').map(({ name }) => name)"
        return {Path(name).name for name in page.evaluate(names)}


if __name__ == "__main__":
    main()
