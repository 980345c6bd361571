"""How fast the page is, in Chromium on two cores. Prints a table and asserts nothing.

A small search is carried out; archives of 10,000 and 65,536 cells are filled with what it has
found, and 100 creatures are rendered beforehand. What is timed is what the page says itself:
the mark `map` when the archive has been drawn, the measure `map-draw` around each drawing, the
mark `inset` at the first frame of a replay under the pointer.
"""

import gzip
import os
import statistics
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "faults"))

from browser import launched
from drive import ROOT, Installation, wait_until
from large import connect, creatures_of, write_run
from playwright.sync_api import Browser, Page, Response
from playwright.sync_api import TimeoutError as Late
from rich.console import Console
from rich.table import Table

CORES = 2
SETTINGS = {"MICROCOSMOS_DEMONSTRATION": "false"}
WINDOW = {"width": 1280, "height": 900}
WALL = {"width": 1600, "height": 1600}
"""A window in which a hundred creatures are visible at once."""
TIMES = 5
REDRAWS = 60
HOVERS = 30
TILE = 56
"""Pixels of a creature's tile, so that a hundred are visible at once."""
PATIENCE_MS = 20_000
SMALL = bool(os.environ.get("SMALL"))
CREATURES = 10 if SMALL else 100
NOT_THERE = "not there"

NOTES = """
window.noted = [];
localStorage.setItem("microcosmos:guided", "1");
new PerformanceObserver((list) => {
  for (const { name, entryType, startTime, duration } of list.getEntries())
    window.noted.push({ name, entryType, startTime, duration });
}).observe({ entryTypes: ["mark", "measure"] });
addEventListener("pointermove", ({ timeStamp }) => (window.moved = timeStamp), true);
"""
FRAMES = """
(seconds) => new Promise((resolve) => {
  const times = [];
  requestAnimationFrame(function step(now) {
    times.push(now);
    if (now - times[0] < 1000 * seconds) requestAnimationFrame(step);
    else resolve(times);
  });
})
"""
SWEEP = """
(seconds) => new Promise((resolve) => {
  const map = document.querySelector("[role=application]");
  const { left, top, width, height } = map.getBoundingClientRect();
  const times = [];
  requestAnimationFrame(function step(now) {
    const turn = times.length / 40;
    const clientX = left + width * (0.5 + 0.4 * Math.cos(turn));
    const clientY = top + height * (0.5 + 0.4 * Math.sin(1.3 * turn));
    const event = { clientX, clientY, bubbles: true, pointerType: "mouse" };
    map.dispatchEvent(new PointerEvent("pointermove", event));
    times.push(now);
    if (now - times[0] < 1000 * seconds) requestAnimationFrame(step);
    else resolve(times);
  });
})
"""
"""Points at another cell with every frame of the screen."""
BLOCKS = """
(side) => [...document.querySelectorAll("[data-gallery] canvas")].flatMap((canvas) => {
  const { width, height } = canvas;
  const copy = new OffscreenCanvas(width, height).getContext("2d");
  copy.drawImage(canvas, 0, 0);
  const words = [];
  for (let k = 0; k < side * side; k++) {
    const [x, y] = [(k % side) * width / side, Math.floor(k / side) * height / side];
    const { data } = copy.getImageData(x, y, width / side, height / side);
    let word = 0;
    for (let i = 0; i < data.length; i++) word = (31 * word + data[i]) | 0;
    words.push(word);
  }
  return words;
})
"""
"""A number for each block of the wall, which changes with its pixels."""


class Runs(NamedTuple):
    """Runs by what is measured on them."""

    ten_thousand: str
    largest: str
    hundred: str


def main() -> None:
    cores = sorted(os.sched_getaffinity(0))[:CORES]
    os.sched_setaffinity(0, cores)
    console = Console(width=110)
    with tempfile.TemporaryDirectory() as folder:
        place = Installation(Path(folder) / "data", SETTINGS)
        place.start()
        try:
            runs = prepare(place)
            with launched() as browser:
                console.print(table(browser, place, runs, len(cores)))
        finally:
            place.end()
            place.close()


def prepare(place: Installation) -> Runs:
    """Carry out a search, fill archives with what it found, and have replays rendered."""
    found = searched(place)
    services = connect(str(place.folder))
    creatures = creatures_of(services, found)[:CREATURES]
    side = round(len(creatures) ** 0.5)
    runs = Runs(
        write_run(services, found, 100, 10_000, creatures),
        write_run(services, found, 256, 65_536, creatures),
        write_run(services, found, side, side**2, creatures),
    )
    services.close()
    for creature in creatures:
        render(place, creature)
    return runs


def searched(place: Installation) -> str:
    """The demonstration's run, long enough for a hundred creatures."""
    experiments = place.http.get("/api/v1/experiments").raise_for_status().json()
    of_search = next(one for one in experiments if one["experiment"] == "quality-diversity")
    spec = of_search["presets"][0]["spec"]
    spec["search"]["generations"] = 40
    run = place.submit(spec)
    place.wait(run, "finished", seconds=600)
    return run


def render(place: Installation, creature: str) -> None:
    def there() -> bool:
        answer = place.http.get(f"/api/v1/creatures/{creature}/replay").raise_for_status()
        return answer.status_code == 200

    wait_until(there, 300, f"creature {creature} is rendered")


def table(browser: Browser, place: Installation, runs: Runs, cores: int) -> Table:
    first, largest, hundred = (f"{place.url}/runs/{run}" for run in runs)
    wall = f"{hundred}?view=gallery&tile={TILE}"
    measures: list[tuple[str, str, Callable[[], str]]] = [
        ("first paint of a run with 10,000 cells", "≤ 1 s", lambda: paint(browser, first)),
        ("redraw of 65,536 cells", "≤ 16 ms", lambda: redraw(browser, largest)),
        ("pointing at them, one after another", "", lambda: sweep(browser, largest)),
        ("playing their history", "", lambda: play(browser, largest)),
        ("pointer on a cell to its first frame", "≤ 100 ms", lambda: hover(browser, hundred)),
        (f"gallery of {CREATURES}", "≥ 30 frames/s", lambda: gallery(browser, wall)),
        ("script of a page, gzipped", "≤ 100 kB", lambda: script(browser, place, runs.hundred)),
    ]
    rows = Table("", "bar", "found", title=f"The page in Chromium on {cores} cores")
    for name, bar, measure in measures:
        rows.add_row(name, bar, measured(measure))
    return rows


def measured(measure: Callable[[], str]) -> str:
    """What a measure finds, or that a page has nothing to measure."""
    try:
        return measure()
    except Late as error:
        return f"{NOT_THERE}: {error.message.splitlines()[0]}"


def opened(browser: Browser, url: str, window: dict[str, int] = WINDOW) -> Page:
    page = browser.new_context(viewport=window).new_page()
    page.add_init_script(NOTES)
    page.set_default_timeout(PATIENCE_MS)
    page.goto(url)
    return page


def noted(page: Page, name: str) -> list[dict[str, float]]:
    return page.evaluate("(name) => window.noted.filter((one) => one.name === name)", name)


def until_noted(page: Page, name: str, after: float = 0.0) -> dict[str, float] | None:
    """The first note by a name after a moment of the page, if it comes."""
    script = (
        "([name, after]) => window.noted.find((n) => n.name === name && n.startTime > after)"
    )
    try:
        return page.wait_for_function(script, arg=[name, after]).json_value()
    except Late:
        return None


def paint(browser: Browser, url: str) -> str:
    """From the navigation to the map with its cells, in new contexts: nothing is cached."""
    times = []
    for _ in range(TIMES):
        page = opened(browser, url)
        page.get_by_text("10,000 elites").first.wait_for()
        mark = until_noted(page, "map")
        if mark is None:
            return f"{NOT_THERE}: no mark `map`"
        times.append(mark["startTime"] / 1000)
        page.context.close()
    return f"{statistics.median(times):.2f} s, slowest {max(times):.2f} s, of {TIMES}"


def redraw(browser: Browser, url: str) -> str:
    """The drawing itself, each time that the theme changes."""
    page = opened(browser, url)
    page.get_by_text("65,536 elites").first.wait_for()
    if until_noted(page, "map") is None:
        return f"{NOT_THERE}: no mark `map`"
    page.evaluate("window.noted.length = 0")
    for k in range(REDRAWS):
        page.emulate_media(color_scheme=("dark", "light")[k % 2])
        page.wait_for_timeout(50)
    times = [note["duration"] for note in noted(page, "map-draw")]
    page.context.close()
    if len(times) < 2:
        return f"{NOT_THERE}: no measures `map-draw`"
    tenth = statistics.quantiles(times, n=10)[-1]
    return f"{statistics.median(times):.1f} ms, one in ten over {tenth:.1f} ms, of {len(times)}"


def sweep(browser: Browser, url: str) -> str:
    """Frames a second while the pointer is at another of 65,536 cells with each of them."""
    page = opened(browser, url)
    page.get_by_text("65,536 elites").first.wait_for()
    frames = page.evaluate(SWEEP, 5)
    page.context.close()
    return f"{rate(frames):.0f} frames/s"


def play(browser: Browser, url: str) -> str:
    """Frames a second while the history of 65,536 cells is played."""
    page = opened(browser, url)
    page.get_by_text("65,536 elites").first.wait_for()
    button = page.get_by_role("button", name="Play the history")
    if not button.count():
        return f"{NOT_THERE}: no button `Play the history`"
    button.click()
    page.get_by_text("65,536 elites").first.wait_for(state="detached")
    frames = page.evaluate(FRAMES, 3)
    page.context.close()
    return f"{rate(frames):.0f} frames/s"


def hover(browser: Browser, url: str) -> str:
    """From the pointer's event to the replay's first frame, over cells one after another."""
    page = opened(browser, url)
    if until_noted(page, "map") is None:
        return f"{NOT_THERE}: no mark `map`"
    box = page.get_by_role("application").first.bounding_box()
    assert box
    side = round(CREATURES**0.5)
    times = []
    for k in range(min(HOVERS, side**2)):
        i, j = divmod((7 * k) % side**2, side)
        x, y = ((part + 0.5) / side for part in (i, j))
        page.mouse.move(box["x"] + x * box["width"], box["y"] + y * box["height"])
        moved = page.evaluate("window.moved")
        mark = until_noted(page, "inset", moved)
        if mark is None:
            return f"{NOT_THERE}: no mark `inset`"
        times.append(mark["startTime"] - moved)
        page.wait_for_timeout(200)
    page.context.close()
    return f"{statistics.median(times):.0f} ms, slowest {max(times):.0f} ms, of {len(times)}"


def gallery(browser: Browser, url: str) -> str:
    """Frames a second while all of it is visible and moves."""
    page = opened(browser, url, WALL)
    fetched: set[str] = set()
    page.on("response", lambda answer: note_motion(answer, fetched))
    page.reload()
    try:
        page.locator("[data-gallery] canvas").first.wait_for()
    except Late:
        return f"{NOT_THERE}: nothing in [data-gallery]"
    page.locator("[data-gallery] canvas").first.scroll_into_view_if_needed()
    page.wait_for_timeout(8000)  # What moves is fetched.
    frames = page.evaluate(FRAMES, 5)
    side = round(CREATURES**0.5)
    before = page.evaluate(BLOCKS, side)
    page.wait_for_timeout(700)
    after = page.evaluate(BLOCKS, side)
    page.context.close()
    moving = sum(one != other for one, other in zip(before, after, strict=False))
    return f"{rate(frames):.0f} frames/s, {len(fetched)} of them there, {moving} tiles moving"


def note_motion(answer: Response, fetched: set[str]) -> None:
    if answer.url.endswith(("/motion", "/replay")) and answer.status == 200:
        fetched.add(answer.url)


def rate(frames: list[float]) -> float:
    """Frames a second, from when each was."""
    return 1000 * (len(frames) - 1) / (frames[-1] - frames[0])


def script(browser: Browser, place: Installation, run: str) -> str:
    """What opening each page loads of all scripts that there are."""
    built = ROOT / "web" / "dist"
    sizes = {file.name: zipped(file) / 1000 for file in built.rglob("*.js")}
    archive = place.http.get(f"/api/v1/runs/{run}/archive").raise_for_status().json()
    paths = {
        "a run": f"/runs/{run}",
        "a creature": f"/creatures/{archive['creature'][0]}?run={run}",
        "a new run": "/new",
        "a comparison": f"/compare?runs={run}",
        "the runs": "/",
    }
    loaded = {
        name: sum(sizes[file] for file in scripts(browser, place.url + path) & sizes.keys())
        for name, path in paths.items()
    }
    each = ", ".join(f"{size:.1f} kB for {name}" for name, size in loaded.items())
    return f"{max(loaded.values()):.1f} kB: {each}; all there are: {sum(sizes.values()):.1f} kB"


def scripts(browser: Browser, url: str) -> set[str]:
    """The names of the files that a page has loaded once it has come to rest, to its end."""
    page = opened(browser, url)
    page.get_by_role("main").wait_for()
    for _ in range(10):  # What is far below may come when it is in sight.
        page.mouse.wheel(0, 900)
        page.wait_for_timeout(300)
    names = "performance.getEntriesByType('resource').map(({ name }) => name)"
    found = {Path(name).name for name in page.evaluate(names)}
    page.context.close()
    return found


def zipped(file: Path) -> int:
    return len(gzip.compress(file.read_bytes()))


if __name__ == "__main__":
    main()
