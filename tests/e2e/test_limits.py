"""Limits of the page: layout shift, rows of the header, sizes of controls, names and errors."""

import re
from itertools import pairwise
from typing import Any

import pytest
from playwright.sync_api import Page, expect

FAST = 15_000
MOST_SHIFT = 0.05
LEAST_CONTROL = 24

SHIFT = """
localStorage.setItem("microcosmos:guided", "1");
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


@pytest.mark.e2e
@pytest.mark.parametrize("width", [1280, 390])
def test_opening_a_run_moves_nothing_that_is_visible(
    shared: Any, shared_page: Page, width: int
):
    page = shared_page
    page.set_viewport_size({"width": width, "height": 800})
    page.add_init_script(SHIFT)
    page.goto(f"{shared.product.url}/runs/{shared.finished('search')}")
    expect(page.locator(".map-plot canvas")).to_be_visible(timeout=FAST)
    page.wait_for_load_state("networkidle")
    assert page.evaluate("window.shift") <= MOST_SHIFT


@pytest.mark.e2e
def test_a_phone_has_one_row_of_navigation_and_controls_to_touch(
    shared: Any, shared_page: Page
):
    page = shared_page
    page.set_viewport_size({"width": 390, "height": 844})
    run = shared.finished("search")
    for path in ("/", f"/runs/{run}", "/new", "/workers", "/settings"):
        page.goto(f"{shared.product.url}{path}")
        expect(page.get_by_role("heading", level=1)).to_be_visible(timeout=FAST)
        links = page.get_by_role("navigation", name="Pages").get_by_role("link").all()
        boxes = [box for link in links if (box := link.bounding_box())]
        assert len({box["y"] for box in boxes}) == 1, path
        assert all(a["x"] + a["width"] <= b["x"] for a, b in pairwise(boxes)), path
        assert page.evaluate(SMALL, LEAST_CONTROL) == [], path


@pytest.mark.e2e
def test_a_malformed_id_is_named_and_no_parser_speaks(
    shared: Any, shared_page: Page, complaints: list[str]
):
    shared_page.goto(f"{shared.product.url}/runs/abc")
    expect(shared_page.get_by_role("alert")).to_contain_text("abc", timeout=FAST)
    expect(shared_page.get_by_text("UUID")).to_have_count(0)
    # The browser logs the refused request itself.
    complaints[:] = [said for said in complaints if not re.search("422.*/runs/abc$", said)]


@pytest.mark.e2e
def test_titles_of_a_family_tree_do_not_overlap(shared: Any, shared_page: Page):
    page, address = shared_page, shared.product.url
    archive = page.request.get(
        f"{address}/api/v1/runs/{shared.finished('search')}/archive"
    ).json()
    young = max(range(len(archive["cell"])), key=lambda i: archive["elite_generation"][i])
    page.goto(f"{address}/creatures/{archive['creature'][young]}?back=5")
    titles = page.locator(".family-title")
    expect(titles.get_by_text("generations back").first).to_be_visible(timeout=FAST)
    assert all(
        title.evaluate("(e) => e.scrollWidth <= e.clientWidth") for title in titles.all()
    )
