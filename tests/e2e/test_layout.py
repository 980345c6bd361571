"""Limits of every page: its layout, its accessibility, its controls and errors."""

import re
from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import pytest
from layout import THEMES, WIDTHS, faults, violations
from pages import TOUR_TAKEN, ProductPage, product_pages, visit
from playwright.sync_api import Page, expect
from small_runs import CENTROIDS, TINY

DESK = 1280
REDRAWN_MS = 150


def test_every_page_fits_its_window_and_axe_finds_nothing(page, shared, idle, complaints):
    page.add_init_script(TOUR_TAKEN)
    page.emulate_media(reduced_motion="reduce")
    wrong = []
    for address, target in every_page(shared, idle):
        page.set_viewport_size({"width": DESK, "height": WIDTHS[DESK]})
        assert visit(page, address, target), f"there is no page at {target.path}"
        wrong += [f"{target.name}, {fault}" for fault in faults_of(page)]
    assert wrong == []
    # Where there is nothing, or nothing was shared, 404 is the status of the page.
    absent = re.compile("404.*/(nothing|nowhere)$")
    complaints[:] = [text for text in complaints if not absent.search(text)]


def every_page(shared: Any, idle: Any) -> Iterator[tuple[str, ProductPage]]:
    """All pages of the shared product, and those that need a product without workers."""
    runs = {shared.finished(name): name for name in shared.submitted}
    voronoi = next(run for run, name in runs.items() if name == "voronoi")
    address = shared.product.url
    for target in product_pages(address, [run for run in runs if run != voronoi]):
        yield address, target
    yield address, ProductPage("run-voronoi", f"/runs/{voronoi}")
    yield address, ProductPage("run-chosen", f"/runs/{voronoi}?cells=0-{CENTROIDS // 2}&at=1")
    yield address, ProductPage("shares-some", "/shares")
    yield address, ProductPage("commons-some", "/commons")
    archive, creature = published(shared.product.http, voronoi)
    yield address, ProductPage("shared-archive", f"/s/{archive['slug']}")
    for part in ("", "/tree", "/embed"):
        yield address, ProductPage(f"shared-creature{part}", f"/s/{creature['slug']}{part}")
    for share in (archive, creature):
        yield address, ProductPage("import", f"/import?share={share['url']}")
    yield address, ProductPage("import-nothing", "/import?share=nothing")
    yield address, ProductPage("shared-nothing", "/s/nothing")
    queued, cancelled = (idle.product.submit(TINY | {"seed": seed}) for seed in (1, 2))
    idle.product.ask(cancelled, "cancel")
    idle.product.wait(cancelled, "cancelled")
    yield idle.product.url, ProductPage("run-queued", f"/runs/{queued}")
    yield idle.product.url, ProductPage("run-cancelled", f"/runs/{cancelled}")
    yield idle.product.url, ProductPage("workers-none", "/workers")
    asked = {"spec": TINY, "seeds": 2, "grid": {"world.viscosity": [0.05, 0.1]}}
    sweep = idle.product.http.post("/api/v1/sweeps", json=asked).raise_for_status().json()
    yield idle.product.url, ProductPage("sweep", f"/sweeps/{sweep['id']}?each=1")
    yield idle.product.url, ProductPage("runs-of-sweep", f"/?sweep={sweep['id']}")
    yield idle.product.url, ProductPage("runs-queued", "/")


def published(http: Any, run: str) -> list[dict[str, Any]]:
    """An archive and one of its creatures, under long names."""
    creature = http.get(f"/api/v1/runs/{run}/archive").json()["creature"][0]
    described = {"title": "A very long title, " * 8, "credit": ["Ada"], "listed": True}
    asked = [{"run": run, **described}, {"creature": creature, **described}]
    return [http.post("/api/v1/shares", json=one).raise_for_status().json() for one in asked]


def faults_of(page: Page) -> Iterator[str]:
    """Faults of a page in every width; at a desk, also those that axe finds in each theme."""
    for width, height in WIDTHS.items():
        page.set_viewport_size({"width": width, "height": height})
        page.wait_for_timeout(REDRAWN_MS)
        yield from (f"{width} wide: {fault}" for fault in faults(page))
        for theme in THEMES if width == DESK else ():  # Colours are alike in every width.
            page.emulate_media(color_scheme=theme, reduced_motion="reduce")
            page.wait_for_timeout(REDRAWN_MS)
            yield from (f"{theme}: {fault}" for fault in violations(page))


MOST_SHIFT = 0.05
LEAST_CONTROL = 24

SHIFT = """
localStorage.setItem("microcosmos:tour-taken", "1");
window.shift = 0;
new PerformanceObserver((list) => {
  for (const entry of list.getEntries()) if (!entry.hadRecentInput) window.shift += entry.value;
}).observe({ type: "layout-shift", buffered: true });
"""

SMALL = """
(least) => [
  ...document.querySelectorAll("button, select, input, summary, nav a"),
].filter((one) => {
  const { width, height } = one.getBoundingClientRect();
  const shown = width > 0 && !one.classList.contains("unseen");
  return shown && Math.min(width, height) < least - 0.1;
}).map((one) => one.outerHTML.slice(0, 120))
"""


@pytest.mark.parametrize("width", [1280, 390])
def test_opening_a_run_shifts_no_layout(shared, page, width):
    page.set_viewport_size({"width": width, "height": 800})
    page.add_init_script(SHIFT)
    page.goto(f"{shared.product.url}/runs/{shared.finished('search')}")
    expect(page.locator(".map-plot canvas").first).to_be_visible()
    page.wait_for_load_state("networkidle")
    assert page.evaluate("window.shift") <= MOST_SHIFT


def test_a_phone_has_one_row_of_navigation_and_controls_to_touch(shared, page):
    page.set_viewport_size({"width": 390, "height": 844})
    run = shared.finished("search")
    for path in ("/", f"/runs/{run}", "/new", "/workers", "/settings"):
        page.goto(f"{shared.product.url}{path}")
        expect(page.get_by_role("heading", level=1)).to_be_visible()
        links = page.get_by_role("navigation", name="Pages").get_by_role("link").all()
        boxes = [box for link in links if (box := link.bounding_box())]
        assert len({box["y"] for box in boxes}) == 1, path
        assert all(a["x"] + a["width"] <= b["x"] for a, b in pairwise(boxes)), path
        assert page.evaluate(SMALL, LEAST_CONTROL) == [], path
