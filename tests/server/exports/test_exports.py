"""Exports of runs over HTTP are those of the library, with the phylogeny of the server."""

import io
import zipfile

import dendropy
import made_archives
import pyarrow.parquet as pq
import pytest
import reports
import xarray as xr
from answers import detail
from rocrate.rocrate import ROCrate

from microcosmos.archive.quantities import Real
from microcosmos.exports.formats import Format, files
from microcosmos.exports.run_file import RunFile
from microcosmos.spec import EXPERIMENTS
from server.attempts.claim import claim
from server.exports import routes
from server.runs.submission import submit


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


def test_an_archive_is_read_by_xarray(api, run_id, written):
    found = xr.load_dataset(io.BytesIO(read(api, run_id, "netcdf").content), engine="h5netcdf")
    assert int(found.fitness.notnull().sum()) == 3


def test_a_phylogeny_is_the_one_of_the_server(api, run_id, written):
    for form, ending in (("alife", "csv"), ("newick", "nwk")):
        text = read(api, run_id, form).text
        assert text == api.get(f"runs/{run_id}/phylogeny.{ending}").text
    trees = dendropy.TreeList.get(data=text, schema="newick")
    assert len(trees) == 2


def test_a_crate_is_read_by_its_library(api, run_id, written, tmp_path):
    data, name = written
    api.patch(f"runs/{run_id}", json={"name": "My swimmers"})
    zipfile.ZipFile(io.BytesIO(read(api, run_id, "ro-crate").content)).extractall(tmp_path)
    folder = tmp_path / f"{name}-ro-crate"
    found = ROCrate(folder)
    assert found.name == "My swimmers"
    assert (folder / f"{name}.h5").read_bytes() == data
    tree = api.get(f"runs/{run_id}/phylogeny.csv").text
    assert (folder / "phylogeny.csv").read_text() == tree


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
        ({"length": "1mm"}, "arrow", "`length` and `period` must be given together"),
        (REAL, "ro-crate", "need one of the formats parquet, arrow, netcdf; got 'ro-crate'"),
    ],
)
def test_wrong_units_are_refused(api, run_id, written, given, form, reason):
    assert reason in detail(api.get(f"runs/{run_id}/export/{form}", params=given), 422)


def test_an_unchanged_export_is_not_sent_again(api, run_id, written):
    tag = read(api, run_id, "netcdf").headers["etag"]
    again = api.get(f"runs/{run_id}/export/netcdf", headers={"If-None-Match": tag})
    assert again.status_code == 304


def test_runs_without_a_checkpoint_or_too_large_are_refused(api, run_id, services, monkeypatch):
    assert "no checkpoint yet" in detail(api.get(f"runs/{run_id}/export/parquet"), 404)
    attempt = claim(services, run_id, "worker")
    attempt.record(reports.report(1, {5: 1.0}), 1.0)
    attempt.save(1, made_archives.made())
    monkeypatch.setattr(routes, "LARGEST", 10)
    said = detail(api.get(f"runs/{run_id}/export/parquet"), 422)
    assert f"microcosmos export {run_id} --as parquet" in said
    assert api.get(f"runs/{run_id}/export/excel").status_code == 422


def test_a_file_that_lacks_columns_is_refused_with_their_name(api, run_id, services):
    attempt = claim(services, run_id, "worker")
    attempt.record(reports.report(1, {5: 1.0}), 1.0)
    attempt.save(1, reports.archive_file(reports.DEMO.model_dump(mode="json")))
    said = detail(api.get(f"runs/{run_id}/export/netcdf"), 422)
    assert "the file must hold" in said


def test_a_table_has_no_phylogeny(api, services):
    spec = EXPERIMENTS["gaits"].presets[0].spec
    run_id = submit(services, spec)[0].id
    for form in ("newick", "netcdf", "ro-crate"):
        assert api.get(f"runs/{run_id}/export/{form}").status_code == 404
