"""The map of all creatures that ever entered an archive, over other axes."""

import re

import httpx
from pages import TOUR_TAKEN, the_map
from playwright.sync_api import Page, expect


def test_a_run_is_re_projected_onto_measures_and_components(shared, page: Page):
    page.add_init_script(TOUR_TAKEN)
    run = shared.finished("search")
    path = f"{shared.product.url}/api/v1/runs/{run}/archive/reprojection"

    def filled(axes: str) -> str:
        found = httpx.get(path, params={"axes": axes}, timeout=30).json()
        assert found["all_time"]["elites"] >= found["present"]["elites"]
        return f"fill {found['all_time']['elites']} of {found['cells']} cells"

    page.goto(f"{shared.product.url}/runs/{run}?x=curvature_mean&y=mach")
    page.get_by_text("More", exact=True).click()
    page.get_by_role("button", name="All that ever entered").click()
    figures = page.locator(".reprojection")
    expect(figures).to_contain_text(filled("curvature_mean,mach"))
    for name, axis in (("Across", "pc1"), ("Up", "pc2")):
        page.get_by_role("combobox", name=name, exact=True).select_option(axis)
    expect(figures).to_contain_text(filled("pc1,pc2"))
    expect(figures).to_contain_text("of the variance)")
    the_map(page).focus()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("Space")
    expect(page.get_by_text("1 creature selected")).to_be_visible()
    expect(page).to_have_url(re.compile(r"of=history.*cell=\d+.*cells=\d+"))
    page.locator(".selection-bar").get_by_role("link").click()
    expect(page).to_have_url(re.compile(r"/new\?fork=.*&creature=[0-9a-f]{64}$"))
    page.go_back()
    page.get_by_text("More", exact=True).click()
    page.get_by_role("button", name="Present elites").click()
    expect(figures).to_have_count(0)
    expect(page).not_to_have_url(re.compile("of=|cells?="))
