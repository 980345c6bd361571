"""The pages of a product, and waiting until they are loaded."""

import re
import time
from collections.abc import Collection, Iterator
from typing import Any, NamedTuple

import httpx
from drive import Installation, wait_until
from playwright.sync_api import Locator, Page, expect

NOWHERE = "Page not found"
UNREST = ".loading, .rendering, [aria-busy=true], .waiting:has-text('…')"
"""Elements that stand for something that is loading."""
CALM_S = 0.3
CHANGED_S = 30.0
STILL_MS = 600
SCRUBBER = "input[aria-label='Time in the replay']"
TOUR_TAKEN = "localStorage.setItem('microcosmos:tour-taken', '1')"
"""Keeps the tour from opening by itself."""


ALL_SETTINGS = "localStorage.setItem('microcosmos:all-settings', '1')"
"""Shows all settings of a new run."""


class ProductPage(NamedTuple):
    name: str
    path: str
    press: str | None = None
    """A button to press first."""


def product_pages(address: str, among: Collection[str] | None = None) -> list[ProductPage]:
    """The pages of a product, with the newest finished of these runs in each experiment."""
    with httpx.Client(base_url=f"{address}/api/v1", timeout=30) as http:
        known = [run for run in finished(http) if among is None or run["id"] in among]
        runs = {run["experiment"]: run for run in reversed(known)}
        return [
            ProductPage("runs", "/"),
            ProductPage("workers", "/workers"),
            ProductPage("shares", "/shares"),
            ProductPage("commons", "/commons"),
            ProductPage("settings", "/settings"),
            *swept(http),
            *compared(known),
            *(ProductPage(f"run-{name}", f"/runs/{run['id']}") for name, run in runs.items()),
            *searched(http, runs.get("quality-diversity")),
            *measured(http, runs.get("gaits")),
            ProductPage("new-run", "/new"),
            ProductPage("new-run-json", "/new", "JSON"),
            ProductPage("not-found", "/nowhere"),
        ]


def finished(http: httpx.Client) -> list[dict[str, Any]]:
    """Finished runs, newest first."""
    page = http.get("/runs", params={"limit": 100}).raise_for_status().json()
    return [run for run in page["items"] if run["status"] == "finished"]


def swept(http: httpx.Client) -> Iterator[ProductPage]:
    """The newest sweep, with every run."""
    for sweep in http.get("/sweeps").raise_for_status().json()["items"][:1]:
        yield ProductPage("sweep", f"/sweeps/{sweep['id']}?each=1")


def compared(known: list[dict[str, Any]]) -> Iterator[ProductPage]:
    """Two runs beside each other, where two have searched."""
    runs = [run["id"] for run in known if "search" in run["spec"]]
    if len(runs) > 1:
        yield ProductPage("compare", f"/compare?runs={','.join(runs[:2])}")


def searched(http: httpx.Client, run: dict[str, Any] | None) -> Iterator[ProductPage]:
    """The tour, the gallery and the best creature of an archive."""
    if run:
        archive = http.get(f"/runs/{run['id']}/archive").raise_for_status().json()
        best = max(range(len(archive["cell"])), key=lambda i: archive["fitness"][i])
        yield ProductPage("tour", f"/runs/{run['id']}", "Explain")
        yield ProductPage("tree", f"/runs/{run['id']}/tree")
        yield ProductPage("gallery", f"/runs/{run['id']}?view=gallery")
        yield ProductPage("creature", f"/creatures/{archive['creature'][best]}?run={run['id']}")


def measured(http: httpx.Client, run: dict[str, Any] | None) -> Iterator[ProductPage]:
    """A swimmer whose gait was given to it."""
    if run:
        rows = http.get(f"/runs/{run['id']}/results").raise_for_status().json()["rows"]
        swimmer = next(row["creature"] for row in rows if row["creature"])
        yield ProductPage("swimmer", f"/creatures/{swimmer}?run={run['id']}")


def the_map(page: Page) -> Locator:
    return page.get_by_role("application", name=re.compile("^Archive map"))


def elites(page: Page) -> Locator:
    return page.get_by_text(re.compile(r"^[\d,]+ elites$"))


def stage(page: Page) -> Locator:
    return page.get_by_role("img", name=re.compile("The swimming creature"))


def best_of(product: Installation, run: str) -> str:
    archive = product.get(f"runs/{run}/archive")
    return max(zip(archive["fitness"], archive["creature"], strict=True))[1]


def start_run(page: Page) -> str:
    """Start the run of the form and return its id."""
    page.get_by_role("button", name="Start run").click()
    page.wait_for_url(re.compile(r"/runs/[0-9a-f-]{36}$"))
    return page.url.rpartition("/")[2]


def visit(page: Page, address: str, target: ProductPage, seconds: float = 120) -> bool:
    """Open a page and wait until it is loaded; false if it does not exist."""
    page.goto(address + target.path)
    page.get_by_role("main").wait_for()
    if target.name != "not-found" and page.get_by_role("heading", name=NOWHERE).count():
        return False
    settle(page, seconds)
    if target.press:
        page.get_by_role("button", name=target.press, exact=True).click()
    return True


def settle(page: Page, seconds: float) -> None:
    """Wait until nothing on a page has been loading for a moment."""
    deadline, calm_since = time.monotonic() + seconds, time.monotonic()
    while time.monotonic() - calm_since < CALM_S:
        if time.monotonic() > deadline:
            waiting = page.locator(UNREST).all_inner_texts()
            raise TimeoutError(f"waited {seconds:g} s in vain for {waiting}")
        page.wait_for_timeout(50)
        if page.locator(UNREST).count():
            calm_since = time.monotonic()
    page.evaluate("document.fonts.ready")


def expect_in_url(page: Page, text: str, there: bool = True) -> None:
    """Wait until a part of the address is there, or is not."""
    part = re.compile(re.escape(text))
    if there:
        expect(page).to_have_url(part)
    else:
        expect(page).not_to_have_url(part)


def picture(canvas: Locator) -> str:
    return canvas.evaluate("canvas => canvas.toDataURL()")


def film(page: Page) -> Locator:
    """The canvas of a replay."""
    return page.locator(".stage canvas").first


def wait_until_changed(canvas: Locator, before: str) -> None:
    wait_until(lambda: picture(canvas) != before, CHANGED_S, "another picture is drawn")


def wait_until_still(canvas: Locator) -> None:
    """What was asked for may still be drawn; what moves without end fails."""

    def is_still() -> bool:
        before = picture(canvas)
        canvas.page.wait_for_timeout(STILL_MS)
        return picture(canvas) == before

    wait_until(is_still, CHANGED_S, "the picture is still")


def see_it_move(canvas: Locator) -> None:
    """Not once, as when it is first drawn, but again and again."""
    for _ in range(5):
        wait_until_changed(canvas, picture(canvas))


def see_it_swim(page: Page, seconds: float) -> None:
    expect(stage(page)).to_be_visible(timeout=1000 * seconds)
    see_it_move(film(page))


def hold_still(page: Page) -> None:
    """Stop a replay in mid-stroke, where there is one: pictures of it are then the same."""
    for scrubber in page.locator(SCRUBBER).all():
        last = float(scrubber.get_attribute("max") or 0)
        scrubber.fill(str(round(0.62 * last)))
        scrubber.blur()
