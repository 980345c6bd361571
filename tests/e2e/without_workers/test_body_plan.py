"""Bodies that grow from plans: selected in the form of a new run, read on a creature's page."""

import re

from pages import ALL_SETTINGS
from plans import FINS, ROOT, plan_identity
from playwright.sync_api import Page, expect

from microcosmos.archive import creature

NO_ROOM = FINS | {"number": 2, "angle": 0.0, "mirrored": False}
"""Along the root, where the root is already."""


def test_an_encoding_with_plans_brings_a_body_that_grows(page, idle):
    page.add_init_script(ALL_SETTINGS)
    page.goto(f"{idle.product.url}/new?preset=quality-diversity/standard")
    encoding = choice(page, "Control", "Encoding")
    builder = choice(page, "Body", "Builder")
    encoding.select_option("body-graph")
    expect(builder).to_have_value("grown")
    expect(page.get_by_text("The builder is now grown")).to_be_visible()
    drawing = page.locator(".body-drawing")
    expect(drawing.get_by_role("img", name=re.compile("^Random plan"))).to_have_count(12)
    expect(drawing).to_contain_text("only the middle")
    builder.select_option("star")
    expect(encoding).to_have_value("cppn")
    expect(page.get_by_text("The encoding is now cppn")).to_be_visible()
    expect(drawing.get_by_role("img")).to_have_count(1)


def test_the_plan_of_a_creature_is_read_by_keyboard_alone(page, idle):
    file = creature.document(plan_identity(ROOT, FINS, NO_ROOM), None, None)
    answer = page.request.post(f"{idle.product.url}/api/v1/creatures", data=file)
    sha = answer.json()["creature"]
    page.goto(f"{idle.product.url}/creatures/{sha}")
    card = page.locator("#plan")
    fins = card.get_by_role("button", name=re.compile("^Segment 2: 4 nodes"))
    expect(card.get_by_role("button", name=re.compile("^Segment "))).to_have_count(2)
    card.get_by_role("button", name=re.compile("^Segment 1")).focus()
    page.keyboard.press("Tab")
    expect(fins).to_be_focused()
    expect(fins).to_have_attribute("aria-pressed", "true")
    about = card.locator(".plan-about")
    expect(about).to_have_text(
        "Segment 2: 4 nodes, at 50 % of segment 1 (root), angle 90°, curl 0°, stiffness 1, "
        "mirrored, 2 in the body."
    )
    row = card.get_by_role("row", name=re.compile("no room"))
    row.get_by_role("button", name="3").focus()
    expect(about).to_contain_text("no room")


def choice(page: Page, group: str, name: str):
    return page.get_by_role("group", name=group, exact=True).get_by_label(name, exact=True)
