"""A creature's page, by mouse and by keyboard alone, over a tiny run in a world with energy."""

import re
from io import BytesIO

import h5py
from drive import Installation
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


def test_a_creature_is_watched_read_and_kept(shared, page):
    address = shared.product.url
    sha, parent = child_and_parent(shared.product, shared.finished("voronoi"))
    page.goto(f"{address}/creatures/{sha}")
    expect(stage(page)).to_be_visible(timeout=SLOW)
    step_by_keyboard_alone(page)
    choose_what_is_shown(page)
    read_the_shape_over_time(page)
    see_what_the_network_computes(page)
    download_as_hdf5(page, sha)
    walk_to_a_parent_and_back(page, sha, parent)


def test_a_badge_becomes_the_verdict_of_the_audit(shared, page, anonymous_page):
    address, run = shared.product.url, shared.finished("voronoi")
    page.add_init_script(TOUR_TAKEN)
    page.goto(f"{address}/runs/{run}")
    the_map(page).press("ArrowRight")
    measures = page.locator("#elite-measures")
    measures.get_by_role("link", name="not audited").click()
    page.wait_for_url(re.compile("/creatures/.*#audit$"))
    sha = page.url.partition("/creatures/")[2][:64]
    head = page.locator(".page-head")
    expect(head.get_by_role("link", name="not audited")).to_be_visible()
    page.get_by_role("button", name="Run audit").click()
    badge = head.get_by_role("link", name=re.compile("^(not )?trusted$"))
    expect(badge).to_be_visible(timeout=SLOW)
    trusted = shared.product.get(f"creatures/{sha}/audit")["verdict"]["trusted"]
    verdict = re.compile("^trusted$" if trusted else "^not trusted$")
    shown = "✓trusted" if trusted else "✕not trusted"
    expect(badge).to_have_text(shown)
    badge.hover()
    expect(page.get_by_role("tooltip")).to_contain_text("The physics check of one creature.")
    page.go_back()
    expect(measures.get_by_role("link", name=verdict)).to_be_visible()
    share = page.request.post(f"{address}/api/v1/shares", data={"creature": sha}).json()
    page.goto(f"{address}/shares")
    page.get_by_role("link", name=verdict).first.click()  # The newest share.
    expect(page.get_by_role("region", name="Physics audit")).to_be_in_viewport()
    expect(page.get_by_role("region", name="Figures of the audit")).to_be_visible()
    anonymous_page.goto(share["url"])
    expect(anonymous_page.locator(".page-head .badge")).to_have_text(shown)


def test_visitors_verify_a_creature_in_their_browser(shared, page, anonymous_page):
    address, run = shared.product.url, shared.finished("voronoi")
    (sha, *_) = shared.product.get(f"runs/{run}/archive")["creature"]
    share = page.request.post(f"{address}/api/v1/shares", data={"creature": sha}).json()
    measured = shared.product.get(f"creatures/{sha}")["measured"]
    for visitor, url in ((page, f"{address}/creatures/{sha}"), (anonymous_page, share["url"])):
        visitor.goto(url)
        card = visitor.get_by_role("region", name="Verification in this browser")
        card.get_by_role("button", name="Verify").click()
        same = (
            f"All {1 + len(measured['measures'])} numbers equal the recorded ones, bit by bit."
        )
        expect(card.get_by_text(same)).to_be_visible(timeout=SLOW)
        expect(card.get_by_text(re.compile("^40 steps in .* s: .* steps/s.$"))).to_be_visible()
        speed = card.get_by_role("row", name=re.compile("^Speed same bits"))
        expect(speed).to_be_visible()


def test_a_hand_made_gait_is_verified_and_swims_on(shared, page):
    address, run = shared.product.url, shared.finished("sweep")
    rows = shared.product.get(f"runs/{run}/results")["rows"]
    swimmers = [row["creature"] for row in rows if row["creature"]]
    for sha in (swimmers[0], swimmers[-1]):
        page.goto(f"{address}/creatures/{sha}?run={run}")
        card = page.get_by_role("region", name="Verification in this browser")
        card.get_by_role("button", name="Verify").click()
        same = "All 14 numbers equal the recorded ones, bit by bit."
        expect(card.get_by_text(same)).to_be_visible(timeout=SLOW)
        cycle = re.compile("^Displacement along x in the last cycle same bits")
        expect(card.get_by_role("row", name=cycle)).to_be_visible()
    live = page.get_by_role("region", name="Live water")
    live.get_by_role("button", name="Swim on").click()
    water = live.get_by_role("img", name="The creature swims in live water")
    expect(water).to_be_visible(timeout=SLOW)
    see_it_move(water)


def test_a_creature_swims_on_in_live_water(shared, page):
    address, run = shared.product.url, shared.finished("voronoi")
    (sha, *_) = shared.product.get(f"runs/{run}/archive")["creature"]
    page.goto(f"{address}/creatures/{sha}")
    card = page.get_by_role("region", name="Live water")
    card.get_by_role("button", name="Swim on").click()
    water = card.get_by_role("img", name="The creature swims in live water")
    expect(water).to_be_visible(timeout=SLOW)
    see_it_move(water)
    viscosity, stroke = card.get_by_role("slider").all()
    viscosity.fill("-0.5")
    expect(card.get_by_text("Viscosity 0.32")).to_be_visible()
    stroke.fill("0.5")
    expect(card.get_by_text("Stroke 0.5 ×")).to_be_visible()
    card.get_by_role("button", name="Speed").press("Enter")
    card.get_by_role("button", name="Dye").press("Enter")
    card.get_by_role("button", name="Push the water").press("Enter")
    card.get_by_role("button", name="Pull the body").press("Enter")
    card.get_by_text("Let others join").click()
    card.get_by_role("button", name=re.compile("^Add [0-9a-f]{8}, fitness")).first.click()
    expect(card.get_by_role("status")).to_have_text(
        re.compile("^[0-9a-f]{8} swims too.$"), timeout=SLOW
    )
    page.wait_for_timeout(500)
    expect(card.get_by_role("button", name="Stop")).to_be_visible()
    card.get_by_role("button", name="Stop").press("Enter")
    expect(water).to_be_hidden()


def child_and_parent(product: Installation, run: str) -> tuple[str, str]:
    """An elite and a parent of it that is kept."""
    for sha in product.get(f"runs/{run}/archive")["creature"]:
        found = product.get(f"creatures/{sha}/ancestors")["items"]
        if found and found[0]["stored"]:
            return sha, found[0]["creature"]
    raise AssertionError("no elite has a parent that is kept")


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
    page.keyboard.press("End")
    expect(moment).to_have_attribute("aria-valuetext", "step 40 of 40")
    page.get_by_role("button", name="Previous frame").press("Enter")
    expect(moment).to_have_attribute("aria-valuetext", "step 39 of 40")


def next_picture(page: Page, before: str) -> str:
    wait_until_changed(film(page), before)
    wait_until_still(film(page))
    return picture(film(page))


def choose_what_is_shown(page: Page) -> None:
    shown = [picture(film(page))]
    for name, legend in (("Speed", "cells"), ("Energy", "density")):
        page.get_by_role("button", name=name, exact=True).press("Enter")
        colours = page.get_by_role("img", name=re.compile(f"^{name} from .*{legend}"))
        expect(colours).to_be_visible()
        expect_in_url(page, f"field={name.lower()}")
        shown.append(next_picture(page, shown[-1]))
    page.get_by_role("checkbox", name="Tracers").press("Space")
    expect(page.get_by_role("img", name=re.compile("tracers show its flow"))).to_be_visible()
    shown.append(next_picture(page, shown[-1]))
    page.get_by_role("checkbox", name="Follow").uncheck()
    shown.append(next_picture(page, shown[-1]))
    assert len(set(shown)) == 5, "every choice changes the picture"
    page.reload()
    expect(page.get_by_role("checkbox", name="Tracers")).to_be_checked(timeout=SLOW)
    expect(page.get_by_role("checkbox", name="Follow")).not_to_be_checked()
    energy = page.get_by_role("button", name="Energy", exact=True)
    expect(energy).to_have_attribute("aria-pressed", "true")


def read_the_shape_over_time(page: Page) -> None:
    angles = page.get_by_role("application", name="Rest angles (applied) over 40 steps")
    box = angles.bounding_box()
    assert box
    # The last of 41 frames and of 6 joints is in the upper right corner.
    page.mouse.move(box["x"] + box["width"] - 2, box["y"] + 2)
    expect(page.get_by_text(re.compile("^Step 40, joint 6: rest .* rad, act"))).to_be_visible()
    page.mouse.click(box["x"] + box["width"] / 2, box["y"] + 20)
    moment = page.get_by_role("slider", name="Time in the replay")
    expect(moment).to_have_attribute("aria-valuetext", "step 20 of 40")
    page.get_by_role("button", name="Lengths").click()
    page.get_by_role("application", name="Rest lengths (applied)").focus()
    page.keyboard.press("ArrowUp")
    expect(page.get_by_text(re.compile("^Step 20, edge 1: rest .* %, actual"))).to_be_visible()
    page.keyboard.press("ArrowRight")
    expect(page.get_by_text(re.compile("^Step 21, edge 1: rest .* %, actual"))).to_be_visible()
    expect(moment).to_have_attribute("aria-valuetext", "step 21 of 40")


def see_what_the_network_computes(page: Page) -> None:
    for name in ("rest angle", "rest length"):
        expect(page.get_by_role("application", name=f"Output of {name}")).to_be_visible()
    hidden = page.get_by_role("button", name=re.compile("^position.*: show output"))
    hidden.focus()
    expect(hidden).to_have_attribute("aria-pressed", "true")
    expect(page.get_by_role("application", name="Output of position")).to_be_visible()


def download_as_hdf5(page: Page, sha: str) -> None:
    with page.expect_download(timeout=SLOW) as download:
        page.get_by_role("link", name="HDF5").click()
    assert download.value.suggested_filename == f"creature-{sha[:12]}.h5"
    with h5py.File(BytesIO(download.value.path().read_bytes()), "r") as file:
        assert bytes(file.attrs["sha256"]).decode() == sha
        assert file["body/positions"].shape == (8, 2)


def walk_to_a_parent_and_back(page: Page, sha: str, parent: str) -> None:
    family = page.get_by_role("region", name="Parents and children")
    expect(family.get_by_text("Parents", exact=True)).to_be_visible()
    family.get_by_role("link", name=re.compile(f"^{parent[:8]}, fitness")).press("Enter")
    page.wait_for_url(re.compile(f"/creatures/{parent}"))
    back = page.get_by_role("link", name=re.compile(f"^{sha[:8]}, fitness"))
    expect(back).to_be_visible(timeout=SLOW)
    back.press("Enter")
    page.wait_for_url(re.compile(f"/creatures/{sha}"))
    expect(stage(page)).to_be_visible(timeout=SLOW)


def test_the_numbers_of_swimming_stand_together(shared, page):
    sha, _ = child_and_parent(shared.product, shared.finished("voronoi"))
    page.goto(f"{shared.product.url}/creatures/{sha}")
    flow = page.locator("#facts").get_by_role("heading", name="Flow", exact=True).locator("..")
    for name in ("Reynolds number", "Strouhal number", "Sperm number", "Mach number"):
        expect(flow).to_contain_text(name, timeout=SLOW)
    flow.get_by_text("Sperm number").hover()
    expect(page.get_by_role("tooltip")).to_contain_text("Below 1 it follows")


def test_a_real_length_and_period_give_physical_units_and_are_remembered(shared, page):
    sha, _ = child_and_parent(shared.product, shared.finished("voronoi"))
    page.goto(f"{shared.product.url}/creatures/{sha}")
    units = page.locator(".physical")
    expect(units).to_contain_text("Give a body length", timeout=SLOW)
    length, period = units.get_by_label("Body length"), units.get_by_label("Stroke")
    length.fill("1 mile")
    expect(length).to_have_attribute("aria-invalid", "true")
    expect(units).to_contain_text("Body length must be a number above 0 with a unit")
    length.fill("1 mm")
    period.fill("0.5 s")
    viscosity = units.locator("dl > div", has_text="Kinematic viscosity")
    expect(viscosity).to_contain_text(re.compile(r"\d mm²/s, \S"))
    page.reload()
    expect(viscosity).to_be_visible(timeout=SLOW)
    expect(length).to_have_value("1 mm")
