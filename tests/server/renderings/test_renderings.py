"""Replays, films, pictures, pose streams and measurements on request."""

import json
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest
from answers import detail
from reports import DEMO, audit, pose_stream, replay
from rq import SimpleWorker
from rq.serializers import JSONSerializer
from sqlalchemy import select
from sqlalchemy.exc import IntegrityError

from microcosmos.archive import creature
from microcosmos.archive.poses import decode
from microcosmos.viz import motion
from microcosmos.viz.replay_file import REPLAY_VERSION, read_replay
from microcosmos_server.attempts.claim import claim
from microcosmos_server.core.errors import FileLost
from microcosmos_server.renderings import storage as renderings
from microcosmos_server.runs.submission import submit
from microcosmos_server.services.services import connect
from microcosmos_server.storage import mark
from microcosmos_server.tables import AUDIT, GIF, MEASUREMENT, REPLAY, Artifact
from microcosmos_worker import jobs


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


def test_an_audit_is_ordered_once_by_a_post_alone(api, services, known):
    path = f"creatures/{known}/audit"
    assert api.get(path).status_code == 204
    assert services.jobs.audits.count == 0
    for _ in range(2):
        assert api.post(path).status_code == 202
        assert api.get(path).status_code == 202
    assert services.jobs.audits.count == 1


def test_an_audit_that_cannot_be_saved_leaves_the_verdict(api, services, known, monkeypatch):
    renderings.save(services, known, AUDIT, audit(True))

    def refuse(*_):
        raise IntegrityError("", {}, ValueError())

    with monkeypatch.context() as patch:
        patch.setattr(renderings, "insert_missing", refuse)
        with pytest.raises(IntegrityError):
            renderings.save(services, known, AUDIT, audit(False))
    assert api.get(f"creatures/{known}/verdict").json() == {"trusted": True}


@pytest.mark.parametrize(
    ("raised", "reported"),
    [
        (ValueError("too large to refine"), "ValueError: too large to refine"),
        (
            RuntimeError("the database is locked\n[SQL: BEGIN]"),
            "RuntimeError: the database is locked",
        ),
        (
            creature.CreatureError("task.steps", "at most 1", 2),
            "`task.steps` needs at most 1; got 2",
        ),
    ],
)
def test_a_failed_kind_reports_its_error_and_leaves_the_others(
    api, services, known, raised, reported, monkeypatch
):
    def refuse():
        raise raised

    monkeypatch.setattr(jobs, "prepare_job", refuse)
    services.jobs.render(known, "audit")
    SimpleWorker([services.jobs.audits], serializer=JSONSerializer).work(burst=True)
    found = detail(api.get(f"creatures/{known}/audit"), 500)
    assert f"The audit failed: {reported}. Try again" in found
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


def test_the_motion_is_the_replay_made_small(api, services, known):
    positions = np.random.default_rng(0).uniform(0, 8, (9, 3, 2))
    scales = {"velocity": {"scale": 1.0}, "energy": {"scale": 1.0, "frames": 0}}
    data = replay(positions, 3, joints=[[0, 1]], **scales)
    renderings.save(services, known, REPLAY, data)
    answer = api.get(f"creatures/{known}/motion")
    assert answer.status_code == 200
    assert answer.content == motion.encode(read_replay(data))


@pytest.mark.parametrize("path", ["motion", "poses", "poses.csv", "poses.npz"])
def test_poses_without_a_stream_and_without_a_replay_order_the_replay(
    api, services, known, path
):
    answer = api.get(f"creatures/{known}/{path}")
    assert (answer.status_code, answer.json()) == (202, {"status": "rendering"})
    assert services.jobs.renderings.count == 1


def test_recorded_poses_are_sent_as_stored_and_told_by_a_tag(api, services, record, report):
    record(1, {3: 1.5}, poses=True)
    (elite,) = report(1, {3: 1.5}, poses=True).elites
    answer = api.get(f"creatures/{elite.creature}/poses")
    assert answer.content == elite.poses
    sent = {"If-None-Match": answer.headers["etag"]}
    assert api.get(f"creatures/{elite.creature}/poses", headers=sent).status_code == 304
    assert services.jobs.renderings.count == 0


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


@pytest.mark.parametrize("kind", ["film.gif", "replay", "poses", "poses.csv", "motion"])
def test_a_rendering_whose_file_is_lost_is_made_again(api, services, known, kind):
    stored = REPLAY if kind in ("poses", "poses.csv", "motion") else kind
    renderings.save(services, known, stored, b"lost")
    (file,) = Path(services.artifacts.root).glob("replays/*/*")
    file.unlink()
    for _ in range(2):
        assert api.get(f"creatures/{known}/{kind}").status_code == 202
    assert services.jobs.renderings.count == 1
    renderings.save(services, known, stored, b"again")
    assert renderings.existing(services, known, stored) == b"again"


def test_a_lost_rendering_takes_one_connection_at_a_time(services, known, monkeypatch):
    """With two, as many requests at once as there are connections wait for each other."""
    renderings.save(services, known, GIF, b"lost")
    held, fault = [], mark.fault

    def lost(artifact):
        raise FileLost(artifact.path)

    def looked(*given):
        held.append(own.sessions.engine.pool.checkedout())
        return fault(*given)

    monkeypatch.setattr(mark, "fault", looked)
    with closing(connect(services.settings)) as own:
        assert renderings.read(own, known, GIF, lost) is None
        assert own.sessions.engine.pool.checkedout() == 0
        with own.sessions.read() as session:
            assert renderings.find(session, known, GIF) is None
    assert held == [0]


def test_a_lost_audit_keeps_its_verdict_until_it_is_ordered_again(api, services, known):
    path = f"creatures/{known}/audit"
    renderings.save(services, known, AUDIT, audit(True))
    (file,) = Path(services.artifacts.root).glob("replays/*/*")
    whole = file.read_bytes()
    file.unlink()
    assert "The store has lost replays/" in detail(api.get(path), 500)
    assert services.jobs.audits.count == 0
    file.write_bytes(whole)  # From a backup.
    assert api.get(path).content == whole
    file.unlink()
    assert api.post(path).status_code == 202
    assert api.get(path).status_code == 202
    assert services.jobs.audits.count == 1
    assert api.get(f"creatures/{known}/verdict").json() == {"trusted": True}
    renderings.save(services, known, AUDIT, audit(False))
    assert api.get(path).json()["verdict"]["trusted"] is False
    assert api.get(f"creatures/{known}/verdict").json() == {"trusted": False}


def test_behind_a_lost_mount_no_rendering_is_lost(api, services, known):
    renderings.save(services, known, GIF, b"a film")
    store = Path(services.artifacts.root)
    away = store.rename(store.with_name("away"))
    found = detail(api.get(f"creatures/{known}/film.gif"), 503)
    assert found == "The store of files does not answer; try again."
    away.rename(store)
    assert api.get(f"creatures/{known}/film.gif").content == b"a film"


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
