"""The tank on the first page: it swims, names its creatures, opens them, and can be still."""

import re

import pytest
from pages import see_it_move, stage, wait_until_still
from playwright.sync_api import Locator, Page, expect

NAMED = re.compile(r"^fitness .+generation \d+ of ")
COUNT_CLICKS = """
addEventListener("click", ({ isTrusted }) => {
  if (isTrusted) localStorage.setItem("clicks", 1 + Number(localStorage.getItem("clicks")));
}, true);
"""
"""In all tabs of a site."""


@pytest.fixture
def settled(shared):
    """The shared product with all of its runs finished: no new creature enters."""
    for name in shared.submitted:
        shared.finished(name)
    return shared


@pytest.fixture
def home(page, settled):
    page.goto(settled.product.url)
    expect(water(page)).to_be_visible()
    return page


def water(page: Page):
    return page.get_by_role(
        "application", name=re.compile(r"^Tank with \d+ swimming creatures")
    )


def swimmers(page: Page) -> Locator:
    return page.locator(".water canvas").last


def wait_until_drawn(page: Page) -> None:
    page.wait_for_function("() => performance.getEntriesByName('tank').length === 1")


def point_at_a_creature(page: Page) -> Locator:
    """Move the pointer until it names one: somewhere in the water there is a creature."""
    box = water(page).bounding_box()
    assert box
    named = page.locator("#tank-pointed")
    for k in range(400):
        x, y = (k % 40 + 0.5) / 40, (k // 40 + 0.5) / 10
        page.mouse.move(box["x"] + x * box["width"], box["y"] + y * 0.8 * box["height"])
        page.evaluate("() => new Promise(requestAnimationFrame)")  # In which it is drawn.
        if named.is_visible():
            break
    return named


def test_creatures_swim_until_they_are_paused(home):
    wait_until_drawn(home)
    see_it_move(swimmers(home))
    home.get_by_role("button", name="Pause the creatures").click()
    home.mouse.move(5, 5)
    wait_until_still(swimmers(home))
    expect(point_at_a_creature(home)).to_have_text(NAMED)
    home.get_by_role("button", name="Let the creatures swim").click()
    see_it_move(swimmers(home))


def test_six_clicks_lead_from_a_first_visit_to_a_shared_creature(settled, page):
    page.context.add_init_script(COUNT_CLICKS)
    page.goto(settled.product.url)
    wait_until_drawn(page)
    point_at_a_creature(page)
    page.mouse.down()
    page.mouse.up()
    page.wait_for_url(re.compile(r"/creatures/[0-9a-f]{64}$"))
    page.get_by_role("button", name="Publish").click()
    dialog = page.get_by_role("dialog")
    dialog.get_by_role("button", name="Publish").click()
    with page.context.expect_page() as opened:
        dialog.get_by_role("link", name="Open").click()
    expect(stage(opened.value)).to_be_visible()
    assert re.search(r"/s/[\w-]+$", opened.value.url)
    assert 4 <= page.evaluate("Number(localStorage.getItem('clicks'))") <= 6
