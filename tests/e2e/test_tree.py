"""The tree of life of runs and creatures, by mouse, by touch and by keyboard."""

import csv
import io
import re
import xml.etree.ElementTree as ET

import newick
import pytest
from drive import Installation, wait_until
from layout import THEMES, faults, violations
from pages import (
    best_of,
    expect_in_url,
    picture,
    see_it_move,
    settle,
    wait_until_changed,
    wait_until_still,
)
from playwright.sync_api import Locator, Page, expect
from small_runs import TINY

SLOW = 300_000
SETTLED_MS = 400


def window(page: Page) -> Locator:
    return page.get_by_role("application", name=re.compile("^Tree of life"))


def shown(page: Page) -> Locator:
    """The card of the creature that is pointed at or selected."""
    return page.get_by_role("region", name="Creature", exact=True)


def painted(page: Page) -> None:
    expect(window(page)).to_have_attribute("aria-busy", "false")
    page.wait_for_function("() => performance.getEntriesByName('tree').length > 0")
    page.wait_for_timeout(SETTLED_MS)


def overlay(page: Page) -> Locator:
    """The canvas of the bodies, above that of the lines."""
    return page.locator(".tree-overlay")


def picture_scale(page: Page) -> str:
    return page.evaluate("document.querySelector('.tree-picture').style.transform")


def test_a_tree_is_read_from_the_run_to_a_creature_and_back(shared, page):
    product, run = shared.product, shared.finished("search")
    page.goto(f"{product.url}/runs/{run}")
    page.get_by_role("link", name="Tree of life").click()
    page.wait_for_url(re.compile(f"/runs/{run}/tree$"))
    painted(page)
    rows = table(product, f"runs/{run}")
    expect(page.get_by_text(re.compile(f"^{len(rows):,} creatures, "))).to_be_visible()
    walk_by_keyboard(page, rows)
    zoom_and_drag(page)
    move_through_time(page)
    choose(page)
    save(page, product, run, rows)
    window(page).press("Enter")
    page.wait_for_url(re.compile("/creatures/[0-9a-f]{64}"))
    page.get_by_role("region", name="Parents and children").get_by_role(
        "link", name="Tree of life"
    ).click()
    page.wait_for_url(re.compile(f"/runs/{run}/tree.creature="))
    painted(page)
    expect(shown(page).get_by_role("link", name=re.compile("^Open"))).to_be_visible()


def table(product: Installation, path: str) -> list[dict[str, str]]:
    text = product.http.get(f"/api/v1/{path}/phylogeny.csv").raise_for_status().text
    return list(csv.DictReader(io.StringIO(text)))


def walk_by_keyboard(page: Page, rows: list[dict[str, str]]) -> None:
    best = max(rows, key=lambda row: float(row["fitness"]))
    window(page).press("ArrowDown")
    name = shown(page).get_by_role("link", name=re.compile("^Open"))
    expect(name).to_have_text(re.compile(best["taxon_label"][:8]))
    row = best
    while row["ancestor_list"] != "[none]":
        row = rows[int(row["ancestor_list"].strip("[]").split(",")[0])]
        window(page).press("ArrowLeft")
        expect(name).to_have_text(re.compile(row["taxon_label"][:8]))
    expect_in_url(page, f"creature={row['taxon_label']}")
    window(page).press("Escape")
    expect(name).to_have_count(0)


def zoom_and_drag(page: Page) -> None:
    box = window(page).bounding_box()
    assert box
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    whole = page.get_by_role("button", name="Whole tree")
    out = page.get_by_role("button", name="Zoom out")
    expect(out).to_be_disabled()
    page.mouse.move(x, y)
    page.mouse.wheel(0, -400)
    expect(out).to_be_enabled()
    page.wait_for_timeout(SETTLED_MS)
    before = picture_scale(page)
    page.mouse.down()
    page.mouse.move(x + 30, y + 60, steps=5)
    page.mouse.up()
    wait_until(lambda: picture_scale(page) != before, 10, "the tree has moved")
    assert "/tree" in page.url, "a drag opens nothing"
    page.get_by_role("button", name="Zoom in").press("Enter")
    whole.press("Enter")
    expect(out).to_be_disabled()


def move_through_time(page: Page) -> None:
    page.emulate_media(reduced_motion="reduce")
    wait_until_still(overlay(page))
    now = picture(overlay(page))
    page.get_by_role("slider", name="Generation shown").fill("1")
    wait_until_changed(overlay(page), now)
    page.get_by_role("button", name="Newest").click()
    page.emulate_media(reduced_motion="no-preference")


def choose(page: Page) -> None:
    page.get_by_role("button", name="Operator").click()
    expect(
        page.get_by_role("list", name="Operator").get_by_role("listitem").first
    ).to_be_visible()
    page.get_by_role("combobox", name="Show").select_option("Lines of the elites now")
    page.get_by_role("checkbox", name="Collapse single lines").uncheck()
    for part in ("colour=operator", "show=survivors", "lines=all"):
        expect_in_url(page, part)
    painted(page)
    window(page).press("ArrowDown")


def save(page: Page, product: Installation, run: str, rows: list[dict[str, str]]) -> None:
    with page.expect_download() as download:
        page.get_by_role("button", name="view.svg").click()
    drawing = ET.fromstring(download.value.path().read_text())
    assert len(drawing.findall(".//{http://www.w3.org/2000/svg}path")) > 3
    with page.expect_download() as download:
        page.get_by_role("link", name="phylogeny.nwk").click()
    assert download.value.suggested_filename == f"phylogeny-{run[:8]}.nwk"
    nodes = newick.read(download.value.path().read_text())
    assert {one.label for one in nodes} == {row["taxon_label"] for row in rows}


def test_a_click_opens_the_creature_that_the_pointer_names(shared, page):
    run = shared.finished("search")
    best = best_of(shared.product, run)
    page.goto(f"{shared.product.url}/runs/{run}/tree?creature={best}")
    painted(page)
    box = window(page).bounding_box()
    assert box
    found = None
    for k in range(400):
        x, y = (0.3 + 0.6 * (k % 20) / 20, 0.1 + 0.8 * (k // 20) / 20)
        page.mouse.move(box["x"] + x * box["width"], box["y"] + y * box["height"])
        text = shown(page).get_by_role("link", name=re.compile("^Open")).inner_text()
        if best[:8] not in text:
            found = text.split()[-1]
            page.mouse.down()
            page.mouse.up()
            break
    assert found, "no other creature was found"
    page.wait_for_url(re.compile(f"/creatures/{found}"))


def test_a_tree_leads_across_a_fork_and_finds_each_creature(shared, page):
    product, run = shared.product, shared.finished("voronoi")
    parent = best_of(product, run)
    before = {
        row["run"] for row in table(product, f"creatures/{parent}")
    }  # Of other tests too.
    assert run in before
    asked = {"from": {"creatures": [parent]}, "spec": {"world": {"viscosity": 0.3}}}
    fork = product.http.post(f"/api/v1/runs/{run}/fork", json=asked).raise_for_status().json()
    product.wait(fork["id"], "finished", seconds=300)
    page.goto(f"{product.url}/creatures/{parent}/tree")
    painted(page)
    expect(shown(page)).to_contain_text(f"of run {run[:8]}")
    rows = table(product, f"creatures/{parent}")
    assert {row["run"] for row in rows} == before | {fork["id"]}
    page.goto(f"{product.url}/runs/{fork['id']}/tree")
    painted(page)
    both = {row["run"] for row in table(product, f"runs/{fork['id']}")}
    assert both == {run, fork["id"]}


@pytest.mark.parametrize("width", [1280, 390])
def test_the_page_of_a_tree_fits_and_axe_finds_nothing(shared, page, width):
    run = shared.finished("search")
    best = best_of(shared.product, run)
    page.emulate_media(reduced_motion="reduce")
    page.set_viewport_size({"width": width, "height": 844})
    for path in (
        f"/runs/{run}/tree",
        f"/runs/{run}/tree?colour=operator&creature={best}",
        f"/runs/{shared.finished('sweep')}/tree",
    ):
        page.goto(shared.product.url + path)
        settle(page, 60)
        for theme in THEMES:
            page.emulate_media(color_scheme=theme, reduced_motion="reduce")
            page.wait_for_timeout(SETTLED_MS)
            assert faults(page) + violations(page) == [], path


def test_bodies_move_unless_less_motion_is_wished(shared, page):
    page.goto(f"{shared.product.url}/runs/{shared.finished('search')}/tree")
    painted(page)
    see_it_move(overlay(page))
    page.emulate_media(reduced_motion="reduce")
    wait_until_still(overlay(page))


def test_fingers_select_first_and_pinch(shared, browser):
    context = browser.new_context(
        viewport={"width": 390, "height": 844}, has_touch=True, is_mobile=True
    )
    page = context.new_page()
    page.goto(f"{shared.product.url}/runs/{shared.finished('search')}/tree")
    painted(page)
    box = window(page).bounding_box()
    assert box
    for k in range(100):
        page.touchscreen.tap(
            box["x"] + (0.3 + 0.06 * (k % 10)) * box["width"],
            box["y"] + (0.1 + 0.08 * (k // 10)) * box["height"],
        )
        if "creature=" in page.url:
            break
    expect(shown(page).get_by_role("link", name=re.compile("^Open"))).to_be_visible()
    assert "/tree" in page.url
    context.close()


def test_a_shared_tree_without_elites_says_so_and_comes_back(shared, page):
    product = shared.product
    best = best_of(product, shared.finished("search"))
    slug = product.http.post("/api/v1/shares", json={"creature": best}).json()["slug"]
    page.emulate_media(reduced_motion="reduce")
    page.goto(f"{product.url}/s/{slug}/tree")
    painted(page)
    wait_until_still(overlay(page))
    before = picture(overlay(page))
    choice = page.get_by_role("combobox", name="Show")
    choice.select_option("Lines of the elites now")
    expect(page.get_by_text("None of these creatures is an elite now.")).to_be_visible()
    page.get_by_role("button", name="Zoom in").click()
    choice.select_option("All births")
    page.get_by_role("button", name="Whole tree").click()
    wait_until_still(overlay(page))
    assert picture(overlay(page)) == before


def test_a_run_without_elites_and_a_tree_that_fails_say_so(idle, page, complaints):
    queued = idle.product.submit(TINY | {"seed": 77})
    page.goto(f"{idle.product.url}/runs/{queued}/tree")
    expect(page.get_by_role("heading", name="No tree yet")).to_be_visible()
    page.goto(f"{idle.product.url}/creatures/{'ab' * 32}/tree")
    expect(page.get_by_role("alert")).to_contain_text("No creature has the name")
    complaints[:] = [text for text in complaints if not re.search("404.*phylogeny$", text)]
