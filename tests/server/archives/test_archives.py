"""The archive as columns, now and in the past, and as files."""

import hashlib
from uuid import UUID

import numpy as np
import pytest
import reports
from answers import detail, errors, fields
from installation import GREEDY
from pose_streams import unpacked
from reports import archive_file, audit

from microcosmos.archive import export, file
from microcosmos.spec import parse
from microcosmos_server.archives import reading, routes
from microcosmos_server.attempts.claim import claim
from microcosmos_server.renderings import storage as renderings
from microcosmos_server.runs.submission import submit
from microcosmos_server.storage import segments
from microcosmos_server.tables import AUDIT


@pytest.fixture
def saved(spec, attempt, record) -> bytes:
    record(1)
    content = archive_file(spec)
    attempt.save(1, content)
    return content


def test_the_archive_is_the_last_elite_of_each_cell(api, run_id, spec, record):
    record(1, {5: 1.0, 3: 2.0})
    record(2, {5: 1.5})
    record(3, {255: 0.5, 5: 4.0})
    now = api.get(f"runs/{run_id}/archive").json()
    assert now["generation"] == 3
    assert now["axes"] == spec["archive"]["descriptors"]
    assert now["cell"] == [3, 5, 255]
    assert now["fitness"] == [2.0, 4.0, 0.5]
    assert now["elite_generation"] == [1, 3, 3]
    assert now["descriptors"] == [[0.25, 0.5]] * 3
    assert all(api.get(f"creatures/{sha}").status_code == 200 for sha in now["creature"])


@pytest.mark.postgresql
def test_elites_state_the_verdicts_of_their_audits(api, services, run_id, record):
    record(1, {5: 1.0, 3: 2.0})
    record(2, {5: 1.5})
    url = f"runs/{run_id}/archive"
    replaced, distrusted = api.get(url, params={"generation": 1}).json()["creature"][::-1]
    for name, trusted in ((replaced, True), (distrusted, False)):
        renderings.save(services, name, AUDIT, audit(trusted))
    for measures in ("", "displacement"):
        asked = {"measures": measures}
        assert api.get(url, params=asked).json()["trusted"] == [False, None]
        before = api.get(url, params={**asked, "generation": 1}).json()
        assert before["trusted"] == [False, True]
        history = api.get(f"{url}/history", params=asked).json()
        assert history["trusted"] == [False, True, None]


@pytest.mark.postgresql
def test_the_pose_streams_of_cells_come_at_once(api, run_id, services, record):
    record(1, {5: 1.0, 3: 2.0, 9: 1.0}, poses=True)
    record(2, {5: 1.5}, poses=True)
    record(3, {3: 4.0})  # Without a stream.
    path = f"runs/{run_id}/archive"
    for generation, cells in ((1, [3, 5]), (2, [3, 5]), (3, [5]), (None, [5])):
        then = {"generation": generation} if generation else {}
        archive = api.get(path, params=then).json()
        names = dict(zip(archive["cell"], archive["creature"], strict=True))
        answer = api.get(f"{path}/poses", params={"cells": "5,3,200", **then})
        assert [one.creature for one in unpacked(answer.content)] == [names[x] for x in cells]
    assert services.jobs.renderings.count == 0


def test_streams_of_too_many_or_malformed_cells_are_refused(api, run_id):
    path = f"runs/{run_id}/archive/poses"
    many = ",".join(map(str, range(routes.POSE_CELLS + 1)))
    (error,) = errors(api.get(path, params={"cells": many}))
    assert (error["field"], error["needed"]) == ("cells", "at most 1,000 cells")
    for cells in ("", "a", "1,,2", "-1"):
        assert api.get(path, params={"cells": cells}).status_code == 422, cells


def test_a_run_without_checkpoint_has_no_file_and_a_grid_no_centroids(api, run_id):
    for ending in ("h5", "csv"):
        answer = api.get(f"runs/{run_id}/archive.{ending}")
        assert detail(answer, 404) == f"Run {run_id} has no checkpoint yet; it is queued."
    answer = api.get(f"runs/{run_id}/archive/centroids")
    assert (answer.status_code, answer.json()["title"]) == (404, "No centroids")


def test_the_file_is_the_checkpoint_with_its_hash_as_etag(api, run_id, saved):
    answer = api.get(f"runs/{run_id}/archive.h5")
    etag = f'"{hashlib.sha256(saved).hexdigest()}"'
    assert (answer.content, answer.headers["etag"]) == (saved, etag)
    assert answer.headers["content-length"] == str(len(saved))
    assert "attachment" in answer.headers["content-disposition"]
    known, other = {"If-None-Match": f'"other", {etag}'}, {"If-None-Match": '"other"'}
    again = api.get(f"runs/{run_id}/archive.h5", headers=known)
    assert (again.status_code, again.content) == (304, b"")
    assert api.get(f"runs/{run_id}/archive.h5", headers=other).status_code == 200


RANGES = {
    "bytes=0-9": slice(0, 10),
    "bytes=100-": slice(100, None),
    "bytes=-7": slice(-7, None),
    "bytes=5-5": slice(5, 6),
}


def test_ranges_of_the_file_are_served_and_impossible_ones_refused(api, run_id, saved):
    def ask(**headers):
        return api.get(f"runs/{run_id}/archive.h5", headers=headers)

    for wanted, part in RANGES.items():
        answer = ask(Range=wanted)
        assert (answer.status_code, answer.content) == (206, saved[part]), wanted
        first = part.start % len(saved)
        last = first + len(answer.content) - 1
        assert answer.headers["content-range"] == f"bytes {first}-{last}/{len(saved)}"
    beyond = ask(Range=f"bytes={len(saved)}-")
    assert beyond.status_code == 416
    assert beyond.headers["content-range"] == f"bytes */{len(saved)}"
    assert ask(Range="bytes=0-1,4-5").content == saved
    assert ask(Range="lines=0-1").content == saved
    assert ask(Range=f"bytes={'9' * 5000}-").content == saved
    assert ask(**{"Range": "bytes=0-1", "If-Range": '"an older one"'}).content == saved


SLIM = {"energy": 0.1 + 0.2, "turning": -1e-9}


def test_an_archive_has_the_requested_measures(api, run_id, record):
    record(1, {5: 1.0}, measures=SLIM)
    record(2, {3: 2.0}, measures=dict.fromkeys(SLIM, 7.0))
    found = api.get(f"runs/{run_id}/archive", params={"measures": "turning,energy"}).json()
    assert found["cell"] == [3, 5]
    assert found["measures"] == {"turning": [7.0, -1e-9], "energy": [7.0, 0.1 + 0.2]}
    names = [measure["name"] for measure in found["recorded"]]
    assert names == ["displacement", "bending_effort", "stretching_effort", *SLIM]
    assert api.get(f"runs/{run_id}/archive").json()["measures"] == {}
    before = {"measures": "energy", "generation": 1}
    then = api.get(f"runs/{run_id}/archive", params=before).json()
    assert then["measures"] == {"energy": [0.1 + 0.2]}


@pytest.mark.postgresql
def test_after_limits_the_archive_to_later_elites(api, run_id, record):
    record(1, {5: 1.0, 3: 0.5}, measures=SLIM)
    record(2, {5: 2.0, 7: 0.1}, measures=SLIM)
    record(3, {5: 3.0}, measures=SLIM)

    def read(**asked):
        found = api.get(f"runs/{run_id}/archive", params=asked | {"measures": "energy"}).json()
        assert len(found["measures"]["energy"]) == len(found["cell"])
        return dict(zip(found["cell"], found["elite_generation"], strict=True))

    assert read() == {3: 1, 5: 3, 7: 2}
    assert read(after=1) == {5: 3, 7: 2}
    assert read(after=1, generation=2) == {5: 2, 7: 2}
    assert read(after=3) == {}
    assert read(after=2**62) == {}
    assert api.get(f"runs/{run_id}/archive", params={"after": -1}).status_code == 422


def test_unknown_measures_and_too_long_histories_are_refused(api, run_id, record, monkeypatch):
    record(1, {5: 1.0, 3: 2.0})
    asked = {"measures": "energy,displacement"}
    (error,) = errors(api.get(f"runs/{run_id}/archive", params=asked))
    assert (error["field"], error["got"]) == ("measures", "energy")
    assert "displacement" in error["needed"]
    history = f"runs/{run_id}/archive/history"
    assert fields(api.get(history, params={"measures": "beauty"}))[0] == "measures"
    monkeypatch.setattr(reading, "HISTORY_ENTRIES", 1)
    assert "has 2 entries, more than the 1" in detail(api.get(history), 422)


THREE = [{"name": name} for name in ("nodes", "mach", "power")]


@pytest.mark.parametrize(
    ("archive", "kind", "cells"),
    [
        ({"descriptors": [{"name": "turning", "bins": 7}]}, "grid", 7),
        ({"descriptors": THREE}, "grid", 8000),
        ({"centroids": 500}, "cvt", 500),
        ({"container": {"kind": "fronts", "size": 4}}, "pool", 1600),
    ],
)
def test_an_archive_describes_its_cells_and_axes(
    api, services, spec, report, archive, kind, cells
):
    document = {**spec, "archive": {**archive}}
    run = api.post("runs", json=document).json()
    claim(services, UUID(run["id"]), "worker").record(report(1, {5: 1.0}), 1.0)
    found = api.get(f"runs/{run['id']}/archive").json()
    assert (found["kind"], found["cells"]) == (kind, cells)
    names = [axis["name"] for axis in found["axes"]]
    assert names == [each["name"] for each in run["spec"]["archive"]["descriptors"]]
    assert all(axis["low"] < axis["high"] for axis in found["axes"])


def test_a_measure_comes_with_title_unit_and_ends(api, run_id, record):
    record(1, {5: 1.0}, measures={"old": 1.0})
    recorded = api.get(f"runs/{run_id}/archive").json()["recorded"]
    known = {measure.pop("name"): measure for measure in recorded}
    assert known["bending_effort"]["title"] == "Bending effort"
    assert known["bending_effort"]["unit"] == "rad²"
    assert known["bending_effort"]["low"] < known["bending_effort"]["high"]
    unknown = {"title": "Old", "unit": "", "low": None, "high": None, "scale": "linear"}
    assert known["old"] == unknown | {"bins": None}


def test_the_history_contains_the_archive_of_every_generation(api, run_id, record):
    record(1, {5: 1.0, 3: 2.0}, measures={"turning": 0.5})
    record(2, {5: 1.5}, measures={"turning": 0.25})
    record(3, {255: 0.5, 5: 4.0}, measures={"turning": 1.0})
    asked = {"measures": "turning"}
    history = api.get(f"runs/{run_id}/archive/history", params=asked).json()
    assert history["generation"] == 3
    assert history["cell"] == [3, 5, 5, 5, 255]
    assert history["elite_generation"] == [1, 1, 2, 3, 3]
    assert history["measures"] == {"turning": [0.5, 0.5, 0.25, 1.0, 1.0]}
    columns = ("fitness", "descriptors", "creature")
    for generation in range(4):
        then = api.get(f"runs/{run_id}/archive", params={"generation": generation}).json()
        last = {
            cell: [history[name][i] for name in columns]
            for i, cell in enumerate(history["cell"])
            if history["elite_generation"][i] <= generation
        }
        assert last == {
            cell: [then[name][i] for name in columns] for i, cell in enumerate(then["cell"])
        }


def test_the_centroids_of_a_tessellation_are_those_of_its_file(api, services, spec, report):
    spec["archive"]["centroids"] = 3
    run_id = submit(services, parse(spec))[0].id
    assert api.get(f"runs/{run_id}/archive/centroids").json() == {"centroids": None}
    places = np.array([[0.25, 0.5], [0.75, 0.125], [0.5, 1.0]], np.float32)
    attempt = claim(services, run_id, "worker")
    attempt.record(report(1, {2: 1.0}), 1.0)
    attempt.save(1, file.dump({"archive": {"centroids": places}}, {"format": file.FORMAT}))
    answer = api.get(f"runs/{run_id}/archive/centroids").json()
    assert answer["centroids"] == places.tolist()


TESSELLATED = reports.DEMO.model_dump(mode="json")
TESSELLATED["archive"]["centroids"] = 3


@pytest.fixture
def save(services, spec, report):
    """A function that saves a generation of a run with the given centroids."""
    attempt = claim(services, submit(services, parse(TESSELLATED))[0].id, "worker")

    def write(generation, places) -> UUID:
        tree, attributes = file.load(archive_file(spec))
        tree["archive"]["centroids"] = np.array(places)
        attempt.record(report(generation, {2: generation}), 1.0)
        attempt.save(generation, file.dump(tree, attributes))
        return attempt.run_id

    return write


@pytest.fixture
def reads(monkeypatch) -> list[list[str]]:
    """For each file that the server reads whole, the requests that hold a connection then."""
    read, found = segments.read, []

    def watched(*arguments):
        found.append([str(one) for one in list(GREEDY._held.values()) if one])
        return read(*arguments)

    monkeypatch.setattr(segments, "read", watched)
    return found


@pytest.mark.parametrize("path", ["archive.csv", "archive/centroids"])
def test_a_file_is_converted_once_and_without_a_connection(api, save, reads, path):
    url = f"runs/{save(1, [[0.25, 0.5]])}/{path}"
    first = api.get(url)
    assert first.status_code == 200, first.text
    known = {"If-None-Match": first.headers["etag"]}
    unchanged = api.get(url, headers=known)
    assert (unchanged.status_code, unchanged.content) == (304, b"")
    assert api.get(url).content == first.content
    assert reads == [[]]
    save(2, [[0.75, 0.5]])
    assert api.get(url, headers=known).status_code == 200
    assert reads == [[], []]


def test_the_table_of_a_file_is_that_of_the_library(api, run_id, saved):
    answer = api.get(f"runs/{run_id}/archive.csv")
    assert answer.text == export.csv(saved)
    assert answer.headers["content-type"] == "text/csv; charset=utf-8"
    name = f"archive-{str(run_id)[:8]}.csv"
    assert answer.headers["content-disposition"] == f'attachment; filename="{name}"'


@pytest.mark.parametrize("path", ["archive.csv", "archive/centroids"])
def test_a_file_that_is_too_large_is_downloaded_not_converted(
    api, save, monkeypatch, reads, path
):
    monkeypatch.setattr(routes, "LARGEST", 10)
    url = f"runs/{save(1, [[0.25, 0.5]])}"
    said = detail(api.get(f"{url}/{path}"), 422)
    assert f"more than the 10 B that the server converts. Download it: /api/v1/{url}" in said
    assert reads == []
    assert api.get(f"{url}/archive.h5").status_code == 200
