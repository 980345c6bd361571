import re

import pytest
from playwright.sync_api import Page, expect

FAST, SLOW = 10_000, 300_000


@pytest.mark.e2e
def test_a_population_is_started_watched_seen_along_other_axes_and_one_of_it_opened(
    shared_page: Page, shared_address: str
):
    page = shared_page
    submit_a_small_population(page, shared_address)
    watch_it_end(page)
    look_along_other_axes(page)
    open_the_best(page)


def submit_a_small_population(page: Page, address: str) -> None:
    page.goto(f"{address}/new")
    page.get_by_role("radio", name=re.compile("^Neuroevolution")).check()
    presets = page.get_by_role("group", name=re.compile("^Neuroevolution"))
    presets.get_by_role("button", name=re.compile("^Demo")).click()
    page.get_by_label("Generations", exact=False).fill("12")
    search = page.get_by_role("group", name="Search", exact=True)
    search.get_by_label("Batch", exact=False).fill("16")
    again = search.get_by_role("checkbox", name="Reevaluation")
    again.check()
    search.get_by_label("Every", exact=False).fill("4")
    search.get_by_label("Evaluations", exact=False).fill("128")
    page.get_by_role("button", name="Start run").click()
    page.wait_for_url(re.compile(r"/runs/[0-9a-f-]{36}$"), timeout=FAST)


def watch_it_end(page: Page) -> None:
    ended = page.get_by_text("Ended after generation 8: it used its budget of 128 evaluations")
    expect(ended).to_be_visible(timeout=SLOW)
    expect(page.get_by_role("heading", name="Neuroevolution")).to_be_visible()
    expect(page.get_by_role("img", name=re.compile("Into empty cells over"))).to_be_visible()
    scores = page.get_by_role("img", name=re.compile("QD score .* re-evaluated [0-9]"))
    expect(scores).to_be_visible()


def look_along_other_axes(page: Page) -> None:
    page.get_by_label("Horizontal axis").select_option("path_length")
    page.get_by_label("Vertical axis").select_option(label="Fitness")
    assert "x=path_length&y=fitness" in page.url
    expect(page.get_by_text("Path length (cells)")).to_be_visible(timeout=FAST)
    with page.expect_response(re.compile("measures=path_length")):
        page.reload()
    expect(page.get_by_label("Horizontal axis")).to_have_value("path_length", timeout=FAST)


def open_the_best(page: Page) -> None:
    plot = page.get_by_role("application", name=re.compile("Archive map"))
    reading = page.locator("#map-reading")
    plot.focus()
    page.wait_for_timeout(300)  # What was fetched is drawn.
    page.keyboard.press("ArrowRight")
    expect(reading).to_contain_text("Path length", timeout=FAST)
    page.keyboard.press("Enter")
    page.wait_for_url(re.compile("/creatures/[0-9a-f]{64}"), timeout=FAST)
    expect(page.get_by_role("group", name=re.compile("^Network:"))).to_be_visible(timeout=FAST)
    with page.expect_download(timeout=SLOW) as download:
        page.get_by_role("link", name="SVG").click()
    assert download.value.path().read_text().startswith("<svg")
