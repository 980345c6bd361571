"""The page of a run around its archive; what a worker would write is written here."""

import re

from pages import expect_in_url, picture, wait_until_changed
from playwright.sync_api import Locator, Page, expect
from written_run import GENERATIONS, WrittenRun

from microcosmos.spec import EXPERIMENTS


def test_a_run_is_shown_from_the_queue_to_its_end_and_compared(page, idle):
    services, address = idle.services, idle.product.url
    other = WrittenRun(services, 7)
    other.claim("worker 1")
    other.write_generations(1, GENERATIONS)
    other.attempt.finish()
    run = WrittenRun(services, 8)
    page.goto(f"{address}/runs/{run.id}")
    page.evaluate("window.neverReloaded = true")
    watch_it_begin(page, run)
    follow_the_log(page, run)
    see_species_and_the_best_network(page, run)
    see_why_evaluations_infeasible(page)
    choose_how_curves_are_drawn(page)
    compare_with_another_run(page, other)
    see_what_differs_in_the_spec(page, other)
    assert page.evaluate("window.neverReloaded")
    reload_and_close_comparisons(page, other)
    walk_by_keyboard(page)


def watch_it_begin(page: Page, run: WrittenRun) -> None:
    # The page shows the reason once.
    expect(page.get_by_role("status").get_by_text("No worker is alive")).to_have_count(1)
    run.claim("worker 1")
    expect(page.get_by_text("up to a minute on a CPU")).to_be_visible()
    elapsed = page.locator(".activity .quiet")
    before = elapsed.inner_text()
    expect(elapsed).not_to_have_text(before)
    run.write_generations(1, 4)
    expect(page.get_by_text("up to a minute on a CPU")).to_have_count(0)


def follow_the_log(page: Page, run: WrittenRun) -> None:
    log = page.get_by_role("region", name="Log")
    run.attempt.fail("Traceback:\n  File x\nZeroDivisionError: twice nothing")
    run.claim("worker 2")
    run.write_generations(5, GENERATIONS)
    run.attempt.finish()
    expect(log.get_by_text("Finished.")).to_be_visible()
    entries = log.get_by_role("listitem")
    expect(entries.first).to_contain_text("Finished.")
    expect(entries.last).to_contain_text("Submitted: neuroevolution")
    expect(log.get_by_text("from the checkpoint of generation 4")).to_be_visible()
    log.get_by_label("Show").select_option("error")
    expect_in_url(page, "level=error")
    expect(entries).to_have_count(1)
    entries.get_by_text("ZeroDivisionError: twice nothing").first.click()
    expect(log.get_by_text("File x")).to_be_visible()
    page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    log.get_by_role("button", name="Copy").click()
    expect(page.get_by_text("Log copied.")).to_be_visible()
    assert "File x\nZeroDivisionError" in page.evaluate("navigator.clipboard.readText()")
    log.get_by_label("Show").select_option("info")


def see_species_and_the_best_network(page: Page, run: WrittenRun) -> None:
    plot = page.get_by_role("application", name=re.compile("^Species over generations"))
    expect(plot).to_have_attribute("aria-label", re.compile("2 in all"))
    reading = page.locator("#species-at-cursor")
    plot.focus()
    page.keyboard.press("Home")
    expect(reading).to_have_text("Generation 1: 2 species; largest: species 0 10, species 1 6")
    page.keyboard.press("End")
    expect(reading).to_contain_text(f"Generation {GENERATIONS}: 1 species")
    box = plot.bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + 60, box["y"] + 0.75 * box["height"])
    expect(reading).to_contain_text("species 0, 10 members, of 2 species")
    best = page.get_by_role("region", name="Best network so far")
    expect(best).to_contain_text(f"fitness {GENERATIONS}")
    expect(best.get_by_role("img", name=re.compile("^Network: 7 nodes"))).to_be_visible()


def see_why_evaluations_infeasible(page: Page) -> None:
    table = page.get_by_role("table", name=re.compile("^Infeasible evaluations"))
    expect(table.get_by_role("row", name=re.compile("Non-finite"))).to_contain_text("24")
    row = table.get_by_role("row", name=re.compile("Supersonic"))
    expect(row).to_contain_text("12")
    expect(row).to_contain_text("exceeded the speed of sound")
    expect(page.get_by_role("img", name=re.compile("^Infeasible so far"))).to_be_visible()


def choose_how_curves_are_drawn(page: Page) -> None:
    curves = page.get_by_role("region", name="Curves")
    score = curves.get_by_role("img", name=re.compile("^QD score"))
    expect(score).to_have_attribute("aria-label", "QD score over generations: now 144")
    raw = picture(curve(page))
    curves.get_by_label("Log scale").check()
    wait_until_changed(curve(page), raw)
    curves.get_by_label("Smoothing").select_option("5")
    expect(score).to_have_attribute("aria-label", re.compile("now 102"))
    curves.get_by_role("combobox", name=re.compile("^X axis")).select_option("evaluations")
    expect(score).to_have_attribute("aria-label", re.compile("^QD score over evaluations"))
    for word in ("log=1", "smooth=5", "over=evaluations"):
        expect_in_url(page, word)


def curve(page: Page) -> Locator:
    return page.locator("#curves canvas").first


def compare_with_another_run(page: Page, other: WrittenRun) -> None:
    curves = page.get_by_role("region", name="Curves")
    alone = picture(curve(page))
    curves.get_by_role("button", name="Compare with a run").click()
    curves.get_by_label("Compare with a run").select_option(str(other.id))
    curves.get_by_role("button", name="Compare", exact=True).click()
    expect(curves.get_by_role("link", name=re.compile(str(other.id)[:8]))).to_be_visible()
    wait_until_changed(curve(page), alone)
    score = curves.get_by_role("img", name=re.compile(f"^QD score .*{str(other.id)[:8]}"))
    expect(score).to_be_visible()
    expect_in_url(page, f"with={other.id}")


def see_what_differs_in_the_spec(page: Page, other: WrittenRun) -> None:
    card = page.get_by_role("region", name="Spec", exact=True)
    expect(card).to_contain_text("1 field differs from preset Demo")
    card.get_by_role("button", name="Compare specs").click()
    card.get_by_label("Compare specs").select_option(str(other.id))
    card.get_by_role("button", name="Compare", exact=True).click()
    found = card.get_by_role("region", name="Differences from another run")
    expect(found.get_by_role("row", name=re.compile("Seed"))).to_have_text("Seed87")
    expect_in_url(page, f"against={other.id}")


def reload_and_close_comparisons(page: Page, other: WrittenRun) -> None:
    page.reload()
    curves = page.get_by_role("region", name="Curves")
    expect(curves.get_by_label("Log scale")).to_be_checked()
    expect(curves.get_by_label("Smoothing")).to_have_value("5")
    expect(curves.get_by_role("link", name=re.compile(str(other.id)[:8]))).to_be_visible()
    curves.get_by_role("button", name=re.compile("^Remove")).click()
    expect_in_url(page, "with=", False)
    page.get_by_role("button", name="Close differences").click()
    expect_in_url(page, "against=", False)


def walk_by_keyboard(page: Page) -> None:
    parts = page.get_by_role("navigation", name="Sections of this page")
    parts.get_by_role("link", name="Log").focus()
    page.keyboard.press("Enter")
    page.keyboard.press("Tab")
    expect(page.get_by_role("region", name="Log").get_by_label("Show")).to_be_focused()
    parts.get_by_role("link", name="Spec", exact=True).focus()
    page.keyboard.press("Enter")
    page.keyboard.press("Tab")
    difference = page.get_by_role("button", name="Compare specs")
    expect(difference).to_be_focused()
    page.keyboard.press("Enter")
    choice = page.get_by_role("combobox", name="Compare specs")
    expect(choice).to_be_focused()
    expect(choice.get_by_role("option")).not_to_have_count(1)
    page.keyboard.press("ArrowDown")  # Of a closed list this takes one, which is no decision.
    expect(choice).to_be_focused()
    expect_in_url(page, "against=", False)
    page.keyboard.press("Escape")
    expect(difference).to_be_focused()


def test_a_folding_shows_its_pictures_while_it_learns(page, idle):
    address = idle.product.url
    spec = next(p.spec for p in EXPERIMENTS["folding"].presets if p.name == "demo")
    run = idle.product.submit(spec.model_dump(mode="json"))
    page.goto(f"{address}/runs/{run}")
    card = page.get_by_role("region", name="Pictures")
    expect(card).to_contain_text("when all updates are done")
    inked = page.evaluate(
        """() => [...document.querySelectorAll(".fold-choice canvas")].map((canvas) =>
            canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height)
                .data.some((value) => value > 100))"""
    )
    assert inked == [True, True]
