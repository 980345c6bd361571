"""Statistics of runs that are selected in the list."""

import re

import pytest
from playwright.sync_api import Page, expect
from written_run import GENERATIONS, WrittenRun

SEEDS, VISCOSITIES, TAG = range(5), (0.05, 0.2), "thin-and-thick"


@pytest.fixture
def written(idle):
    """Five seeds in each of two viscosities, with a tag: other tests have runs there too."""
    for viscosity in VISCOSITIES:
        for seed in SEEDS:
            run = WrittenRun(idle.services, 100 + seed, viscosity)
            run.claim("worker")
            run.write_generations(1, GENERATIONS)
            run.attempt.finish()
            answer = idle.product.http.patch(f"/api/v1/runs/{run.id}", json={"tags": [TAG]})
            answer.raise_for_status()
    return idle


def test_selected_runs_are_compared_in_groups_of_one_spec(page: Page, written):
    page.goto(f"{written.product.url}/?tag={TAG}")
    page.get_by_role("checkbox", name=re.compile("^Compare")).first.check()
    page.get_by_role("button", name=re.compile("^Select all")).click()
    page.get_by_role("link", name="Compare", exact=True).click()
    statistics = page.get_by_role("region", name="Statistics")
    expect(statistics).to_contain_text("grouped by what differs in their specs")
    figures = statistics.get_by_role("region", name="Figures of the groups")
    rows = figures.get_by_role("row", name=re.compile(r"viscosity 0\.(05|2) 5"))
    expect(rows.first).to_be_visible()
    tests = statistics.get_by_role("region", name="Tests between pairs of groups")
    expect(tests.get_by_role("row")).to_have_count(1 + 3)
    samples = page.get_by_role("list", name="Runs").locator("path")
    styles = {sample.get_attribute("style") for sample in samples.all()}
    assert (samples.count(), len(styles)) == (len(SEEDS) * len(VISCOSITIES), len(VISCOSITIES))
    with page.expect_download() as download:
        statistics.get_by_role("link", name="statistics.csv").click()
    assert download.value.suggested_filename == "statistics.csv"
