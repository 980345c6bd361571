"""Replays, films, pictures, pose streams and measurements on request."""

import json
from io import BytesIO

import httpx
import numpy as np
import pytest
from answers import detail
from reports import DEMO, audit, pose_stream, replay
from sqlalchemy import select
from sqlalchemy.exc import IntegrityError

from microcosmos.archive import creature
from microcosmos.archive.poses import decode
from microcosmos.viz.replay_file import REPLAY_VERSION
from server.attempts.claim import claim
from server.auth import tokens
from server.renderings import storage as renderings
from server.runs.submission import submit
from server.tables import AUDIT, GIF, MEASUREMENT, REPLAY, Artifact


def test_a_refused_replay_answers_with_the_engines_reason(api, services, known):
    error = creature.CreatureError("task.steps", "at most 1 cell step for a replay", 2)
    services.jobs.render(known)
    job = services.jobs.find(services.jobs.rendering_id(known))
    services.jobs.give_up(job, f"Traceback\n{type(error).__module__}.CreatureError: {error}\n")
    refused = detail(api.get(f"creatures/{known}/replay"), 500)
    assert refused.startswith("The replay failed: `task.steps` needs at most 1 cell step")
    assert services.jobs.renderings.count == 0


def test_a_rendering_job_that_vanishes_is_no_error(services, known, monkeypatch):
    services.jobs.render(known)
    job = services.jobs.find(services.jobs.rendering_id(known))
    services.jobs.remove(job.id)
    monkeypatch.setattr(services.jobs, "find", lambda _: job)
    renderings.enqueue(services, known)


def test_a_range_beyond_all_numbers_is_ignored(api, services, known):
    renderings.save(services, known, REPLAY, b"the replay")
    for wanted in ("bytes=" + "9" * 5000 + "-", "bytes=-" + "9" * 5000):
        answer: httpx.Response = api.get(f"creatures/{known}/replay", headers={"Range": wanted})
        assert (answer.status_code, answer.content) == (200, b"the replay")


@pytest.mark.parametrize(
    ("kind", "media_type", "made"),
    [
        ("replay", "application/octet-stream", b"a replay"),
        ("strip.png", "image/png", b"a picture"),
        ("film.gif", "image/gif", b"a film"),
        ("film.mp4", "video/mp4", b"another film"),
        ("evaluation", "application/vnd.microcosmos.columns", b"inputs"),
    ],
)
def test_each_kind_is_made_once_and_then_kept(api, services, known, kind, media_type, made):
    for _ in range(2):
        answer = api.get(f"creatures/{known}/{kind}")
        assert (answer.status_code, answer.json()) == (202, {"status": "rendering"})
        assert answer.headers["retry-after"] == "1"
    jobs = services.jobs
    (job_id,) = (*jobs.renderings.get_job_ids(), *jobs.audits.get_job_ids())
    assert jobs.find(job_id).args == [known, kind]
    renderings.save(services, known, kind, made)
    answer = api.get(f"creatures/{known}/{kind}")
    assert (answer.status_code, answer.content) == (200, made)
    assert answer.headers["content-type"] == media_type
    known_already = {"If-None-Match": answer.headers["etag"]}
    again = api.get(f"creatures/{known}/{kind}", headers=known_already)
    assert again.status_code == 304
    assert renderings.existing(services, known, kind) == made


def test_the_verdict_is_that_of_the_saved_audit(api, services, known):
    def verdict():
        return api.get(f"creatures/{known}/verdict").json()["trusted"]

    assert verdict() is None
    assert services.jobs.audits.count == 0, "reading the verdict must not enqueue an audit"
    for trusted in (True, False):
        renderings.save(services, known, AUDIT, audit(trusted))
        assert verdict() is trusted
    renderings.save(services, known, GIF, b"a film")
    renderings.enqueue_again(services, known, GIF)
    assert verdict() is False
    renderings.enqueue_again(services, known, AUDIT)
    assert renderings.existing(services, known, AUDIT) is None
    assert verdict() is None


def test_a_token_to_read_orders_no_audit_but_waits_for_one(api, services, known):
    reader = tokens.create(services, "reader", "read")
    sent = {"Authorization": f"Bearer {reader.secret}"}
    path = f"creatures/{known}/audit"
    assert api.get(path, headers=sent).status_code == 204
    refused = detail(api.post(path, headers=sent), 403)
    assert refused == "This needs a token of scope `write`; `reader` has `read`."
    assert services.jobs.audits.count == 0
    for _ in range(2):
        assert api.post(path).status_code == 202
        assert api.get(path, headers=sent).status_code == 202
    assert services.jobs.audits.count == 1
    services.jobs.remove(services.jobs.rendering_id(known, AUDIT))
    renderings.save(services, known, AUDIT, audit(True))
    found = api.get(path, headers=sent)
    assert (found.status_code, found.content) == (200, audit(True))
    assert found.headers["content-type"] == "application/json"
    unchanged = sent | {"If-None-Match": found.headers["etag"]}
    assert api.get(path, headers=unchanged).status_code == 304
    assert api.post(path).status_code == 202
    assert services.jobs.audits.count == 0, "it was audited"


def test_an_audit_that_cannot_be_saved_leaves_the_verdict(api, services, known, monkeypatch):
    renderings.save(services, known, AUDIT, audit(True))

    def refuse(*_):
        raise IntegrityError("", {}, ValueError())

    with monkeypatch.context() as patch:
        patch.setattr(renderings, "insert_missing", refuse)
        with pytest.raises(IntegrityError):
            renderings.save(services, known, AUDIT, audit(False))
    assert api.get(f"creatures/{known}/verdict").json() == {"trusted": True}


def test_a_film_is_saved_under_the_creatures_name(api, services, known):
    renderings.save(services, known, "film.gif", b"GIF")
    answer = api.get(f"creatures/{known}/film.gif")
    expected = f'inline; filename="creature-{known[:12]}.gif"'
    assert answer.headers["content-disposition"] == expected


@pytest.mark.parametrize(
    ("raised", "reported"),
    [
        ("ValueError: too large to refine", "ValueError: too large"),
        (
            "sqlalchemy.exc.OperationalError: database is locked\n[SQL: BEGIN]\n(Background)",
            "OperationalError: database is locked. Try again",
        ),
    ],
)
def test_a_failed_kind_reports_its_error_and_leaves_the_others(
    api, services, known, raised, reported
):
    services.jobs.render(known, "audit")
    job = services.jobs.find(services.jobs.rendering_id(known, "audit"))
    services.jobs.give_up(job, f'Traceback\n  File "a.py"\n    begin()\n{raised}\n')
    found = detail(api.get(f"creatures/{known}/audit"), 500)
    assert "The audit failed: " in found
    assert reported in found
    assert api.get(f"creatures/{known}/film.gif").status_code == 202


def test_replays_are_rendered_first(services, known):
    for kind in ("audit", "film.mp4", "replay"):
        services.jobs.render(known, kind)
    waiting = services.jobs.renderings.get_job_ids()
    kinds = [services.jobs.find(job_id).args[1] for job_id in waiting]
    assert kinds == ["replay", "film.mp4"], "and no audit before or among them"


def test_a_replay_of_an_earlier_format_is_recorded_anew(api, services, known):
    renderings.save(services, known, REPLAY, b"of now")
    renderings.save(services, known, "film.gif", b"GIF")
    with services.sessions.write.begin() as session:
        row = session.scalars(select(Artifact).where(Artifact.kind == REPLAY)).one()
        assert row.number == REPLAY_VERSION
        row.number = None  # As it was before formats were counted.
    assert renderings.existing(services, known, REPLAY) is None
    assert api.get(f"creatures/{known}/replay").status_code == 202
    assert api.get(f"creatures/{known}/film.gif").content == b"GIF"
    renderings.save(services, known, REPLAY, b"of now again")
    assert api.get(f"creatures/{known}/replay").content == b"of now again"


@pytest.mark.parametrize(("frames", "stride"), [(7, 1), (65, 1), (66, 2), (1001, 16)])
def test_poses_without_a_stored_stream_are_every_kth_frame_of_the_replay(
    api, services, known, frames, stride
):
    places = np.random.default_rng(0).normal(size=(frames, 3, 2)).astype(np.float32)
    renderings.save(services, known, REPLAY, replay(places))
    answer = api.get(f"creatures/{known}/poses")
    found = decode(answer.content)
    np.testing.assert_allclose(found.cells, places[stride::stride], atol=1e-3)
    np.testing.assert_allclose(found.path, places[::stride].mean(1), atol=1e-6)
    np.testing.assert_array_equal(np.diff(found.times), 5 * stride)
    assert (found.creature, found.strokes, found.size) == (known, 0, (8, 4))
    assert found.length == pytest.approx(np.sum(np.hypot(*np.diff(places[0], axis=0).T)))
    assert answer.headers["cache-control"] == "no-cache"
    known_already = {"If-None-Match": answer.headers["etag"]}
    again = api.get(f"creatures/{known}/poses", headers=known_already)
    assert (again.status_code, again.content) == (304, b"")


@pytest.mark.parametrize("path", ["poses", "poses.csv", "poses.npz"])
def test_poses_without_a_stream_and_without_a_replay_order_the_replay(
    api, services, known, path
):
    answer = api.get(f"creatures/{known}/{path}")
    assert (answer.status_code, answer.json()) == (202, {"status": "rendering"})
    assert services.jobs.renderings.count == 1


def test_recorded_poses_are_sent_as_stored_and_kept_for_good(api, services, record, report):
    record(1, {3: 1.5}, poses=True)
    (elite,) = report(1, {3: 1.5}, poses=True).elites
    answer = api.get(f"creatures/{elite.creature}/poses")
    assert answer.content == elite.poses
    assert "immutable" in answer.headers["cache-control"]
    known_already = {"If-None-Match": answer.headers["etag"]}
    again = api.get(f"creatures/{elite.creature}/poses", headers=known_already)
    assert (again.status_code, again.content) == (304, b"")
    assert services.jobs.renderings.count == 0


def test_poses_are_exported_as_csv_and_for_numpy(api, record, report):
    record(1, {3: 1.5}, poses=True)
    (elite,) = report(1, {3: 1.5}, poses=True).elites
    stream = decode(elite.poses)
    table = api.get(f"creatures/{elite.creature}/poses.csv")
    assert f'"poses-{elite.creature[:12]}.csv"' in table.headers["content-disposition"]
    assert table.headers["content-type"].startswith("text/csv")
    rows = np.loadtxt(table.text.splitlines(), delimiter=",", skiprows=1)
    assert rows.shape == (64 * 3, 4)
    np.testing.assert_allclose(rows[:, 2:].reshape(64, 3, 2), stream.cells, atol=1e-4)
    arrays = np.load(BytesIO(api.get(f"creatures/{elite.creature}/poses.npz").content))
    np.testing.assert_array_equal(arrays["positions"], stream.cells)
    np.testing.assert_array_equal(arrays["times"], rows[::3, 0])


def test_a_known_creature_gets_the_first_stream_that_a_run_records(api, upload, record, report):
    found = report(1, {3: 1.5}, poses=True)
    (elite,) = found.elites
    assert upload(json.loads(elite.identity)) == elite.creature
    assert api.get(f"creatures/{elite.creature}/poses").status_code == 202
    record(1, {3: 1.5}, poses=True)
    assert api.get(f"creatures/{elite.creature}/poses").content == elite.poses


@pytest.mark.postgresql
def test_a_stored_stream_stays_when_another_run_finds_the_creature(
    api, services, record, report
):
    record(1, {3: 1.5}, poses=True)
    (elite,) = report(1, {3: 1.5}).elites
    for poses in (None, pose_stream(elite.creature, frames=8)):
        found = report(1, {3: 1.5})
        found.elites[0].poses = poses
        held = claim(services, submit(services, DEMO)[0].id, "worker")
        held.record(found, 1.0)
    answer = api.get(f"creatures/{elite.creature}/poses")
    assert len(decode(answer.content).positions) == 64


@pytest.fixture
def measured(upload, report) -> str:
    (elite,) = report(1, {3: 1.5}).elites
    return upload(json.loads(elite.identity), elite.measured, elite.provenance)


def test_a_creature_is_measured_again_on_request_and_repeatedly(api, services, measured):
    path = f"creatures/{measured}/measurement"
    assert api.get(path).status_code == 204
    assert services.jobs.audits.count == 0, "looking orders nothing"
    for _ in range(2):
        assert api.post(f"creatures/{measured}/measurement").status_code == 202
        assert api.get(path).status_code == 202
    (job,) = services.jobs.audits.get_jobs()
    assert job.args == [measured, MEASUREMENT]
    services.jobs.remove(job.id)
    renderings.save(services, measured, MEASUREMENT, b'{"exact": true}')
    assert api.get(path).json() == {"exact": True}
    api.post(f"creatures/{measured}/measurement")
    assert api.get(path).status_code == 202


def test_an_unmeasured_creature_is_not_measured_again(api, known):
    answer = api.post(f"creatures/{known}/measurement")
    assert (answer.status_code, answer.json()["title"]) == (422, "Never measured")


def test_a_measurement_that_failed_says_why(api, services, measured):
    api.post(f"creatures/{measured}/measurement")
    (job,) = services.jobs.audits.get_jobs()
    services.jobs.give_up(job, "Traceback\nValueError: out of memory\n")
    refused = detail(api.get(f"creatures/{measured}/measurement"), 500)
    assert "The measurement failed: ValueError: out of memory" in refused
