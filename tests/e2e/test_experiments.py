"""Gaits, neuroevolution and refinement in the browser."""

import re

from pages import (
    ALL_SETTINGS,
    elites,
    picture,
    see_it_swim,
    stage,
    start_run,
    the_map,
    wait_until_changed,
)
from playwright.sync_api import expect

SLOW = 300_000


def test_a_population_is_started_watched_and_explored(shared, page):
    page.add_init_script(ALL_SETTINGS)
    page.goto(f"{shared.product.url}/new")
    page.get_by_role("radio", name=re.compile("^Neuroevolution")).check()
    presets = page.get_by_role("group", name=re.compile("^Neuroevolution"))
    presets.get_by_role("button", name=re.compile("^Demo")).click()
    search = page.get_by_role("group", name="Search", exact=True)
    search.get_by_label("Batch", exact=False).fill("16")
    search.get_by_role("checkbox", name="Reevaluation").check()
    search.get_by_label("Every", exact=False).fill("4")
    search.get_by_label("Evaluations", exact=False).fill("128")
    start_run(page)
    ended = page.get_by_text("Ended after generation 4: it used its budget of 128 evaluations")
    expect(ended).to_be_visible(timeout=SLOW)
    scores = page.get_by_role("img", name=re.compile("QD score .* re-evaluated [0-9]"))
    expect(scores).to_be_visible()
    expect(elites(page)).to_be_visible()
    the_map(page).focus()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("Enter")
    page.wait_for_url(re.compile("/creatures/[0-9a-f]{64}"))
    expect(page.get_by_role("group", name=re.compile("^Network:"))).to_be_visible()


def test_gaits_are_submitted_plotted_and_watched(shared, page):
    page.goto(f"{shared.product.url}/new")
    page.get_by_role("radio", name=re.compile("^Gaits")).check()
    page.get_by_role("button", name=re.compile("Worm and ray")).click()
    page.get_by_role("checkbox", name="paper", exact=True).check()
    page.get_by_label("Viscosities", exact=False).fill("0.1, 1")
    page.get_by_label("Period", exact=False).fill("40")
    start_run(page)
    expect(page.get_by_text("4 / 4")).to_be_visible(timeout=SLOW)
    page.get_by_role("button", name="Side by side").click()
    expect(page.get_by_role("link", name=re.compile("at ν ="))).to_have_count(8)
    rows = page.locator("table.results tbody tr:not(.note)")
    expect(rows).to_have_count(8)
    page.get_by_role("button", name="Paper").click()
    page.get_by_role("link", name=re.compile("^Worm at ν = 1,")).press("Enter")
    page.wait_for_url(re.compile("/creatures/[0-9a-f]{64}"))
    expect(page.get_by_role("heading", name="Worm")).to_be_visible()
    see_it_swim(page, SLOW / 1000)
    with page.expect_download(timeout=SLOW) as download:
        page.get_by_role("button", name="GIF").click()
    assert download.value.path().read_bytes().startswith(b"GIF89a")


def test_an_elite_is_refined_and_compared(shared, page):
    found = shared.product.get(f"runs/{shared.finished('voronoi')}/archive")
    page.goto(f"{shared.product.url}/creatures/{found['creature'][0]}")
    page.get_by_role("button", name="Refine").click()
    expect(page.get_by_text("Queues a new run")).to_be_visible()
    page.get_by_role("button", name="Refine now").click()
    page.wait_for_url(re.compile(r"/runs/[0-9a-f-]{36}$"))
    expect(page.get_by_text("21 / 21")).to_be_visible(timeout=SLOW)
    expect(stage(page)).to_have_count(2, timeout=SLOW)
    canvases = page.locator(".stage canvas").all()
    before = [picture(canvas) for canvas in canvases]
    page.get_by_label("Time in the replay").press("End")
    for canvas, first in zip(canvases, before, strict=True):
        wait_until_changed(canvas, first)
    captions = page.locator(".stages figcaption")
    expect(captions).to_have_text([re.compile("^Before .*fitness"), re.compile("^After")])
    first, last = (
        float(re.search(r"fitness ([\d.]+)", one)[1]) for one in captions.all_inner_texts()
    )
    assert last > first
