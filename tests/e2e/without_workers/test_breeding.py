"""Breed by eye: choose in the gallery by keyboard, take back, and see when a choice counts."""

import re

import pytest
import reports
from layout import faults, violations
from pages import TOUR_TAKEN, elites
from playwright.sync_api import expect

from microcosmos.spec import parse
from server.attempts import choices
from server.attempts.claim import claim
from server.runs.submission import submit


@pytest.fixture
def attempt(idle):
    """An attempt that has recorded two generations with three elites."""
    document = reports.DEMO.model_dump(mode="json") | {"seed": 78}
    found = claim(idle.services, submit(idle.services, parse(document))[0].id, "worker 1")
    found.record_device("cpu, a processor")
    for generation, (cell, place) in enumerate({7: 0.01, 8: 0.04, 40: 0.2}.items(), 1):
        found.record(
            reports.report(generation, {cell: float(generation)}, (place, place), poses=True),
            1.0,
        )
    return found


def test_breed_by_eye(page, idle, attempt):
    page.add_init_script(TOUR_TAKEN)
    page.goto(f"{idle.product.url}/runs/{attempt.run_id}?view=gallery")
    expect(elites(page)).to_have_text("3 elites")
    gallery = page.get_by_role("application")
    gallery.focus()
    for key in ("ArrowRight", "Space", "Shift+ArrowLeft"):
        page.keyboard.press(key)
    bar = page.locator(".selection-bar")
    expect(bar.get_by_role("status")).to_have_text("2 creatures selected")
    breed = bar.get_by_role("button", name="Breed from these")
    breed.focus()
    page.keyboard.press("Enter")
    chosen = page.get_by_role("region", name="Chosen to breed")
    expect(chosen.get_by_role("heading", level=3)).to_have_text("From the next generation on")
    expect(chosen.get_by_role("link")).to_have_count(2)
    page.keyboard.press("Control+z")  # The note offers to undo.
    expect(chosen).to_have_count(0)

    gallery.focus()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("Space")
    bar.get_by_role("button", name="Breed from this").press("Enter")
    expect(chosen.get_by_role("link")).to_have_count(1)
    (file,) = choices.begin(attempt, 4)
    summary = {"chosen: children": 8, "chosen: inserted": 1, "chosen: improved": 0}
    attempt.record(reports.report(4, {41: 4.0}, (0.3, 0.3), summary=summary), 1.0)
    expect(chosen.get_by_role("heading", level=3)).to_have_text("From generation 4 on")
    expect(chosen).to_contain_text("8 of the last 16 offspring descend from them.")
    expect(chosen.get_by_role("button", name="Take back")).to_have_count(0)
    expect(page.get_by_text("Vertical lines mark the generations")).to_be_visible()
    page.set_viewport_size({"width": 390, "height": 844})
    page.wait_for_function("() => document.documentElement.scrollWidth <= innerWidth")
    assert faults(page) + violations(page) == []

    chosen.get_by_role("link").press("Enter")
    page.wait_for_url(re.compile(f"/creatures/{file['sha256']}"))
    page.get_by_role("button", name="Breed from this").press("Enter")
    page.get_by_role("button", name="Take back the choice").press("Enter")
    expect(page.get_by_role("button", name="Breed from this")).to_be_visible()
