"""A sweep in the browser: asked for in the form, watched on its page, one row in the list."""

import json
import re
from typing import Any
from uuid import UUID

from playwright.sync_api import expect
from small_runs import TINY

from microcosmos_server.runs.announce import announce
from microcosmos_server.tables import FINISHED, Generation, Run


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


def test_a_sweep_is_submitted_summarised_and_tested(page, idle, complaints):
    address = idle.product.url
    page.goto(f"{address}/new?view=json")
    page.get_by_label("Spec as JSON").fill(json.dumps(TINY))
    card = page.get_by_role("region", name="Seeds and sweep")
    card.get_by_label("Number of seeds").fill("5")
    card.get_by_role("button", name="Sweep over a field").click()
    values = card.get_by_label("Values of world.viscosity")
    values.fill("0.05, thick")
    expect(card.get_by_role("alert")).to_have_text("Needs a number, got “thick”.")
    values.fill("0.05, 0.1, 0.2")
    expect(card.get_by_role("status")).to_have_text("15 runs in total")
    card.get_by_label("Name of the sweep").fill("Thick and thin")
    page.get_by_role("button", name="Start 15 runs").click()
    expect(page.get_by_role("heading", name="Thick and thin")).to_be_visible()
    sweep = idle.product.http.get(f"/api/v1{page.url.removeprefix(address)}").json()
    expect(page.locator(".sweep-states")).to_have_text("15 queued")
    for number, case in enumerate(sweep["cases"], 1):
        for seed, run in enumerate(case["runs"]):
            level = 10.0 * number + seed
            compute(idle.services, run, [level / 2, level])
    figures = page.get_by_role("region", name="Figures of the cases").get_by_role("row").nth(1)
    expect(figures).to_contain_text("viscosity 0.05")
    expect(figures).to_contain_text("11 to 13")
    curve = page.get_by_role("img", name=re.compile("QD score over .*: now viscosity 0.05 12"))
    expect(curve).to_be_visible()
    page.get_by_label("Each run").check()
    expect(page).to_have_url(f"{address}/sweeps/{sweep['id']}?each=1")
    tests = page.get_by_role("region", name="Tests between pairs of groups")
    pair = tests.get_by_role("row").nth(2)
    for text in ("viscosity 0.05", "viscosity 0.2", "0.00"):
        expect(pair).to_contain_text(text)
    statistics = page.get_by_role("region", name="Statistics", exact=True)
    with page.expect_download() as download:
        statistics.get_by_role("link", name="statistics.csv").click()
    assert download.value.path().read_text().startswith("table,measure,group")
    page.goto(address)
    page.get_by_role("link", name="Runs of Thick and thin").click()
    expect(page.locator(".runs tbody tr")).to_have_count(15)
    complaints[:] = [text for text in complaints if "status of 422" not in text]
