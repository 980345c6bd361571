import re

import pytest
from playwright.sync_api import Page, expect

FAST, SLOW = 10_000, 120_000


@pytest.mark.e2e
def test_a_filament_folds_and_is_watched(shared_page: Page, shared_address: str):
    page = shared_page
    page.goto(f"{shared_address}/new")
    page.get_by_role("radio", name=re.compile("^Folding")).check()
    page.get_by_role("button", name=re.compile("fold into two digits without")).click()
    page.get_by_label("Updates", exact=False).fill("4")
    page.get_by_role("button", name="Start run").click()
    page.wait_for_url(re.compile(r"/runs/[0-9a-f-]{36}$"), timeout=FAST)
    expect(page.get_by_text("4 / 4")).to_be_visible(timeout=SLOW)
    plot = page.get_by_role("group", name="Loss against updates")
    expect(plot).to_be_visible(timeout=FAST)
    rows = page.locator("table.results tbody tr")
    expect(rows).to_have_count(2, timeout=FAST)
    rows.first.get_by_role("link").click()
    page.wait_for_url(re.compile("/creatures/[0-9a-f]{64}"), timeout=FAST)
    expect(page.get_by_role("button", name="Refine")).to_have_count(0)
    see_it_move(page, 1)


@pytest.mark.e2e
def test_an_elite_is_refined_and_watched_beside_what_it_was(shared, shared_page: Page):
    page, address = shared_page, shared.product.url
    found = page.request.get(
        f"{address}/api/v1/runs/{shared.finished('voronoi')}/archive"
    ).json()
    page.goto(f"{address}/creatures/{found['creature'][0]}")
    page.get_by_role("button", name="Refine").click()
    expect(page.get_by_text("Queues a new run")).to_be_visible(timeout=FAST)
    assert "/creatures/" in page.url  # Nothing is queued before it is confirmed.
    page.get_by_role("button", name="Refine now").click()
    page.wait_for_url(re.compile(r"/runs/[0-9a-f-]{36}$"), timeout=FAST)
    expect(page.get_by_text("21 / 21")).to_be_visible(timeout=SLOW)
    expect(page.get_by_role("group", name="Fitness against steps")).to_be_visible()
    expect(page.get_by_role("heading", name="Before and after")).to_be_visible(timeout=FAST)
    see_it_move(page, 2)
    expect(page.locator(".stages figcaption")).to_have_count(2)
    first, last = (one.inner_text() for one in page.locator(".stages figcaption").all())
    assert (first.split()[0], last.split()[0]) == ("Before", "After")
    assert fitness(last) > fitness(first)


def see_it_move(page: Page, films: int) -> None:
    canvas = page.get_by_role("img", name=re.compile("The swimming creature"))
    expect(canvas).to_have_count(films, timeout=SLOW)
    before = pixels(page)
    page.get_by_label("Time in the replay").focus()
    page.keyboard.press("End")
    page.wait_for_timeout(300)
    assert all(one != other for one, other in zip(before, pixels(page), strict=True))


def pixels(page: Page) -> list[str]:
    script = "[...document.querySelectorAll('.stage canvas')].map((one) => one.toDataURL())"
    return page.evaluate(script)


def fitness(caption: str) -> float:
    found = re.search(r"fitness ([\d.]+)", caption)
    assert found
    return float(found[1])
