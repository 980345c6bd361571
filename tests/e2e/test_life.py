"""A run is forked, extended, deleted, undone and restored, by mouse and keyboard."""

import re

from pages import TOUR_TAKEN, expect_in_url, the_map
from playwright.sync_api import Locator, Page, expect
from small_runs import TINY

SLOW = 60_000
NAME = "In honey"
VISCOSITY = 0.5
MORE = 2
LAST = TINY["search"]["generations"]


def test_a_run_is_forked_extended_deleted_and_restored(page, shared, complaints):
    address, run = shared.product.url, shared.finished("voronoi")
    page.add_init_script(TOUR_TAKEN)
    page.goto(f"{address}/runs/{run}")
    choose_by_keyboard(page)
    fork = fork_the_chosen_in_another_viscosity(page, address, run)
    shared.product.wait(fork, "finished")
    extend_by_keyboard(page)
    shared.product.wait(fork, "finished")
    bin_and_undo(page)
    bin_and_restore(page, address, fork)
    # Requests for a run just before its deletion are answered by 404.
    in_the_bin = f"status of 404.*/api/v1/runs/{fork}/"
    complaints[:] = [text for text in complaints if not re.search(in_the_bin, text)]


def chosen(page: Page) -> Locator:
    return page.locator(".selection-bar [role=status]")


def choose_by_keyboard(page: Page) -> None:
    """Space toggles a cell, Shift with an arrow adds one, Escape clears the selection."""
    the_map(page).focus()
    for key in ("ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown"):
        page.keyboard.press(f"Shift+{key}")
    expect(chosen(page)).to_have_text(re.compile(r"^\d+ creatures selected$"))
    text = chosen(page).inner_text()
    page.reload()
    expect(chosen(page)).to_have_text(text)
    the_map(page).focus()
    page.keyboard.press("Escape")
    expect(chosen(page)).to_be_empty()
    expect_in_url(page, "cells=", False)
    for key in ("ArrowRight", "Space"):
        page.keyboard.press(key)
    expect(chosen(page)).to_have_text("1 creature selected")


def fork_the_chosen_in_another_viscosity(page: Page, address: str, run: str) -> str:
    """Fork the selected creature, and return the id of the new run."""
    page.locator(".selection-bar").get_by_role("link", name="Fork").click()
    beginning = page.locator(".base-bar")
    expect(beginning).to_contain_text(f"Starts from 1 creature of run {run[:8]}.")
    essentials = page.get_by_role("group", name="The essentials", exact=True)
    essentials.get_by_label("Viscosity", exact=True).fill(str(VISCOSITY))
    page.get_by_label("Name of the run").fill(NAME)
    page.keyboard.press("ControlOrMeta+Enter")
    page.wait_for_url(re.compile(r"/runs/[0-9a-f-]{36}$"))
    expect(page.get_by_text("Started from 1 creature of")).to_be_visible()
    fork = page.url.rpartition("/")[2]
    made = page.request.get(f"{address}/api/v1/runs/{fork}").json()
    assert (made["name"], made["spec"]["world"]["viscosity"]) == (NAME, VISCOSITY)
    assert made["forked_from"] == {"run": run, "creatures": 1}
    return fork


def extend_by_keyboard(page: Page) -> None:
    page.get_by_role("button", name="Extend").focus()
    page.keyboard.press("Enter")
    expect(page.get_by_label("Generations to add")).to_be_focused()
    page.keyboard.press("ControlOrMeta+a")
    page.keyboard.type(str(MORE))
    page.keyboard.press("Enter")
    status = page.get_by_role("region", name="Status of the run")
    expect(status).to_contain_text(f"{LAST + MORE} / {LAST + MORE}", timeout=SLOW)


def bin_and_undo(page: Page) -> None:
    page.get_by_role("button", name=f"Delete {NAME}").click()
    expect(page.get_by_text("This run is in the bin")).to_be_visible()
    expect(page.get_by_role("button", name="Undo")).to_be_visible()
    page.keyboard.press("ControlOrMeta+z")
    expect(the_map(page)).to_be_visible()


def bin_and_restore(page: Page, address: str, fork: str) -> None:
    page.get_by_role("button", name=f"Delete {NAME}").click()
    expect(page.get_by_text("This run is in the bin")).to_be_visible()
    page.goto(address)
    page.get_by_role("link", name="Bin").click()
    row = page.get_by_role("row", name=re.compile(NAME))
    row.get_by_role("button", name=re.compile("^Restore")).press("Enter")
    expect(row).to_have_count(0)
    page.goto(f"{address}/runs/{fork}")
    expect(the_map(page)).to_be_visible()
