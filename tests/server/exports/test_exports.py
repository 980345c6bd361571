"""Exports of runs over HTTP are those of the library, with the phylogeny of the server."""

import io
import json
import zipfile
from datetime import UTC, datetime

import dendropy
import made_archives
import numpy as np
import pyarrow.parquet as pq
import pytest
import reports
import xarray as xr
from answers import detail

from microcosmos.client import Client
from microcosmos.client.run import opened
from microcosmos.exports.formats import Format, files
from microcosmos.exports.run_file import RunFile
from microcosmos.quantities.real import Real
from microcosmos.spec import EXPERIMENTS, parse
from microcosmos_server.attempts.claim import claim
from microcosmos_server.exports import routes
from microcosmos_server.runs.submission import submit
from microcosmos_server.tables import Run


@pytest.fixture
def written(services, run_id):
    """The bytes of the run's checkpoint, and the run's name in exports."""
    data = made_archives.made()
    attempt = claim(services, run_id, "worker")
    attempt.record(reports.report(1, {5: 1.0, 6: 2.0}), 1.0)
    attempt.save(1, data)
    return data, f"quality-diversity-{str(run_id)[:8]}"


def read(api, run_id, form):
    answer = api.get(f"runs/{run_id}/export/{form}")
    assert answer.status_code == 200, answer.text
    return answer


@pytest.mark.parametrize("form", ["parquet", "arrow"])
def test_tables_are_those_of_the_library(api, run_id, written, form):
    data, name = written
    answer = read(api, run_id, form)
    assert answer.headers["content-type"] == "application/zip"
    assert f'filename="{name}-{form}.zip"' in answer.headers["content-disposition"]
    whole = zipfile.ZipFile(io.BytesIO(answer.content))
    found = {one: whole.read(f"{name}-{form}/{one}") for one in files_of(data, name, form)}
    assert found == files_of(data, name, form)
    if form == "parquet":
        assert pq.read_table(io.BytesIO(found["archive.parquet"])).num_rows == 3


def files_of(data, name, form):
    return files([RunFile(name, data)], Format(form))


def test_a_phylogeny_is_the_one_of_the_server(api, run_id, written):
    for form, ending in (("alife", "csv"), ("newick", "nwk")):
        text = read(api, run_id, form).text
        assert text == api.get(f"runs/{run_id}/phylogeny.{ending}").text
    trees = dendropy.TreeList.get(data=text, schema="newick")
    assert len(trees) == 2


def test_an_export_is_of_the_checkpoint_and_not_of_what_came_after(
    api, address, services, run_id
):
    attempt = claim(services, run_id, "worker")
    attempt.record(reports.report(1, {5: 1.0}), 1.0)
    attempt.save(1, made_archives.made(loop={"generation": np.int64(1)}))
    before = read(api, run_id, "alife").text
    attempt.record(reports.report(2, {5: 2.0, 6: 2.0}), 1.0)
    assert read(api, run_id, "alife").text == before
    assert api.get(f"runs/{run_id}/phylogeny.csv").text != before
    with Client(address) as client:
        file = opened(client.run(str(run_id)), Format.alife, quiet=True)
    assert file.trees["csv"].decode() == before


def test_a_phylogeny_follows_its_ancestors_in_other_runs(api, services, run_id, spec):
    above = claim(services, run_id, "worker")
    first = reports.report(1, {5: 1.0})
    above.record(first, 1.0)
    search = {**spec["search"], "initial": [first.elites[0].creature]}
    fork = submit(services, parse({**spec, "search": search}))[0].id
    attempt = claim(services, fork, "worker")
    attempt.record(reports.report(1, {7: 3.0}), 1.0)
    attempt.save(1, made_archives.made())
    before = read(api, fork, "alife")
    above.record(reports.report(2, {5: 2.0}), 1.0)
    after = read(api, fork, "alife")
    assert after.text == api.get(f"runs/{fork}/phylogeny.csv").text != before.text
    assert after.headers["etag"] != before.headers["etag"]


def crate_of(api, run_id):
    """Return the entities of a RO-Crate by their names."""
    whole = zipfile.ZipFile(io.BytesIO(read(api, run_id, "ro-crate").content))
    (path,) = (one for one in whole.namelist() if one.endswith("ro-crate-metadata.json"))
    return {one["@id"]: one for one in json.loads(whole.read(path))["@graph"]}


def test_a_crate_has_the_name_of_its_run_as_its_title(api, run_id, written):
    assert api.patch(f"runs/{run_id}", json={"name": "Eels"}).status_code == 200
    assert crate_of(api, run_id)["./"]["name"] == "Eels"


def test_a_crate_says_when_its_run_ended(api, services, run_id, written):
    def run_of_crate():
        return crate_of(api, run_id)["#run"]

    assert "endTime" not in run_of_crate()
    ended = datetime(2026, 5, 4, 3, 2, 1, 500_000, UTC)
    with services.sessions.write.begin() as session:
        session.get_one(Run, run_id).finished_at = ended
    assert datetime.fromisoformat(run_of_crate()["endTime"]) == ended.replace(microsecond=0)


REAL = {"length": "1 mm", "period": "0.5s"}


@pytest.mark.parametrize("form", ["parquet", "netcdf"])
def test_a_real_length_and_period_add_si_units(api, run_id, written, form):
    data, name = written
    answer = api.get(f"runs/{run_id}/export/{form}", params=REAL)
    assert answer.status_code == 200, answer.text
    expected = files([RunFile(name, data)], Format(form), real=Real(1e-3, 0.5))
    if form == "parquet":
        whole = zipfile.ZipFile(io.BytesIO(answer.content))
        assert {one: whole.read(f"{name}-{form}/{one}") for one in expected} == expected
    else:
        found = xr.load_dataset(io.BytesIO(answer.content), engine="h5netcdf")
        assert found["speed_si"].attrs["units"] == "m/s"
    assert answer.headers["etag"] != read(api, run_id, form).headers["etag"]


@pytest.mark.parametrize(
    ("given", "form", "reason"),
    [
        (REAL | {"length": "1"}, "parquet", "`length` must be a number above 0 with a unit"),
        (REAL | {"period": "0.5m"}, "netcdf", "`period` must be a number above 0 with a unit"),
        ({"length": "1mm"}, "arrow", "`period` must be given too, got `length`"),
        (REAL, "ro-crate", "need one of the formats parquet, arrow, netcdf; got 'ro-crate'"),
    ],
)
def test_wrong_units_are_refused(api, run_id, written, given, form, reason):
    assert reason in detail(api.get(f"runs/{run_id}/export/{form}", params=given), 422)


def test_runs_without_a_checkpoint_or_too_large_are_refused(api, run_id, services, monkeypatch):
    assert "no checkpoint yet" in detail(api.get(f"runs/{run_id}/export/parquet"), 404)
    attempt = claim(services, run_id, "worker")
    attempt.record(reports.report(1, {5: 1.0}), 1.0)
    attempt.save(1, made_archives.made())
    monkeypatch.setattr(routes, "LARGEST", 10)
    said = detail(api.get(f"runs/{run_id}/export/parquet"), 422)
    assert f"microcosmos export {run_id} --as parquet" in said
    assert api.get(f"runs/{run_id}/export/excel").status_code == 422


def test_a_table_has_no_phylogeny(api, services):
    spec = EXPERIMENTS["gaits"].presets[0].spec
    run_id = submit(services, spec)[0].id
    for form in ("newick", "netcdf", "ro-crate"):
        assert api.get(f"runs/{run_id}/export/{form}").status_code == 404
