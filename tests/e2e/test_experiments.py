"""Gaits, neuroevolution, folding and refinement in the browser."""

import re

import pages
from pages import (
    ALL_SETTINGS,
    elites,
    expect_in_url,
    picture,
    stage,
    start_run,
    the_map,
    wait_until_changed,
)
from playwright.sync_api import Page, expect

SLOW = 300_000


def test_a_population_is_started_watched_and_explored(shared, page):
    submit_a_small_population(page, shared.product.url)
    watch_it_end(page)
    look_along_other_axes(page)
    open_the_best(page)


def submit_a_small_population(page: Page, address: str) -> None:
    page.add_init_script(ALL_SETTINGS)
    page.goto(f"{address}/new")
    page.get_by_role("radio", name=re.compile("^Neuroevolution")).check()
    presets = page.get_by_role("group", name=re.compile("^Neuroevolution"))
    presets.get_by_role("button", name=re.compile("^Demo")).click()
    page.get_by_label("Generations", exact=False).fill("12")
    search = page.get_by_role("group", name="Search", exact=True)
    search.get_by_label("Batch", exact=False).fill("16")
    search.get_by_role("checkbox", name="Reevaluation").check()
    search.get_by_label("Every", exact=False).fill("4")
    search.get_by_label("Evaluations", exact=False).fill("128")
    start_run(page)


def watch_it_end(page: Page) -> None:
    ended = page.get_by_text("Ended after generation 4: it used its budget of 128 evaluations")
    expect(ended).to_be_visible(timeout=SLOW)
    named = page.get_by_role("heading", name="Neuroevolution demo, generations 12, batch 16")
    expect(named).to_be_visible()
    expect(page.get_by_role("img", name=re.compile("Into empty cells over"))).to_be_visible()
    scores = page.get_by_role("img", name=re.compile("QD score .* re-evaluated [0-9]"))
    expect(scores).to_be_visible()


def look_along_other_axes(page: Page) -> None:
    page.get_by_role("combobox", name="Across", exact=True).select_option("path_length")
    page.get_by_role("combobox", name="Up", exact=True).select_option(label="Fitness")
    expect_in_url(page, "x=path_length&y=fitness")
    expect(page.get_by_text("Path length (cells)")).to_be_visible()
    with page.expect_response(re.compile("measures=path_length")):
        page.reload()
    expect(page.get_by_role("combobox", name="Across", exact=True)).to_have_value("path_length")


def open_the_best(page: Page) -> None:
    expect(elites(page)).to_be_visible()
    the_map(page).focus()
    page.keyboard.press("ArrowRight")
    expect(page.locator("#elite-measures")).to_contain_text("Path length")
    page.keyboard.press("Enter")
    page.wait_for_url(re.compile("/creatures/[0-9a-f]{64}"))
    expect(page.get_by_role("group", name=re.compile("^Network:"))).to_be_visible()
    with page.expect_download(timeout=SLOW) as download:
        page.get_by_role("link", name="SVG").click()
    assert download.value.path().read_text().startswith("<svg")


def test_gaits_are_submitted_plotted_and_watched(shared, page):
    submit_a_small_sweep(page, shared.product.url)
    watch_points_appear(page)
    sort_the_table(page)
    open_a_point(page)
    see_it_swim(page)


def submit_a_small_sweep(page: Page, address: str) -> None:
    page.goto(f"{address}/new")
    page.get_by_role("radio", name=re.compile("^Gaits")).check()
    page.get_by_role("button", name=re.compile("Worm and ray")).click()
    page.get_by_role("checkbox", name="paper", exact=True).check()
    viscosities = page.get_by_label("Viscosities", exact=False)
    viscosities.fill("0.1, 3")
    expect(page.get_by_text("Needs at most 2.")).to_be_visible()
    viscosities.fill("0.1, 1")
    page.get_by_label("Period", exact=False).fill("40")
    page.get_by_role("checkbox", name="Steric").check()
    expect(page.get_by_label("Strength", exact=False)).to_have_value("4")
    expect(page.get_by_label("Estimate", exact=True)).to_contain_text("8")
    start_run(page)


def watch_points_appear(page: Page) -> None:
    page.evaluate("window.neverReloaded = true")
    expect(page.get_by_text("4 / 4")).to_be_visible(timeout=SLOW)
    plot = page.get_by_role("group", name="Displacement against viscosity, Ours")
    expect(plot.get_by_role("link")).to_have_count(4)
    page.get_by_role("button", name="Side by side").click()
    expect(page.get_by_role("link", name=re.compile("at ν ="))).to_have_count(8)
    expect(page.get_by_text("not force-free", exact=True)).to_be_visible()
    assert page.evaluate("window.neverReloaded")


def sort_the_table(page: Page) -> None:
    page.get_by_role("button", name="Viscosity").click()
    page.get_by_role("button", name="Viscosity").click()
    heading = page.get_by_role("columnheader", name=re.compile("^Viscosity"))
    expect(heading).to_have_attribute("aria-sort", "descending")
    rows = page.locator("table.results tbody tr:not(.note)")
    expect(rows).to_have_count(8)
    expect(rows.first).to_contain_text("1")
    expect(rows.last).to_contain_text("0.1")
    read_the_warnings(page)
    with page.expect_download() as download:
        page.get_by_role("link", name="Download CSV").click()
    lines = download.value.path().read_text().splitlines()
    assert lines[0].startswith("form,swimmer,viscosity,displacement")
    assert len(lines) == 9


def read_the_warnings(page: Page) -> None:
    """Each is below its row, all of it in the window."""
    api = page.url.partition("?")[0].replace("/runs/", "/api/v1/runs/")
    rows = page.request.get(f"{api}/results").json()["rows"]
    warnings = {row["creature"][:8]: row["warnings"] for row in rows if row["warnings"]}
    assert warnings
    for creature, warning in warnings.items():
        row = page.get_by_role("row").filter(has=page.get_by_role("link", name=creature))
        note = row.first.locator("xpath=following-sibling::tr[1]").locator("span")
        expect(note).to_have_text(warning)
        box = note.bounding_box()
        assert box
        assert 0 <= box["x"] < box["x"] + box["width"] <= 1280


def open_a_point(page: Page) -> None:
    page.get_by_role("button", name="Paper").click()
    point = page.get_by_role("link", name=re.compile("^Worm at ν = 1,"))
    point.scroll_into_view_if_needed()
    box = point.bounding_box()
    assert box
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    expect(point.get_by_text("Worm at ν = 1", exact=True)).to_be_visible()
    beside = page.get_by_role("complementary", name="Replay of the mark")
    expect(beside.get_by_text("Worm at ν = 1", exact=True)).to_be_visible()
    expect(beside.get_by_role("img", name=re.compile("swimming"))).to_be_visible(timeout=SLOW)
    page.mouse.click(x, y)
    page.wait_for_url(re.compile("/creatures/[0-9a-f]{64}"))


def see_it_swim(page: Page) -> None:
    expect(page.get_by_role("heading", name="Worm")).to_be_visible()
    expect(page.get_by_text("not force-free", exact=True)).to_be_visible()
    expect(page.get_by_role("group", name=re.compile("^Network:"))).to_have_count(0)
    pages.see_it_swim(page, SLOW / 1000)
    with page.expect_download(timeout=SLOW) as download:
        page.get_by_role("button", name="GIF").click()
    assert re.fullmatch(r"creature-[0-9a-f]{12}\.gif", download.value.suggested_filename)
    assert download.value.path().read_bytes().startswith(b"GIF89a")


def test_a_filament_folds_and_is_watched(shared, page):
    page.goto(f"{shared.product.url}/new")
    page.get_by_role("radio", name=re.compile("^Folding")).check()
    page.get_by_role("button", name=re.compile("fold into two digits without")).click()
    page.get_by_label("Updates", exact=False).fill("4")
    start_run(page)
    expect(page.get_by_text("4 / 4")).to_be_visible(timeout=SLOW)
    expect(page.get_by_role("group", name="Loss against updates")).to_be_visible()
    rows = page.locator("table.results tbody tr")
    expect(rows).to_have_count(2)
    rows.first.get_by_role("link").click()
    page.wait_for_url(re.compile("/creatures/[0-9a-f]{64}"))
    expect(page.get_by_role("button", name="Refine")).to_have_count(0)
    see_replays_move(page, 1)


def test_an_elite_is_refined_and_compared(shared, page):
    found = shared.product.get(f"runs/{shared.finished('voronoi')}/archive")
    page.goto(f"{shared.product.url}/creatures/{found['creature'][0]}")
    page.get_by_role("button", name="Refine").click()
    expect(page.get_by_text("Queues a new run")).to_be_visible()
    assert "/creatures/" in page.url  # Nothing is queued before it is confirmed.
    page.get_by_role("button", name="Refine now").click()
    page.wait_for_url(re.compile(r"/runs/[0-9a-f-]{36}$"))
    expect(page.get_by_text("21 / 21")).to_be_visible(timeout=SLOW)
    expect(page.get_by_role("group", name="Fitness against steps")).to_be_visible()
    expect(page.get_by_role("heading", name="Before and after")).to_be_visible()
    see_replays_move(page, 2)
    expect(page.locator(".stages figcaption")).to_have_count(2)
    first, last = (one.inner_text() for one in page.locator(".stages figcaption").all())
    assert (first.split()[0], last.split()[0]) == ("Before", "After")
    assert fitness(last) > fitness(first)


def see_replays_move(page: Page, films: int) -> None:
    expect(stage(page)).to_have_count(films, timeout=SLOW)
    canvases = page.locator(".stage canvas").all()
    before = [picture(canvas) for canvas in canvases]
    page.get_by_label("Time in the replay").focus()
    page.keyboard.press("End")
    for canvas, first in zip(canvases, before, strict=True):
        wait_until_changed(canvas, first)


def fitness(caption: str) -> float:
    found = re.search(r"fitness ([\d.]+)", caption)
    assert found
    return float(found[1])
