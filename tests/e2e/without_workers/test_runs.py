"""Runs are named, found, sorted and compared."""

import re

import pytest
from pages import expect_in_url
from playwright.sync_api import Locator, Page, expect
from written_run import WrittenRun


def test_runs_are_named_found_sorted_and_compared(page, idle):
    short, long = (WrittenRun(idle.services, seed) for seed in (21, 22))
    for run, last in ((short, 3), (long, 9)):
        run.claim("worker 1")
        run.write_generations(1, last)
        rename(idle, run, f"of the list {last}")
    page.goto(f"{idle.product.url}/?q=of+the+list")  # Other tests have runs there too.
    page.evaluate("window.neverReloaded = true")
    expect(rows(page)).to_have_count(2)
    rename_by_mouse(page, short)
    tag_and_filter_by_mouse(page, short, long)
    write_a_note_while_the_list_changes(page, idle, long)
    rename(idle, long, "Long one of the list")
    expect(row(page, long)).to_be_visible()
    sort_by_keyboard(page)
    compare_by_keyboard(page)
    assert page.evaluate("window.neverReloaded")


def rename(idle, run: WrittenRun, name: str) -> None:
    path = f"/api/v1/runs/{run.id}"
    idle.product.http.patch(path, json={"name": name}).raise_for_status()


def rows(page: Page) -> Locator:
    return page.locator("table.runs tbody tr")


def row(page: Page, run: WrittenRun) -> Locator:
    # By its link: another row names the run too if it waits for it.
    return rows(page).filter(has=page.locator(f'a[href*="/runs/{run.id}"]'))


def rename_by_mouse(page: Page, run: WrittenRun) -> None:
    row(page, run).get_by_role("button", name=re.compile("^Rename")).click()
    field = page.get_by_role("textbox", name=re.compile("^Name of"))
    field.fill("Short one of the list")
    page.get_by_role("heading", name="Runs").click()
    expect(row(page, run).get_by_role("link", name=re.compile("^Short one"))).to_be_visible()


def tag_and_filter_by_mouse(page: Page, tagged: WrittenRun, other: WrittenRun) -> None:
    row(page, tagged).get_by_role("button", name=re.compile("^Add a tag")).click()
    page.get_by_role("combobox", name=re.compile("^New tag")).fill("keep me")
    page.keyboard.press("Enter")
    row(page, tagged).get_by_role("button", name="keep me", exact=True).click()
    expect(row(page, other)).to_have_count(0)
    expect_in_url(page, "tag=keep+me")
    row(page, tagged).get_by_role("button", name=re.compile("^Remove the tag")).click()
    expect(page.get_by_role("heading", name="No matching runs")).to_be_visible()
    page.get_by_role("button", name="Undo").click()
    expect(row(page, tagged)).to_be_visible()
    page.get_by_role("button", name="Show all").click()
    page.get_by_role("searchbox").fill("of the list")
    expect(row(page, other)).to_be_visible()


def write_a_note_while_the_list_changes(page: Page, idle, run: WrittenRun) -> None:
    """The run leaves the list; its row stays until the note is written."""
    row(page, run).get_by_role("button", name=re.compile("^Add a note")).click()
    page.get_by_role("textbox", name=re.compile("^Note")).press_sequentially("A note that ")
    with page.expect_response(re.compile(r"/api/v1/runs\?")):
        rename(idle, run, "Away")
    page.keyboard.type("is complete.")
    expect(row(page, run)).to_contain_text("Away")
    page.keyboard.press("Control+Enter")
    expect(row(page, run)).to_have_count(0)
    assert idle.product.get(f"runs/{run.id}")["note"] == "A note that is complete."


def sort_by_keyboard(page: Page) -> None:
    heading = page.get_by_role("columnheader", name="Run")
    heading.get_by_role("button").focus()
    for order, first in (("ascending", "Long one"), ("descending", "Short one")):
        page.keyboard.press("Enter")
        expect(heading).to_have_attribute("aria-sort", order)
        expect(rows(page).first).to_contain_text(first)


def compare_by_keyboard(page: Page) -> None:
    """Start in the search field and use the keyboard alone."""
    for label, key in (
        ("Compare Short", "Space"),
        ("Compare Long", "Space"),
        ("Compare", "Enter"),
    ):
        page.get_by_role("searchbox").focus()
        press_until(page, label, key)
    page.wait_for_url(re.compile(r"/compare\?runs="))
    legend = page.get_by_role("list", name="Runs").get_by_role("link")
    expect(legend).to_have_count(2)
    expect(page.get_by_role("img", name="QD score over generations")).to_be_visible()
    page.get_by_role("combobox", name="X axis").select_option("evaluations")
    expect(page.get_by_role("img", name="QD score over evaluations")).to_be_visible()
    page.get_by_role("button", name="Remove Long one of the list").click()
    expect(legend).to_have_count(1)


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
