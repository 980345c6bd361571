"""The page for a new run: sources of a spec, what the page shows of it, and refused input."""

import json
import re
from collections.abc import Iterator
from typing import Any

import pytest
import reports
from pages import ALL_SETTINGS, see_it_move
from playwright.sync_api import Locator, Page, expect

from microcosmos.archive import creature

KINDS = {
    "Quality-diversity": "24 nodes",
    "Neuroevolution": "24 nodes",
    "Folding": "160 nodes",
    "Gaits": "32 nodes",
    "Scaling": "1,000 nodes",
}
SLOW = 120_000
SPEC = {"experiment": "gaits", "swimmers": ["ray", "cilia"], "period": 240}


@pytest.fixture
def new(page: Page, idle, complaints: list[str]) -> Iterator[Page]:
    page.add_init_script(ALL_SETTINGS)
    page.goto(f"{idle.product.url}/new")
    expect(page.get_by_label("Estimate", exact=True)).to_be_visible()
    yield page
    # The browser logs the refusal of a wrong value, which the page shows.
    complaints[:] = [text for text in complaints if "status of 422" not in text]


def beginning(page: Page) -> Locator:
    return page.locator(".base-bar")


def paste(page: Page, document: Any) -> None:
    """Dispatch the clipboard's event outside of any field."""
    script = """(text) => {
        const data = new DataTransfer();
        data.setData("text", text);
        const options = { clipboardData: data, bubbles: true, cancelable: true };
        document.body.dispatchEvent(new ClipboardEvent("paste", options));
    }"""
    page.evaluate(script, document if isinstance(document, str) else json.dumps(document))


def drop(page: Page, name: str, text: str) -> None:
    script = """([name, text]) => {
        const data = new DataTransfer();
        data.items.add(new File([text], name));
        for (const type of ["dragover", "drop"]) {
            const options = { dataTransfer: data, bubbles: true, cancelable: true };
            document.body.dispatchEvent(new DragEvent(type, options));
        }
    }"""
    page.evaluate(script, [name, text])


def choose(page: Page, kind: str) -> None:
    page.get_by_role("radio", name=re.compile(f"^{kind}")).check()


def field(page: Page, group: str, name: str) -> Locator:
    return page.get_by_role("group", name=group, exact=True).get_by_label(name, exact=True)


def test_a_spec_is_begun_changed_refused_kept_and_a_run_started(new, idle):
    """Runs are queued, and no worker takes them."""
    address = idle.product.url
    every_experiment_shows_its_body_and_cost(new)
    a_wrong_value_is_named(new)
    changes_are_counted_kept_and_undone(new)
    a_spec_is_pasted_and_what_is_none_is_refused(new, address)
    a_creature_gives_its_world(new)
    a_run_is_started_by_keyboard_alone(new, address)


def every_experiment_shows_its_body_and_cost(page: Page) -> None:
    for kind, nodes in KINDS.items():
        choose(page, kind)
        expect(beginning(page)).to_contain_text("Same as preset “demo”")
        expect(page.locator(".body-drawing")).to_contain_text(nodes)
        assert page.locator(".filament").first.get_attribute("d")
        expect(page.get_by_role("region", name="Cost")).to_contain_text("No worker is running")
    choose(page, "Folding")
    expect(page.get_by_role("img", name=re.compile("^Picture"))).to_have_count(2)
    choose(page, "Refinement")
    expect(page.get_by_text("A refinement starts from a creature")).to_be_visible()
    page.get_by_role("radio", name=re.compile("^Quality")).check()


def a_wrong_value_is_named(page: Page) -> None:
    nodes = field(page, "Body", "Nodes")
    nodes.fill("2")
    expect(page.get_by_text("Needs at least 3.")).to_be_visible()
    page.get_by_role("button", name="Set it to 3").click()
    expect(nodes).to_have_value("3")
    nodes.fill("60")
    expect(page.get_by_text(re.compile("Must be at least 69 cells"))).to_be_visible()
    page.get_by_role("button", name="Start run").click()
    expect(page.get_by_text("Fix the highlighted fields")).to_be_visible()
    nodes.fill("24")


def changes_are_counted_kept_and_undone(page: Page) -> None:
    field(page, "Task", "Steps").fill("480")
    expect(beginning(page)).to_contain_text(re.compile(r"\d changes? from preset “demo”"))
    text = beginning(page).inner_text().partition(".")[0]
    page.reload()
    expect(beginning(page)).to_contain_text("Restored draft")
    expect(beginning(page)).to_contain_text(text)
    expect(field(page, "Task", "Steps")).to_have_value("480")
    page.get_by_role("button", name="Discard draft").click()
    expect(beginning(page)).to_contain_text("Same as preset “demo”")


def a_spec_is_pasted_and_what_is_none_is_refused(page: Page, address: str) -> None:
    page.goto(f"{address}/new?preset=scaling/demo")
    expect(beginning(page)).to_contain_text("Same as preset “demo”")
    paste(page, SPEC)
    expect(beginning(page)).to_contain_text("Same as the pasted spec")
    expect(page.locator(".body-drawing")).to_contain_text("Cilia 88 nodes")
    expect(field(page, "General", "Cycles")).to_have_value("3")
    paste(page, '{"experiment": "astrology"}')
    expect(page.get_by_text("“experiment” must be one of quality-diversity")).to_be_visible()
    drop(page, "elites.h5", "\u0089HDF")
    expect(page.get_by_text("elites.h5: Archives and checkpoints (HDF5)")).to_be_visible()


def a_creature_gives_its_world(page: Page) -> None:
    identity = reports.identity()
    identity["task"]["steps"] = 400
    file = creature.document(identity, None, None)
    drop(page, "creature.json", json.dumps(file))
    expect(beginning(page)).to_contain_text(f"Same as creature {file['sha256'][:8]}")
    expect(field(page, "Task", "Steps")).to_have_value("400")
    expect(field(page, "World", "Width")).to_have_value("48")


def a_run_is_started_by_keyboard_alone(new: Page, address: str) -> None:
    new.goto(f"{address}/new?preset=quality-diversity/demo")
    expect(beginning(new)).to_contain_text("Same as preset “demo”")
    reach(new, "radio", "Quality-diversity")
    new.keyboard.press("ArrowRight")
    expect(beginning(new)).to_contain_text("Same as preset “demo”")
    expect(new.get_by_role("radio", name=re.compile("^Neuro"))).to_be_checked()
    reach(new, "button", "Standard")
    new.keyboard.press("Enter")
    expect(beginning(new)).to_contain_text("Same as preset “standard”")
    new.keyboard.press("ControlOrMeta+Enter")
    new.wait_for_url(re.compile(r"/runs/[0-9a-f-]{36}$"))
    assert new.evaluate("sessionStorage.length") == 0


def test_a_first_creature_swims_before_anything_is_started(page, idle):
    before = idle.product.get("runs")["items"]
    page.goto(f"{idle.product.url}/new?preset=quality-diversity/demo")
    page.get_by_role("button", name="Let one of the first swim").click()
    water = page.get_by_role("img", name="The creature swims in live water")
    expect(water).to_be_visible(timeout=SLOW)
    see_it_move(water)
    page.get_by_label("Nodes", exact=True).fill("20")
    expect(water).to_have_count(0)
    expect(water).to_be_visible(timeout=SLOW)
    assert idle.product.get("runs")["items"] == before


def reach(page: Page, role: str, name: str) -> None:
    """Press Tab until an element of this role and name has the focus."""
    wanted = page.get_by_role(role, name=re.compile(f"^{name}"))  # pyright: ignore[reportArgumentType]
    for _ in range(60):
        page.keyboard.press("Tab")
        if wanted.evaluate("(element) => element === document.activeElement"):
            return
    pytest.fail(f"no {role} {name} within reach of the keyboard")
