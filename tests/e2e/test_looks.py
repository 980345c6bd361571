"""On every page nothing is cut off or drawn over something else, and axe finds nothing."""

import re
from collections.abc import Iterator
from typing import Any

import pytest
from accessibility import violations
from looks import THEMES, WIDTHS, faults
from places import GUIDED, Place, places, visit
from playwright.sync_api import Page
from small import CENTROIDS, TINY

DESK = 1280
REDRAWN_MS = 150


@pytest.mark.e2e
def test_every_page_fits_its_window_and_axe_finds_nothing(
    shared_page: Page, shared: Any, idle: Any, complaints: list[str]
):
    shared_page.add_init_script(GUIDED)
    shared_page.emulate_media(reduced_motion="reduce")
    wrong = []
    for address, place in every_place(shared, idle):
        shared_page.set_viewport_size({"width": DESK, "height": WIDTHS[DESK]})
        assert visit(shared_page, address, place), f"there is no page at {place.path}"
        wrong += [f"{place.name}, {said}" for said in complaints_of(shared_page)]
    assert wrong == []
    # Where nothing was shared, 404 is the page's status and the share's.
    complaints[:] = [said for said in complaints if not re.search("404.*/nothing$", said)]


def every_place(shared: Any, idle: Any) -> Iterator[tuple[str, Place]]:
    """The shared pages, and what only a product without workers shows for long."""
    runs = {shared.finished(name): name for name in shared.submitted}
    voronoi = next(run for run, name in runs.items() if name == "voronoi")
    address = shared.product.url
    for place in places(address, [run for run in runs if run != voronoi]):
        yield address, place
    yield address, Place("run-voronoi", f"/runs/{voronoi}")
    yield address, Place("run-chosen", f"/runs/{voronoi}?cells=0-{CENTROIDS // 2}&at=1")
    yield address, Place("shares-some", "/shares")
    yield address, Place("commons-some", "/commons")
    for share in published(shared.product.http, voronoi):
        yield address, Place("shared", f"/s/{share['slug']}")
    yield address, Place("shared-nothing", "/s/nothing")
    queued, cancelled = (idle.product.submit(TINY | {"seed": seed}) for seed in (1, 2))
    idle.product.ask(cancelled, "cancel")
    idle.product.wait(cancelled, "cancelled")
    yield idle.product.url, Place("run-queued", f"/runs/{queued}")
    yield idle.product.url, Place("run-cancelled", f"/runs/{cancelled}")
    yield idle.product.url, Place("workers-none", "/workers")
    asked = {"spec": TINY, "seeds": 2, "grid": {"world.viscosity": [0.05, 0.1]}}
    sweep = idle.product.http.post("/api/v1/sweeps", json=asked).raise_for_status().json()
    yield idle.product.url, Place("sweep", f"/sweeps/{sweep['id']}?each=1")
    yield idle.product.url, Place("runs-of-sweep", f"/?sweep={sweep['id']}")
    yield idle.product.url, Place("runs-queued", "/")


def published(http: Any, run: str) -> list[dict[str, Any]]:
    """An archive and one of its creatures, under long names."""
    creature = http.get(f"/api/v1/runs/{run}/archive").json()["creature"][0]
    said = {"title": "A very long title, " * 8, "credit": ["Ada"], "listed": True}
    asked = [{"run": run, **said}, {"creature": creature, **said}]
    return [http.post("/api/v1/shares", json=one).raise_for_status().json() for one in asked]


def complaints_of(page: Page) -> Iterator[str]:
    """In every theme and width, what a person would see to be wrong; at a desk, also axe."""
    for width, height in WIDTHS.items():
        page.set_viewport_size({"width": width, "height": height})
        for theme in THEMES:
            page.emulate_media(color_scheme=theme, reduced_motion="reduce")
            page.wait_for_timeout(REDRAWN_MS)
            found = faults(page) + (violations(page) if width == DESK else [])
            yield from (f"{width} wide, {theme}: {fault}" for fault in found)
