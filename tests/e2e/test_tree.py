"""The tree of life of runs and creatures, by mouse, by touch and by keyboard."""

import csv
import io
import re

from pages import expect_in_url, picture, see_it_move, wait_until_changed, wait_until_still
from playwright.sync_api import Locator, Page, expect

SETTLED_MS = 400


def window(page: Page) -> Locator:
    return page.get_by_role("application", name=re.compile("^Tree of life"))


def opened(page: Page) -> Locator:
    """The link to the creature that is pointed at or selected."""
    card = page.get_by_role("region", name="Creature", exact=True)
    return card.get_by_role("link", name=re.compile("^Open"))


def painted(page: Page) -> None:
    expect(window(page)).to_have_attribute("aria-busy", "false")
    page.wait_for_function("() => performance.getEntriesByName('tree').length > 0")
    page.wait_for_timeout(SETTLED_MS)


def test_a_tree_is_read_from_the_run_to_a_creature_and_back(shared, page):
    product, run = shared.product, shared.finished("search")
    page.goto(f"{product.url}/runs/{run}")
    page.get_by_role("link", name="Tree of life").click()
    page.wait_for_url(re.compile(f"/runs/{run}/tree$"))
    painted(page)
    see_it_move(page.locator(".tree-overlay"))
    page.emulate_media(reduced_motion="reduce")
    wait_until_still(page.locator(".tree-overlay"))
    zoom_and_drag(page)
    table = product.http.get(f"/api/v1/runs/{run}/phylogeny.csv").text
    walk_by_keyboard(page, list(csv.DictReader(io.StringIO(table))))
    window(page).press("Enter")
    page.wait_for_url(re.compile("/creatures/[0-9a-f]{64}"))
    family = page.get_by_role("region", name="Parents and children")
    family.get_by_role("link", name="Tree of life").click()
    page.wait_for_url(re.compile(f"/runs/{run}/tree.creature="))
    painted(page)
    expect(opened(page)).to_be_visible()


def zoom_and_drag(page: Page) -> None:
    box = window(page).bounding_box()
    assert box
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    out = page.get_by_role("button", name="Zoom out")
    expect(out).to_be_disabled()
    page.mouse.move(x, y)
    page.mouse.wheel(0, -400)
    expect(out).to_be_enabled()
    painting = page.locator(".tree-picture")
    wait_until_still(painting)
    before = picture(painting)
    page.mouse.down()
    page.mouse.move(x + 30, y + 60, steps=5)
    page.mouse.up()
    wait_until_changed(painting, before)
    assert "/tree" in page.url, "a drag opens nothing"
    page.get_by_role("button", name="Whole tree").press("Enter")
    expect(out).to_be_disabled()


def walk_by_keyboard(page: Page, rows: list[dict[str, str]]) -> None:
    row = max(rows, key=lambda row: float(row["fitness"]))
    window(page).press("ArrowDown")
    expect(opened(page)).to_have_text(re.compile(row["taxon_label"][:8]))
    while row["ancestor_list"] != "[none]":
        row = rows[int(row["ancestor_list"].strip("[]").split(",")[0])]
        window(page).press("ArrowLeft")
        expect(opened(page)).to_have_text(re.compile(row["taxon_label"][:8]))
    expect_in_url(page, f"creature={row['taxon_label']}")


def test_fingers_select_first(shared, browser):
    context = browser.new_context(
        viewport={"width": 390, "height": 844}, has_touch=True, is_mobile=True
    )
    page = context.new_page()
    page.goto(f"{shared.product.url}/runs/{shared.finished('search')}/tree")
    painted(page)
    box = window(page).bounding_box()
    assert box
    for k in range(100):
        x, y = 0.3 + 0.06 * (k % 10), 0.1 + 0.08 * (k // 10)
        page.touchscreen.tap(box["x"] + x * box["width"], box["y"] + y * box["height"])
        if "creature=" in page.url:
            break
    expect(opened(page)).to_be_visible()
    assert "/tree" in page.url
    context.close()
