"""Runs are named, found, sorted and compared, and the list of workers shows their runs."""

import re

import pytest
from drive import Installation
from pages import expect_in_url
from playwright.sync_api import Page, expect
from small_runs import TINY

SLOW = 300_000


def test_runs_are_named_found_sorted_and_compared(product, page):
    page.goto(product.url)
    expect(page.get_by_role("link", name="Start the first run")).to_be_visible()
    expect(page.get_by_role("heading", name="Nothing of yours swims here yet")).to_be_visible()
    short, long = (submit(product, seed, generations) for seed, generations in ((1, 3), (2, 9)))
    page.goto(product.url)
    page.evaluate("window.neverReloaded = true")
    rename_by_mouse(page, short)
    tag_and_filter_by_mouse(page, short, long)
    see_only_what_matches(page, product, short)
    sort_by_keyboard(page)
    expect(page.locator(".badge.finished")).to_have_count(2, timeout=SLOW)
    compare_by_keyboard(page)
    read_the_comparison(page)
    see_the_worker(page)
    assert page.evaluate("window.neverReloaded")


def submit(product: Installation, seed: int, generations: int) -> str:
    search = {**TINY["search"], "generations": generations}
    return product.submit({**TINY, "search": search, "seed": seed})[:8]


def rows(page: Page):
    return page.locator("table.runs tbody tr")


def row(page: Page, run: str):
    # By its link: another row names the run too if it waits for it.
    return rows(page).filter(has=page.locator(f'a[href*="/runs/{run}"]'))


def rename_by_mouse(page: Page, run: str) -> None:
    row(page, run).get_by_role("button", name=re.compile("^Rename")).click()
    field = page.get_by_role("textbox", name=re.compile("^Name of"))
    field.fill("Short one")
    page.get_by_role("heading", name="Runs").click()
    expect(row(page, run).get_by_role("link", name=re.compile("^Short one"))).to_be_visible()


def tag_and_filter_by_mouse(page: Page, tagged: str, other: str) -> None:
    row(page, tagged).get_by_role("button", name=re.compile("^Add a tag")).click()
    page.get_by_role("combobox", name=re.compile("^New tag")).fill("keep me")
    page.keyboard.press("Enter")
    row(page, tagged).get_by_role("button", name="keep me", exact=True).click()
    expect(row(page, other)).to_have_count(0)
    expect(row(page, tagged)).to_be_visible()
    expect_in_url(page, "tag=keep+me")
    row(page, tagged).get_by_role("button", name=re.compile("^Remove the tag")).click()
    expect(page.get_by_role("heading", name="No matching runs")).to_be_visible()
    page.get_by_role("button", name="Undo").click()
    expect(row(page, tagged)).to_be_visible()
    page.get_by_role("button", name="Show all").click()
    expect(row(page, other)).to_be_visible()


def see_only_what_matches(page: Page, product: Installation, named: str) -> None:
    page.get_by_role("searchbox").fill("short")
    expect(rows(page)).to_have_count(1)
    third = submit(product, 3, 100_000)
    rename(product, third, "Another short one")
    expect(row(page, third)).to_be_visible()
    rename(product, third, "Away")
    expect(row(page, third)).to_have_count(0)
    expect(row(page, named)).to_be_visible()
    page.get_by_role("searchbox").fill("")
    expect(rows(page)).to_have_count(3)
    row(page, third).get_by_role("button", name=re.compile("^Cancel")).click()
    expect(row(page, third).get_by_text("cancelled")).to_be_visible()


def rename(product: Installation, run: str, name: str) -> None:
    (found,) = product.get("runs", q=run)["items"]
    product.http.patch(f"/api/v1/runs/{found['id']}", json={"name": name}).raise_for_status()


def sort_by_keyboard(page: Page) -> None:
    heading = page.get_by_role("columnheader", name="Run")
    heading.get_by_role("button").focus()
    page.keyboard.press("Enter")
    expect(heading).to_have_attribute("aria-sort", "ascending")
    first = rows(page).first
    expect(first).to_contain_text("Away")
    page.keyboard.press("Enter")
    expect(heading).to_have_attribute("aria-sort", "descending")
    expect(first).to_contain_text("Short one")
    page.keyboard.press("Enter")
    expect(heading).to_have_attribute("aria-sort", "none")
    expect_in_url(page, "sort", False)


def compare_by_keyboard(page: Page) -> None:
    """Start in the search field and use the keyboard alone."""
    page.get_by_role("searchbox").focus()
    page.keyboard.type("short one")
    expect(rows(page)).to_have_count(1)
    press_until(page, "Compare Short one", "Space")
    page.get_by_role("searchbox").focus()
    page.keyboard.press("ControlOrMeta+a")
    page.keyboard.press("Delete")
    expect(rows(page)).to_have_count(3)
    press_until(page, "Rename Quality diversity", "Enter")
    expect(page.get_by_role("textbox", name=re.compile("^Name of"))).to_be_focused()
    page.keyboard.type("Long one")
    page.keyboard.press("Enter")
    expect(page.get_by_role("link", name=re.compile("^Long one"))).to_be_visible()
    page.get_by_role("searchbox").focus()
    press_until(page, "Compare Long one", "Space")
    page.get_by_role("searchbox").focus()
    press_until(page, "Compare", "Enter")
    page.wait_for_url(re.compile(r"/compare\?runs="))


def press_until(page: Page, label: str, key: str) -> None:
    """Press Tab until an element of this label has the focus, then press a key."""
    named = "document.activeElement.ariaLabel || document.activeElement.textContent"
    for _ in range(80):
        page.keyboard.press("Tab")
        name = page.evaluate(named).strip()
        if name == label or (label != "Compare" and name.startswith(label)):
            page.keyboard.press(key)
            return
    pytest.fail(f"Tab never comes to {label}")


def read_the_comparison(page: Page) -> None:
    legend = page.get_by_role("list", name="Runs")
    expect(legend.get_by_role("link")).to_have_text(["Short one", "Long one"])
    expect(page.get_by_role("img", name="QD score over generations")).to_be_visible()
    page.get_by_role("combobox", name="X axis").select_option("evaluations")
    page.get_by_role("checkbox", name="Log scale").check()
    expect(page.get_by_role("img", name="QD score over evaluations")).to_be_visible()
    assert page.url.endswith("&over=evaluations&log=1")
    fields = page.get_by_role("region", name="Fields of the runs").get_by_role("row")
    expect(fields).to_have_text([re.compile("^Field"), "seed12", "search.generations39"])
    page.get_by_role("button", name="Remove Long one").click()
    expect(page.get_by_text("All specs are the same.")).to_be_visible()


def see_the_worker(page: Page) -> None:
    page.get_by_role("link", name="Workers", exact=True).click()
    worker = page.get_by_role("list", name="Workers").get_by_role("listitem")
    expect(worker).to_have_count(1)
    expect(worker.get_by_role("meter", name="Memory")).to_be_visible()
    expect(worker).to_contain_text("Waiting for a run.")
    expect(page.get_by_text("The queue is empty.")).to_be_visible()
