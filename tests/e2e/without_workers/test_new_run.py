"""The page for a new run: sources of a spec, what the page shows of it, and refused input."""

import json
import re
from collections.abc import Iterator
from typing import Any

import pytest
import reports
from pages import ALL_SETTINGS, see_it_move, start_run
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
    json_and_form_stay_in_step(new)
    a_spec_is_pasted_and_what_is_none_is_refused(new, address)
    a_run_is_cloned(new, address)
    a_creature_gives_its_world(new, address)
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
    expect(page.get_by_text(re.compile("World.width must be at least 69"))).to_be_visible()
    page.get_by_role("button", name="Start run").click()
    expect(page.get_by_text("Fix the highlighted fields")).to_be_visible()
    assert page.url.endswith("/new?preset=quality-diversity%2Fdemo")
    body = page.get_by_role("group", name="Body", exact=True)
    body.get_by_label("Builder").select_option("ring")
    expect(page.locator(".body-drawing")).to_contain_text("Ring 32 nodes")


def changes_are_counted_kept_and_undone(page: Page) -> None:
    field(page, "Task", "Steps").fill("120")
    expect(beginning(page)).to_contain_text(re.compile(r"\d changes from preset “demo”"))
    text = beginning(page).inner_text().partition(".")[0]
    page.reload()
    expect(beginning(page)).to_contain_text("Restored draft")
    expect(beginning(page)).to_contain_text(text)
    expect(field(page, "Task", "Steps")).to_have_value("120")
    page.get_by_role("button", name=re.compile("^Reset to 1,?200$")).click()
    expect(field(page, "Task", "Steps")).to_have_value("1200")
    page.get_by_role("button", name="Discard draft").click()
    expect(beginning(page)).to_contain_text("Same as preset “demo”")
    page.get_by_role("button", name="Undo", exact=True).click()
    expect(page.locator(".body-drawing")).to_contain_text("Ring")


def json_and_form_stay_in_step(page: Page) -> None:
    page.get_by_role("button", name="JSON", exact=True).click()
    area = page.get_by_label("Spec as JSON")
    spec = json.loads(area.input_value())
    spec["seed"] = 7
    area.fill(json.dumps(spec))
    area.press("End")
    area.type(" nonsense")
    expect(page.get_by_text("The JSON is not a valid spec.")).to_be_visible()
    area.fill(json.dumps(spec))
    page.get_by_role("button", name="Form", exact=True).click()
    expect(field(page, "General", "Seed")).to_have_value("7")
    field(page, "General", "Seed").fill("8")
    page.get_by_role("button", name="JSON", exact=True).click()
    assert json.loads(area.input_value())["seed"] == 8


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


def a_run_is_cloned(page: Page, address: str) -> None:
    run = page.request.post(f"{address}/api/v1/runs", data={**SPEC, "cycles": 5}).json()
    page.goto(f"{address}/new?from={run['id']}")
    expect(beginning(page)).to_contain_text(f"Same as run {run['id'][:8]}")
    expect(field(page, "General", "Cycles")).to_have_value("5")
    drop(page, "run.json", json.dumps(run))
    expect(beginning(page)).to_contain_text(f"Same as run {run['id'][:8]}")
    page.goto(f"{address}/new?preset=gaits/nothing")
    expect(page.get_by_role("alert")).to_contain_text("“preset” in the address must be one of")


def a_creature_gives_its_world(page: Page, address: str) -> None:
    file = creature_file()
    name = file["sha256"]
    drop(page, "creature.json", json.dumps(file))
    expect(beginning(page)).to_contain_text(f"Same as creature {name[:8]}")
    expect(field(page, "Task", "Steps")).to_have_value("60")
    page.get_by_role("button", name="Open this creature instead").click()
    page.wait_for_url(f"{address}/creatures/{name}")
    page.goto(f"{address}/new?creature={name}")
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
    reach(new, "button", "Close the section General")
    new.keyboard.press("Enter")
    expect(field(new, "General", "Seed")).to_be_hidden()
    new.keyboard.press("Enter")
    new.keyboard.press("Tab")
    new.keyboard.press("ControlOrMeta+a")
    new.keyboard.type("5")
    expect(beginning(new)).to_contain_text("1 change from")
    new.keyboard.press("ControlOrMeta+Enter")
    new.wait_for_url(re.compile(r"/runs/[0-9a-f-]{36}$"))
    assert new.evaluate("sessionStorage.length") == 0


def test_a_run_is_started_from_the_essentials_and_named_by_what_differs(page, idle):
    page.goto(f"{idle.product.url}/new?preset=quality-diversity/demo")
    essentials = page.get_by_role("group", name="The essentials", exact=True)
    expect(essentials.get_by_role("combobox", name="Body")).to_have_value("chain")
    assert essentials.locator("input, select").count() <= 9
    expect(page.get_by_role("group", name="World", exact=True)).to_have_count(0)
    essentials.get_by_label("Viscosity").fill("0.2")
    name = page.get_by_label("Name of the run")
    expect(name).to_have_attribute("placeholder", "Demo, viscosity 0.2")
    start_run(page)
    expect(page.get_by_role("heading", level=1)).to_contain_text("Demo, viscosity 0.2")


def ids(idle) -> list[str]:
    return [run["id"] for run in idle.product.get("runs")["items"]]


def test_a_first_creature_swims_before_anything_is_started(page, idle):
    before = ids(idle)
    page.goto(f"{idle.product.url}/new?preset=quality-diversity/demo")
    page.get_by_role("button", name="Let one of the first swim").click()
    water = page.get_by_role("img", name="The creature swims in live water")
    expect(water).to_be_visible(timeout=SLOW)
    see_it_move(water)
    page.get_by_role("button", name="Another").click()
    expect(page.get_by_text("Creature 2 of the first generation")).to_be_visible()
    expect(water).to_be_visible(timeout=SLOW)
    page.get_by_label("Nodes", exact=True).fill("20")
    expect(water).to_have_count(0)
    expect(water).to_be_visible(timeout=SLOW)
    assert ids(idle) == before


def test_all_settings_are_searched_and_an_error_among_them_is_seen(page, idle):
    page.goto(f"{idle.product.url}/new?preset=quality-diversity/demo")
    page.get_by_role("button", name="All settings").click()
    page.get_by_role("searchbox", name="Find a setting").fill("magic")
    expect(page.get_by_role("combobox", name="Magic")).to_be_visible()
    expect(page.locator(".spec-form .entry")).to_have_count(1)
    page.get_by_role("searchbox", name="Find a setting").fill("")
    field(page, "World", "Width").fill("3")
    expect(page.get_by_role("button", name="All settings")).to_be_disabled()
    page.get_by_role("button", name="Set it to 16").click()
    expect(field(page, "World", "Width")).to_have_value("16")


def creature_file() -> dict[str, Any]:
    identity = reports.identity()
    identity["task"]["steps"] = 60
    return creature.document(identity, None, None)


def reach(page: Page, role: str, name: str) -> None:
    """Press Tab until an element of this role and name has the focus."""
    wanted = page.get_by_role(role, name=re.compile(f"^{name}"))  # pyright: ignore[reportArgumentType]
    for _ in range(60):
        page.keyboard.press("Tab")
        if wanted.evaluate("(element) => element === document.activeElement"):
            return
    pytest.fail(f"no {role} {name} within reach of the keyboard")
