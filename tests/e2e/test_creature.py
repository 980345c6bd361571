"""A creature's page, by mouse and by keyboard alone, over a tiny run in a world with energy."""

import re

from pages import (
    TOUR_TAKEN,
    expect_in_url,
    film,
    picture,
    see_it_move,
    stage,
    the_map,
    wait_until_changed,
    wait_until_still,
)
from playwright.sync_api import Page, expect

SLOW = 300_000


def test_a_creature_is_watched_and_read(shared, page):
    run = shared.finished("voronoi")
    (sha, *_) = shared.product.get(f"runs/{run}/archive")["creature"]
    page.goto(f"{shared.product.url}/creatures/{sha}")
    expect(stage(page)).to_be_visible(timeout=SLOW)
    step_by_keyboard_alone(page)
    choose_what_is_shown(page)
    read_the_shape_over_time(page)


def step_by_keyboard_alone(page: Page) -> None:
    moment = page.get_by_role("slider", name="Time in the replay")
    page.keyboard.press("Space")
    expect(page.get_by_role("button", name="Play")).to_be_visible()
    paused = moment.input_value()
    for key in ("Home", "End", ",", "."):  # These are the page's, not the player's.
        page.keyboard.press(key)
    assert moment.input_value() == paused
    page.get_by_role("button", name="Play").focus()
    page.keyboard.press("Home")
    expect(moment).to_have_attribute("aria-valuetext", "step 0 of 40")
    wait_until_still(film(page))
    first = picture(film(page))
    for key in (".", ".", "ArrowRight", ",", "ArrowRight"):
        page.keyboard.press(key)
    expect(moment).to_have_attribute("aria-valuetext", "step 3 of 40")
    wait_until_changed(film(page), first)


def choose_what_is_shown(page: Page) -> None:
    for name, legend in (("Speed", "cells"), ("Energy", "density")):
        before = picture(film(page))
        page.get_by_role("button", name=name, exact=True).press("Enter")
        colours = page.get_by_role("img", name=re.compile(f"^{name} from .*{legend}"))
        expect(colours).to_be_visible()
        expect_in_url(page, f"field={name.lower()}")
        wait_until_changed(film(page), before)
    page.get_by_role("checkbox", name="Tracers").press("Space")
    expect(page.get_by_role("img", name=re.compile("tracers show its flow"))).to_be_visible()
    page.reload()
    expect(page.get_by_role("checkbox", name="Tracers")).to_be_checked(timeout=SLOW)
    energy = page.get_by_role("button", name="Energy", exact=True)
    expect(energy).to_have_attribute("aria-pressed", "true")


def read_the_shape_over_time(page: Page) -> None:
    angles = page.get_by_role("application", name="Rest angles (applied) over 40 steps")
    box = angles.bounding_box()
    assert box
    page.mouse.click(box["x"] + box["width"] / 2, box["y"] + 20)
    moment = page.get_by_role("slider", name="Time in the replay")
    expect(moment).to_have_attribute("aria-valuetext", "step 20 of 40")
    page.get_by_role("button", name="Lengths").click()
    page.get_by_role("application", name="Rest lengths (applied)").focus()
    page.keyboard.press("ArrowRight")
    expect(page.get_by_text(re.compile("^Step 21, edge .: rest .* %, actual"))).to_be_visible()
    expect(moment).to_have_attribute("aria-valuetext", "step 21 of 40")


def test_a_badge_becomes_the_verdict_of_the_audit(shared, page):
    run = shared.finished("voronoi")
    page.add_init_script(TOUR_TAKEN)
    page.goto(f"{shared.product.url}/runs/{run}")
    the_map(page).press("ArrowRight")
    measures = page.locator("#elite-measures")
    measures.get_by_role("link", name="not audited").click()
    page.wait_for_url(re.compile("/creatures/.*#audit$"))
    sha = page.url.partition("/creatures/")[2][:64]
    page.get_by_role("button", name="Run audit").click()
    badge = page.locator(".page-head").get_by_role("link", name=re.compile("^(not )?trusted$"))
    expect(badge).to_be_visible(timeout=SLOW)
    trusted = shared.product.get(f"creatures/{sha}/audit")["verdict"]["trusted"]
    expect(badge).to_have_text("✓trusted" if trusted else "✕not trusted")
    page.go_back()
    verdict = re.compile("^trusted$" if trusted else "^not trusted$")
    expect(measures.get_by_role("link", name=verdict)).to_be_visible()


def test_visitors_verify_a_creature_in_their_browser_and_let_it_swim_on(
    shared, page, anonymous_page
):
    address, run = shared.product.url, shared.finished("voronoi")
    (sha, *_) = shared.product.get(f"runs/{run}/archive")["creature"]
    share = page.request.post(f"{address}/api/v1/shares", data={"creature": sha}).json()
    sweep = shared.finished("sweep")
    rows = shared.product.get(f"runs/{sweep}/results")["rows"]
    (gait, *_) = [row["creature"] for row in rows if row["creature"]]
    for visitor, url in (
        (page, f"{address}/creatures/{sha}"),
        (page, f"{address}/creatures/{gait}?run={sweep}"),
        (anonymous_page, share["url"]),
    ):
        visitor.goto(url)
        card = visitor.get_by_role("region", name="Verification in this browser")
        card.get_by_role("button", name="Verify").click()
        same = re.compile(r"^All \d+ numbers equal the recorded ones, bit by bit\.")
        expect(card.get_by_text(same)).to_be_visible(timeout=SLOW)
    page.goto(f"{address}/creatures/{sha}")
    swim_on(page)


def swim_on(page: Page) -> None:
    card = page.get_by_role("region", name="Live water")
    card.get_by_role("button", name="Swim on").click()
    water = card.get_by_role("img", name="The creature swims in live water")
    expect(water).to_be_visible(timeout=SLOW)
    see_it_move(water)
    card.get_by_role("slider").first.fill("-0.5")
    expect(card.get_by_text("Viscosity 0.32")).to_be_visible()
    card.get_by_text("Let others join").click()
    card.get_by_role("button", name=re.compile("^Add [0-9a-f]{8}, fitness")).first.click()
    joined = re.compile("^[0-9a-f]{8} swims too.$")
    expect(card.get_by_role("status")).to_have_text(joined, timeout=SLOW)
    card.get_by_role("button", name="Stop").press("Enter")
    expect(water).to_be_hidden()
