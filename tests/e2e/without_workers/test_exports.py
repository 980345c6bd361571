"""The button Export: the formats of a run, and the file that comes."""

import io
import zipfile

import made_archives
import pyarrow.parquet as pq
import pytest
import reports
from pages import TOUR_TAKEN
from playwright.sync_api import expect

from microcosmos.spec import parse
from server.attempts.claim import claim
from server.runs.submission import submit


@pytest.fixture
def kept(idle):
    """A run with a checkpoint."""
    document = reports.DEMO.model_dump(mode="json") | {"seed": 91}
    run = submit(idle.services, parse(document))[0]
    attempt = claim(idle.services, run.id, "worker 1")
    attempt.record_device("cpu, a processor", ["tensorboard:runs"])
    attempt.record(reports.report(1, {5: 1.0, 6: 2.0}, poses=True), 1.0)
    attempt.save(1, made_archives.made())
    return run.id


def test_a_run_is_downloaded_in_a_chosen_format(page, idle, kept):
    page.add_init_script(TOUR_TAKEN)
    page.goto(f"{idle.product.url}/runs/{kept}")
    card = page.locator("#files")
    card.get_by_text("Export", exact=True).click()
    expect(card.get_by_role("listitem")).to_have_count(6)
    with page.expect_download() as coming:
        card.get_by_role("button", name="Parquet").click()
    assert coming.value.suggested_filename == f"quality-diversity-{str(kept)[:8]}-parquet.zip"
    with zipfile.ZipFile(io.BytesIO(coming.value.path().read_bytes())) as whole:
        assert any(name.endswith("/archive.parquet") for name in whole.namelist())


def test_a_real_length_and_period_add_si_units_and_wrong_ones_are_named(page, idle, kept):
    page.add_init_script(TOUR_TAKEN)
    page.goto(f"{idle.product.url}/runs/{kept}")
    card = page.locator("#files")
    card.get_by_text("Export", exact=True).click()
    length, period = card.get_by_label("Body length"), card.get_by_label("Stroke")
    parquet = card.get_by_role("button", name="Parquet")
    length.fill("1")
    expect(card.get_by_text("Body length must be a number above 0 with a unit")).to_be_visible()
    expect(parquet).to_have_attribute("aria-disabled", "true")
    length.fill("1 mm")
    expect(card.get_by_text("Give the period of a stroke too")).to_be_visible()
    period.fill("0.5 s")
    with page.expect_download() as coming:
        parquet.click()
    with zipfile.ZipFile(io.BytesIO(coming.value.path().read_bytes())) as whole:
        (name,) = (one for one in whole.namelist() if one.endswith("/archive.parquet"))
        schema = pq.read_schema(io.BytesIO(whole.read(name)))
    assert schema.field("speed_si").metadata[b"unit"] == b"m/s"
    assert b'"length_m": 0.001' in schema.metadata[b"real"]
