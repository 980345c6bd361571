"""The page of a run; what a worker would write is written here."""

import io
import re
import zipfile

import made_archives
import pyarrow.parquet as pq
import pytest
import reports
from layout import faults, violations
from pages import TOUR_TAKEN, elites, expect_in_url, picture, the_map, wait_until_changed
from playwright.sync_api import Locator, Page, expect
from written_run import GENERATIONS, WrittenRun

from microcosmos.spec import parse
from microcosmos_server.attempts.attempt import begin_choices
from microcosmos_server.attempts.claim import claim
from microcosmos_server.runs.submission import submit


def test_a_run_is_shown_from_the_queue_to_its_end_and_compared(page, idle):
    other = WrittenRun(idle.services, 7)
    other.claim("worker 1")
    other.write_generations(1, GENERATIONS)
    other.attempt.finish()
    run = WrittenRun(idle.services, 8)
    page.goto(f"{idle.product.url}/runs/{run.id}")
    page.evaluate("window.neverReloaded = true")
    watch_it_begin(page, run)
    type_labels_while_it_goes_on(page, run)
    follow_the_log(page, run)
    see_species_and_the_best_network(page)
    see_why_evaluations_are_infeasible(page)
    choose_how_curves_are_drawn_and_compare(page, other)
    see_what_differs_in_the_spec(page, other)
    assert page.evaluate("window.neverReloaded")
    walk_by_keyboard(page)


def watch_it_begin(page: Page, run: WrittenRun) -> None:
    # The page shows the reason once.
    expect(page.get_by_role("status").get_by_text("No worker is alive")).to_have_count(1)
    run.claim("worker 1")
    expect(page.get_by_text("up to a minute on a CPU")).to_be_visible()
    run.write_generations(1, 3)
    expect(page.get_by_text("up to a minute on a CPU")).to_have_count(0)


def type_labels_while_it_goes_on(page: Page, run: WrittenRun) -> None:
    field = page.get_by_role("region", name="Scheduling").get_by_label("Labels")
    field.press_sequentially("gpu, ")
    run.write_generations(4, 4)
    expect(page.get_by_role("region", name="Status")).to_contain_text(f"4 / {GENERATIONS}")
    field.press_sequentially("big")
    for labels in (["gpu", "big"], []):
        with page.expect_response(lambda answer: answer.request.method == "PATCH") as answer:
            field.press("Enter")
        assert answer.value.json()["labels"] == labels
        field.fill("")


def follow_the_log(page: Page, run: WrittenRun) -> None:
    log = page.get_by_role("region", name="Log")
    run.attempt.fail("ZeroDivisionError: twice nothing", "Traceback:\n  File x")
    run.claim("worker 2")
    run.write_generations(5, GENERATIONS)
    run.attempt.finish()
    entries = log.get_by_role("listitem")
    expect(entries.first).to_contain_text("Finished.")
    expect(log.get_by_text("from the checkpoint of generation 4")).to_be_visible()
    log.get_by_label("Show").select_option("error")
    expect_in_url(page, "level=error")
    expect(entries).to_have_count(1)
    entries.get_by_text("ZeroDivisionError: twice nothing").first.click()
    expect(log.get_by_text("File x")).to_be_visible()
    log.get_by_label("Show").select_option("info")


def see_species_and_the_best_network(page: Page) -> None:
    plot = page.get_by_role("application", name=re.compile("^Species over generations"))
    plot.focus()
    page.keyboard.press("Home")
    reading = page.locator("#species-at-cursor")
    expect(reading).to_have_text("Generation 1: 2 species; largest: species 0 10, species 1 6")
    best = page.get_by_role("region", name="Best network so far")
    expect(best).to_contain_text(f"fitness {GENERATIONS}")
    expect(best.get_by_role("img", name=re.compile("^Network: 7 nodes"))).to_be_visible()


def see_why_evaluations_are_infeasible(page: Page) -> None:
    table = page.get_by_role("table", name=re.compile("^Infeasible evaluations"))
    expect(table.get_by_role("row", name=re.compile("Non-finite"))).to_contain_text("24")
    row = table.get_by_role("row", name=re.compile("Supersonic"))
    expect(row).to_contain_text("12")
    expect(row).to_contain_text("exceeded the speed of sound")


def curve(page: Page) -> Locator:
    return page.locator("#curves canvas").first


def choose_how_curves_are_drawn_and_compare(page: Page, other: WrittenRun) -> None:
    curves = page.get_by_role("region", name="Curves")
    score = curves.get_by_role("img", name=re.compile("^QD score"))
    expect(score).to_have_attribute("aria-label", "QD score over generations: now 144")
    raw = picture(curve(page))
    curves.get_by_label("Log scale").check()
    wait_until_changed(curve(page), raw)
    alone = picture(curve(page))
    curves.get_by_role("button", name="Compare with a run").click()
    curves.get_by_label("Compare with a run").select_option(str(other.id))
    curves.get_by_role("button", name="Compare", exact=True).click()
    expect(curves.get_by_role("link", name=re.compile(str(other.id)[:8]))).to_be_visible()
    wait_until_changed(curve(page), alone)
    for word in ("log=1", f"with={other.id}"):
        expect_in_url(page, word)


def see_what_differs_in_the_spec(page: Page, other: WrittenRun) -> None:
    card = page.get_by_role("region", name="Spec", exact=True)
    expect(card).to_contain_text("1 field differs from preset Demo")
    card.get_by_role("button", name="Compare specs").click()
    card.get_by_label("Compare specs").select_option(str(other.id))
    card.get_by_role("button", name="Compare", exact=True).click()
    found = card.get_by_role("region", name="Differences from another run")
    expect(found.get_by_role("row", name=re.compile("Seed"))).to_have_text("Seed87")
    page.get_by_role("button", name="Close differences").click()
    expect_in_url(page, "against=", False)


def walk_by_keyboard(page: Page) -> None:
    parts = page.get_by_role("navigation", name="Sections of this page")
    parts.get_by_role("link", name="Log").focus()
    page.keyboard.press("Enter")
    page.keyboard.press("Tab")
    expect(page.get_by_role("region", name="Log").get_by_label("Show")).to_be_focused()


FRONTS = {"kind": "fronts", "measure": "cost_of_transport", "size": 8}
COSTS = {1: 2.0, 2: 1.0, 3: 8.0}
"""Cost of transport of the elite of each generation."""


def test_a_front_is_listed_and_an_emptied_place_disappears_live_and_in_the_history(page, idle):
    document = reports.DEMO.model_dump(mode="json") | {"seed": 77}
    document["archive"]["container"] = FRONTS
    run = submit(idle.services, parse(document))[0]
    attempt = claim(idle.services, run.id, "worker 1")
    for generation, place, descriptors in ((1, 9, (1, 1)), (2, 700, (1, 1)), (3, 2, (100, 4))):
        cost = {"cost_of_transport": COSTS[generation]}
        fitness = {place: float(5 - generation)}
        attempt.record(reports.report(generation, fitness, descriptors, cost, poses=True), 1.0)
    page.add_init_script(TOUR_TAKEN)
    page.goto(f"{idle.product.url}/runs/{run.id}")
    expect(elites(page)).to_have_text("3 elites")
    expect(page.get_by_text("2,048 places, Pareto fronts")).to_be_visible()
    the_map(page).focus()
    page.keyboard.press("ArrowRight")  # To the best elite.
    listed = page.get_by_role("region", name="Elites at this position").get_by_role("button")
    expect(listed).to_have_text(
        [re.compile(r"Fitness 4 Cost of transport 2"), re.compile(r"Fitness 3 .* 1$")]
    )
    listed.nth(1).click()
    expect(page.locator("#elite-measures")).to_contain_text("Fitness 3")
    attempt.record(reports.report(4, {3: 9.0}, (1, 1), emptied=(9, 700)), 1.0)
    expect(elites(page)).to_have_text("2 elites")
    for generation, number in ((2, 2), (3, 3)):
        page.get_by_role("slider", name="Generation shown").fill(str(generation))
        expect(elites(page)).to_have_text(f"{number} elites")


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
    begin_choices(attempt, 4)
    summary = {
        "emitter.chosen.children": 8,
        "emitter.chosen.inserted": 1,
        "emitter.chosen.improved": 0,
    }
    attempt.record(reports.report(4, {41: 4.0}, (0.3, 0.3), summary=summary), 1.0)
    expect(chosen.get_by_role("heading", level=3)).to_have_text("From generation 4 on")
    expect(chosen).to_contain_text("8 of the last 16 offspring descend from them.")
    expect(chosen.get_by_role("button", name="Take back")).to_have_count(0)
    expect(page.get_by_text("Vertical lines mark the generations")).to_be_visible()
    page.set_viewport_size({"width": 390, "height": 844})
    page.wait_for_function("() => document.documentElement.scrollWidth <= innerWidth")
    assert faults(page) + violations(page) == []


def test_a_run_is_downloaded_in_a_chosen_format_with_si_units(page, idle):
    document = reports.DEMO.model_dump(mode="json") | {"seed": 91}
    run = submit(idle.services, parse(document))[0]
    attempt = claim(idle.services, run.id, "worker 1")
    attempt.record(reports.report(1, {5: 1.0, 6: 2.0}, poses=True), 1.0)
    attempt.save(1, made_archives.made())
    page.add_init_script(TOUR_TAKEN)
    page.goto(f"{idle.product.url}/runs/{run.id}")
    card = page.locator("#files")
    card.get_by_text("Export", exact=True).click()
    expect(card.get_by_role("listitem")).to_have_count(6)
    parquet = card.get_by_role("button", name="Parquet")
    card.get_by_label("Body length").fill("1")
    expect(card.get_by_text("Body length must be a number above 0 with a unit")).to_be_visible()
    expect(parquet).to_have_attribute("aria-disabled", "true")
    card.get_by_label("Body length").fill("1 mm")
    card.get_by_label("Stroke").fill("0.5 s")
    with page.expect_download() as coming:
        parquet.click()
    name = f"quality-diversity-{str(run.id)[:8]}-parquet"
    assert coming.value.suggested_filename == f"{name}.zip"
    with zipfile.ZipFile(io.BytesIO(coming.value.path().read_bytes())) as whole:
        schema = pq.read_schema(io.BytesIO(whole.read(f"{name}/archive.parquet")))
    assert schema.field("speed_si").metadata[b"unit"] == b"m/s"


def test_cancelling_acts_at_once_and_can_be_undone(page, new_page, idle):
    run = submit(idle.services, parse({"experiment": "quality-diversity", "seed": 31}))[0]
    address = f"{idle.product.url}/runs/{run.id}"
    page.goto(address)
    cancel = page.get_by_role("button", name=re.compile("^Cancel"))
    cancel.click()
    page.get_by_role("button", name="Undo").click()
    expect(cancel).to_be_visible()
    assert idle.product.get(f"runs/{run.id}")["status"] == "queued"
    left = new_page()
    left.goto(address)
    with left.expect_request(re.compile("/cancel$")):
        left.get_by_role("button", name=re.compile("^Cancel")).click()
    left.close()
    idle.product.wait(str(run.id), "cancelled", seconds=30)
    expect(cancel).to_have_count(0)


def test_many_tabs_share_a_stream_and_all_are_served(page, idle):
    """A browser opens six connections to a host, for all of its tabs."""
    run = submit(idle.services, parse({"experiment": "quality-diversity", "seed": 32}))[0]
    address = f"{idle.product.url}/runs/{run.id}"
    tabs = [page, *(page.context.new_page() for _ in range(8))]
    for number, tab in enumerate(tabs):
        tab.goto(address if number else idle.product.url)
        expect(tab.get_by_role("button", name=re.compile("^Cancel")).first).to_be_visible()
    idle.product.http.patch(f"/api/v1/runs/{run.id}", json={"name": "shared by tabs"})
    for tab in tabs:
        expect(tab.get_by_text("shared by tabs").first).to_be_visible()
