"""A run is submitted and watched; its creature is opened, downloaded and dropped back in."""

import json
import re
from pathlib import Path

from drive import Installation
from pages import elites, film, see_it_swim, start_run, the_map, wait_until_still
from playwright.sync_api import Page, expect

SLOW = 120_000


def test_a_run_is_submitted_watched_and_its_creature_swims(product, page, tmp_path):
    run = submit_a_short_run(page, product.url)
    watch_it_live(page)
    sha = open_an_elite(page, product, run)
    see_it_swim_and_pause(page)
    file = download_it(page, sha, tmp_path)
    drop_it_back_in(page, file, sha)


def submit_a_short_run(page: Page, address: str) -> str:
    page.goto(f"{address}/new")
    presets = page.get_by_role("group", name=re.compile("^Quality-diversity"))
    demo = presets.get_by_role("button", name=re.compile("^Demo A small"))
    demo.click()
    expect(demo).to_have_attribute("aria-pressed", "true")
    generations = page.get_by_label("Generations", exact=False)
    generations.fill("-1")
    expect(page.get_by_text("Needs at least 1.")).to_be_visible()
    generations.fill("12")
    expect(page.get_by_label("Estimate", exact=True)).to_contain_text("192")
    return start_run(page)


def watch_it_live(page: Page) -> None:
    page.evaluate("window.neverReloaded = true")
    expect(elites(page)).not_to_have_text("0 elites", timeout=SLOW)
    expect(page.get_by_text(re.compile(r"^\d+ / 12$"))).not_to_have_text("0 / 12", timeout=SLOW)
    expect(page.get_by_text("12 / 12")).to_be_visible(timeout=SLOW)
    # The page of a finished run is laid out anew, which moves the map.
    expect(page.get_by_role("button", name="Extend")).to_be_visible(timeout=SLOW)
    expect(page.get_by_role("img", name="QD score over generations")).to_be_visible()
    assert page.evaluate("window.neverReloaded")


def open_an_elite(page: Page, product: Installation, run: str) -> str:
    archive = product.get(f"runs/{run}/archive")
    k = max(range(len(archive["cell"])), key=lambda i: archive["fitness"][i])
    columns, rows = (axis["bins"] for axis in archive["axes"])
    i, j = divmod(archive["cell"][k], rows)
    the_map(page).scroll_into_view_if_needed()
    box = the_map(page).bounding_box()
    assert box
    x = box["x"] + (i + 0.5) * box["width"] / columns
    y = box["y"] + (rows - j - 0.5) * box["height"] / rows
    sha = archive["creature"][k]
    page.mouse.move(x, y)
    expect(page.locator("#elite-measures")).to_contain_text(sha[:8])
    page.mouse.click(x, y)
    page.wait_for_url(re.compile(f"/creatures/{sha}"))
    return sha


def see_it_swim_and_pause(page: Page) -> None:
    see_it_swim(page, SLOW / 1000)
    page.keyboard.press("Space")
    expect(page.get_by_role("button", name="Play")).to_be_visible()
    wait_until_still(film(page))
    expect(page.get_by_role("group", name=re.compile("^Network:"))).to_be_visible()


def download_it(page: Page, sha: str, folder: Path) -> Path:
    with page.expect_download() as download:
        page.get_by_role("link", name="JSON").click()
    assert download.value.suggested_filename == f"creature-{sha[:12]}.json"
    file = folder / download.value.suggested_filename
    download.value.save_as(file)
    assert json.loads(file.read_text())["sha256"] == sha
    return file


def drop_it_back_in(page: Page, file: Path, sha: str) -> None:
    page.get_by_role("link", name="Microcosmos").click()
    expect(page.get_by_role("heading", name="Runs", exact=True)).to_be_visible()
    transfer = page.evaluate_handle(
        """([text, name]) => {
            const transfer = new DataTransfer();
            transfer.items.add(new File([text], name, { type: "application/json" }));
            return transfer;
        }""",
        [file.read_text(), file.name],
    )
    page.dispatch_event("body", "dragover", {"dataTransfer": transfer})
    expect(page.get_by_text("Drop a creature file to open it")).to_be_visible()
    page.dispatch_event("body", "drop", {"dataTransfer": transfer})
    page.wait_for_url(re.compile(f"/creatures/{sha}$"))
    expect(page.get_by_role("heading", name=f"Creature {sha[:8]}")).to_be_visible()
