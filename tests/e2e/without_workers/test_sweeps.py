"""A sweep in the browser: asked for in the form, watched on its page, one row in the list."""

import json
from typing import Any
from uuid import UUID

from playwright.sync_api import expect
from small_runs import TINY

from server.runs.announce import announce
from server.tables import FINISHED, Generation, Run


def compute(services: Any, run: str, qd_scores: list[float]) -> None:
    """Write generations as a worker does, and finish the run."""
    with services.sessions.write.begin() as session:
        row = session.get_one(Run, UUID(run))
        for generation, value in enumerate(qd_scores, 1):
            scores = {"qd_score": value, "coverage": value / 100, "best": value / 10}
            counts = {"generation": generation, "evaluations": 8 * generation, "infeasible": 0}
            others = {"run_id": row.id, "seconds": 1.0 * generation, "mean": None}
            session.add(Generation(**scores, **counts, **others, summary=None))
            for name, figure in (scores | counts).items():
                setattr(row, name, figure)
        row.status = FINISHED
    announce(services, UUID(run))


def test_a_sweep_is_submitted_and_summarised(page, idle, complaints):
    address = idle.product.url
    page.goto(f"{address}/new?view=json")
    page.get_by_label("Spec as JSON").fill(json.dumps(TINY))
    card = page.get_by_role("region", name="Seeds and sweep")
    card.get_by_label("Number of seeds").fill("3")
    card.get_by_role("button", name="Sweep over a field").click()
    values = card.get_by_label("Values of world.viscosity")
    values.fill("0.05, thick")
    expect(card.get_by_role("alert")).to_have_text("Needs a number, got “thick”.")
    values.fill("0.05, 0.1")
    expect(card.get_by_role("status")).to_have_text("6 runs in total")
    card.get_by_label("Name of the sweep").fill("Thick and thin")
    expect(page.get_by_label("Estimate", exact=True)).to_contain_text("Time of 6 runs")
    page.get_by_role("button", name="Start 6 runs").click()

    expect(page.get_by_role("heading", name="Thick and thin")).to_be_visible()
    sweep = idle.product.http.get(f"/api/v1{page.url.removeprefix(address)}").json()
    expect(page.locator(".sweep-states")).to_have_text("6 queued")
    thin = sweep["cases"][0]["runs"]
    for run, level in zip(thin, (10.0, 20.0, 40.0), strict=True):
        compute(idle.services, run, [level / 4, level / 2, level])
    row = page.get_by_role("region", name="Figures of the cases").get_by_role("row").nth(1)
    expect(row).to_contain_text("viscosity 0.05")
    expect(row).to_contain_text("15 to 30")
    curve = page.get_by_role("img", name="QD score over generations: now viscosity 0.05 20")
    expect(curve).to_be_visible()
    page.get_by_label("Each run").check()
    expect(page).to_have_url(f"{address}/sweeps/{sweep['id']}?each=1")
    page.get_by_role("button", name="Pause all").click()
    expect(page.locator(".sweep-states")).to_contain_text("3 paused")
    expect(page.get_by_text("3 runs will pause; 3 runs not changed.")).to_be_visible()

    page.goto(address)
    sweeps = page.get_by_role("region", name="Sweeps").get_by_role("listitem")
    expect(sweeps.first).to_contain_text("Thick and thin")
    expect(sweeps.first).to_contain_text("3 paused")
    page.get_by_role("link", name="Runs of Thick and thin").click()
    expect(page.locator(".runs tbody tr")).to_have_count(6)
    complaints[:] = [text for text in complaints if "status of 422" not in text]


def test_a_sweep_is_renamed_deleted_and_restored(page, idle):
    http = idle.product.http
    sweep = http.post("/api/v1/sweeps", json={"spec": TINY, "seeds": 2}).json()
    page.goto(f"{idle.product.url}/sweeps/{sweep['id']}")
    states = page.locator(".sweep-states")
    expect(states).to_have_text("2 queued")
    expect(page.get_by_role("button", name="Delete all")).to_have_count(0)
    page.get_by_role("button", name="Rename").click()
    page.get_by_label("Name of Sweep").fill("Twins")
    page.keyboard.press("Enter")
    expect(page.get_by_role("heading", name="Twins")).to_be_visible()
    http.post(f"/api/v1/sweeps/{sweep['id']}/cancel")
    page.get_by_role("button", name="Delete all").click()
    expect(page.get_by_text("2 runs moved to the bin.")).to_be_visible()
    expect(page.get_by_text("All runs are in the bin.")).to_be_visible()
    page.get_by_role("button", name="Undo").click()
    expect(states).to_have_text("2 cancelled")
    page.get_by_role("button", name="Delete all").click()
    page.get_by_role("button", name="Restore").click()
    expect(states).to_have_text("2 cancelled")
    expect(page.get_by_text("All runs are in the bin.")).to_have_count(0)


def test_statistics_of_a_finished_sweep_are_shown_and_downloaded(page, idle, complaints):
    asked = {"spec": TINY, "seeds": 5, "grid": {"world.viscosity": [0.05, 0.1, 0.2]}}
    sweep = idle.product.http.post("/api/v1/sweeps", json=asked).json()
    for number, case in enumerate(sweep["cases"], 1):
        for seed, run in enumerate(case["runs"]):
            level = 10.0 * number + seed
            compute(idle.services, run, [level / 2, level])
    page.goto(f"{idle.product.url}/sweeps/{sweep['id']}")
    card = page.get_by_role("region", name="Statistics", exact=True)
    figures = card.get_by_role("region", name="Figures of the groups").get_by_role("row").nth(1)
    expect(figures).to_contain_text("QD score")
    expect(figures).to_contain_text("11 to 13")
    pair = card.get_by_role("region", name="Tests between pairs of groups").get_by_role("row")
    expect(pair.nth(2)).to_contain_text("viscosity 0.05")
    expect(pair.nth(2)).to_contain_text("viscosity 0.2")
    expect(pair.nth(2)).to_contain_text("0.00")
    expect(card).to_contain_text("p after Holm’s correction for 9 tests")
    with page.expect_download() as download:
        card.get_by_role("link", name="statistics.csv").click()
    assert download.value.path().read_text().startswith("table,measure,group")
