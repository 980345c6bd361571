"""A new installation: creatures that come with the page swim until a run has its own."""

import re

from playwright.sync_api import expect
from small_runs import TINY

DRAWN = "() => performance.getEntriesByName('tank').length === 1"
EVALUATED = 240_000
"""Milliseconds in which a worker starts and prepares the evaluation."""


def test_examples_swim_and_can_be_opened_until_elites_take_their_place(product, page):
    page.goto(product.url)
    expect(page.get_by_role("heading", name="Nothing of yours swims here yet")).to_be_visible()
    expect(page.get_by_text("examples that come with Microcosmos swim here")).to_be_visible()
    page.wait_for_function(DRAWN)
    water = page.get_by_role("application", name=re.compile(r"^Tank with \d+ swimming"))
    water.focus()
    page.keyboard.press("ArrowRight")
    named = page.locator("#tank-pointed")
    expect(named).to_have_text(re.compile(r"^fitness 0\.\d+an example that comes with"))
    page.keyboard.press("Enter")
    page.wait_for_url(re.compile(r"/creatures/[0-9a-f]{64}$"))
    page.get_by_role("button", name="Verify").click()
    same = page.get_by_text("equal the recorded ones, bit by bit")
    expect(same).to_be_visible(timeout=EVALUATED)
    run = product.submit(TINY)
    product.wait(run, "finished", seconds=300)
    page.goto(product.url)
    page.wait_for_function(DRAWN)
    expect(page.get_by_text("examples that come with Microcosmos")).to_have_count(0)
    count = len(product.get("tank")["swimmers"])
    expect(page.get_by_role("application", name=f"Tank with {count} swimming")).to_be_visible()
