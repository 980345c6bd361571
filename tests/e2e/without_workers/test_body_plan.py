"""The plan of a body that grew, on a creature's page."""

import re

from plans import FINS, ROOT, plan_identity
from playwright.sync_api import expect

from microcosmos.archive import creature


def test_the_plan_of_a_creature_is_read_by_keyboard_alone(page, idle):
    file = creature.document(plan_identity(ROOT, FINS), None, None)
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
