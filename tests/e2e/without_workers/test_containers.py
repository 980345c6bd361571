"""The archive of a run with a container: listed fronts, and places that are emptied live."""

import re

import pytest
import reports
from pages import TOUR_TAKEN, elites, the_map
from playwright.sync_api import expect

from microcosmos.spec import parse
from server.attempts.claim import claim
from server.runs.submission import submit

FRONTS = {"kind": "fronts", "measure": "cost_of_transport", "size": 8}
COSTS = {1: 2.0, 2: 1.0, 3: 8.0}
"""Cost of transport of the elite of each generation."""


@pytest.fixture
def fronts(idle):
    """An attempt that has recorded a front of two in one cell, and an elite in another."""
    document = reports.DEMO.model_dump(mode="json") | {"seed": 77}
    document["archive"]["container"] = FRONTS
    run = submit(idle.services, parse(document))[0]
    attempt = claim(idle.services, run.id, "worker 1")
    attempt.record_device("cpu, a processor")
    for generation, place, descriptors in ((1, 9, (1, 1)), (2, 700, (1, 1)), (3, 2, (100, 4))):
        cost = {"cost_of_transport": COSTS[generation]}
        fitness = {place: float(5 - generation)}
        attempt.record(reports.report(generation, fitness, descriptors, cost, poses=True), 1.0)
    return attempt


def test_the_elites_of_a_front_are_listed_and_shown(page, idle, fronts):
    page.add_init_script(TOUR_TAKEN)
    page.goto(f"{idle.product.url}/runs/{fronts.run_id}")
    expect(elites(page)).to_have_text("3 elites")
    expect(page.get_by_text("2,048 places, Pareto fronts")).to_be_visible()
    the_map(page).focus()
    page.keyboard.press("ArrowRight")  # To the best elite.
    listed = page.get_by_role("region", name="Elites at this position").get_by_role("button")
    expect(listed).to_have_text(
        [re.compile(r"Fitness 4 Cost of transport 2"), re.compile(r"Fitness 3 .* 1$")]
    )
    reading = page.locator("#elite-measures")
    expect(reading).to_contain_text("Fitness 4")
    listed.nth(1).click()
    expect(listed.nth(1)).to_have_attribute("aria-pressed", "true")
    expect(reading).to_contain_text("Fitness 3")
    expect(reading).to_contain_text("one of 2 at this position")
    page.wait_for_url(re.compile("cell=700"))
    name = reading.locator("code").inner_text()
    the_map(page).press("Enter")
    page.wait_for_url(re.compile(f"/creatures/{name}"))


def test_a_click_lists_several_elites_and_opens_the_only_one(page, idle, fronts):
    page.add_init_script(TOUR_TAKEN)
    page.goto(f"{idle.product.url}/runs/{fronts.run_id}")
    box = the_map(page).bounding_box()
    the_map(page).focus()
    page.keyboard.press("ArrowRight")
    points = page.locator(".map-mark polygon").last.get_attribute("points").split()
    x, y = (sum(float(p.split(",")[k]) for p in points) / len(points) for k in (0, 1))
    page.goto(f"{idle.product.url}/runs/{fronts.run_id}")
    place = {"x": x * box["width"], "y": y * box["height"]}
    listed = page.get_by_role("region", name="Elites at this position").get_by_role("button")
    the_map(page).click(position=place)
    expect(listed).to_have_count(2)
    the_map(page).click(position=place)
    page.wait_for_url(re.compile("/creatures/"))


def test_an_emptied_place_disappears_live_and_in_the_history(page, idle, fronts):
    page.add_init_script(TOUR_TAKEN)
    page.goto(f"{idle.product.url}/runs/{fronts.run_id}")
    expect(elites(page)).to_have_text("3 elites")
    fronts.record(reports.report(4, {3: 9.0}, (1, 1), emptied=(9, 700)), 1.0)
    expect(elites(page)).to_have_text("2 elites")
    for generation, number in ((2, 2), (3, 3), (1, 1)):
        page.get_by_role("slider", name="Generation shown").fill(str(generation))
        expect(elites(page)).to_have_text(f"{number} elites")
    page.get_by_role("button", name="Newest").click()
    expect(elites(page)).to_have_text("2 elites")
    page.wait_for_url(lambda url: "at=" not in url)  # The address follows with a delay.
    page.reload()
    expect(elites(page)).to_have_text("2 elites")
