"""Replays, films, pictures, motions and measurements on request."""

import json
import struct

import httpx
import numpy as np
import pytest
from answers import detail
from reports import audit, replay
from sqlalchemy import select
from sqlalchemy.exc import IntegrityError

from microcosmos.archive import creature
from microcosmos.viz.replay_file import REPLAY_VERSION
from server.renderings import storage as renderings
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
        ("audit", "application/json", b'{"verdict": {"trusted": true}}'),
        ("strip.png", "image/png", b"a picture"),
        ("film.gif", "image/gif", b"a film"),
        ("film.mp4", "video/mp4", b"another film"),
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


def read(data: bytes) -> tuple[dict, np.ndarray]:
    (length,) = struct.unpack_from("<I", data)
    header = json.loads(data[4 : 4 + length])
    positions = np.frombuffer(data[4 + length :], "<f4")
    return header, positions.reshape(header["frames"], header["nodes"], 2)


@pytest.mark.parametrize(("frames", "stride"), [(7, 1), (96, 1), (97, 2), (1001, 11)])
def test_a_motion_is_every_kth_frame_of_the_replay(api, services, known, frames, stride):
    positions = np.random.default_rng(0).normal(size=(frames, 3, 2)).astype(np.float32)
    renderings.save(services, known, REPLAY, replay(positions))
    answer = api.get(f"creatures/{known}/motion")
    header, motion = read(answer.content)
    np.testing.assert_array_equal(motion, positions[::stride])
    assert header["every"] == 5 * stride
    assert (header["nodes"], header["edges"], header["size"]) == (3, [[0, 1], [1, 2]], [8, 4])
    known_already = {"If-None-Match": answer.headers["etag"]}
    again = api.get(f"creatures/{known}/motion", headers=known_already)
    assert (again.status_code, again.content) == (304, b"")


def test_a_motion_without_replay_orders_the_replay(api, services, known):
    answer = api.get(f"creatures/{known}/motion")
    assert (answer.status_code, answer.json()) == (202, {"status": "rendering"})
    assert services.jobs.renderings.count == 1


@pytest.fixture
def measured(upload, report) -> str:
    (elite,) = report(1, {3: 1.5}).elites
    return upload(json.loads(elite.identity), elite.measured, elite.provenance)


def test_a_creature_is_measured_again_on_request_and_repeatedly(api, services, measured):
    path = f"creatures/{measured}/measurement"
    assert api.get(path).status_code == 204
    assert services.jobs.audits.count == 0, "looking orders nothing"
    for _ in range(2):
        assert api.post(f"creatures/{measured}/measure").status_code == 202
        assert api.get(path).status_code == 202
    (job,) = services.jobs.audits.get_jobs()
    assert job.args == [measured, MEASUREMENT]
    services.jobs.remove(job.id)
    renderings.save(services, measured, MEASUREMENT, b'{"exact": true}')
    assert api.get(path).json() == {"exact": True}
    api.post(f"creatures/{measured}/measure")
    assert api.get(path).status_code == 202


def test_an_unmeasured_creature_is_not_measured_again(api, known):
    answer = api.post(f"creatures/{known}/measure")
    assert (answer.status_code, answer.json()["title"]) == (422, "Never measured")


def test_a_measurement_that_failed_says_why(api, services, measured):
    api.post(f"creatures/{measured}/measure")
    (job,) = services.jobs.audits.get_jobs()
    services.jobs.give_up(job, "Traceback\nValueError: out of memory\n")
    refused = detail(api.get(f"creatures/{measured}/measurement"), 500)
    assert "The measurement failed: ValueError: out of memory" in refused
