"""Orders of renderings, and what comes of them."""

import httpx
import pytest
from sqlalchemy import select

from microcosmos.archive import creature
from microcosmos.viz.replay_file import REPLAY_VERSION
from server.renderings import storage as renderings
from server.tables import REPLAY, Artifact


@pytest.fixture
def known(api, identity) -> str:
    file = creature.document(identity(3), None, None)
    return api.post("creatures", json=file).json()["creature"]


def test_a_replay_that_the_engine_refuses_is_refused_in_its_words(api, services, known):
    error = creature.CreatureError("task.steps", "at most 1 cell step for a replay", 2)
    services.jobs.render(known)
    job = services.jobs.find(services.jobs.rendering_id(known))
    services.jobs.give_up(job, f"Traceback\n{type(error).__module__}.CreatureError: {error}\n")
    answer = api.get(f"creatures/{known}/replay")
    assert answer.status_code == 500
    said = "The replay failed: `task.steps` needs at most 1 cell step"
    assert answer.json()["detail"].startswith(said)
    assert services.jobs.renderings.count == 0


def test_an_order_that_vanishes_while_it_is_looked_at_is_no_error(services, known, monkeypatch):
    services.jobs.render(known)
    job = services.jobs.find(services.jobs.rendering_id(known))
    services.jobs.forget(job.id)
    monkeypatch.setattr(services.jobs, "find", lambda _: job)
    renderings.order(services, known)


def test_a_range_beyond_all_numbers_is_ignored(api, services, known):
    renderings.save(services, known, REPLAY, b"the replay")
    for wanted in ("bytes=" + "9" * 5000 + "-", "bytes=-" + "9" * 5000):
        answer: httpx.Response = api.get(f"creatures/{known}/replay", headers={"Range": wanted})
        assert (answer.status_code, answer.content) == (200, b"the replay")


@pytest.mark.parametrize(
    ("kind", "media_type"),
    [
        ("replay", "application/octet-stream"),
        ("audit", "application/json"),
        ("strip.png", "image/png"),
        ("film.gif", "image/gif"),
        ("film.mp4", "video/mp4"),
    ],
)
def test_each_kind_is_made_once_and_then_kept(api, services, known, kind, media_type):
    for _ in range(2):
        answer = api.get(f"creatures/{known}/{kind}")
        assert (answer.status_code, answer.json()) == (202, {"status": "rendering"})
        assert answer.headers["retry-after"] == "1"
    jobs = services.jobs
    (job_id,) = (*jobs.renderings.get_job_ids(), *jobs.audits.get_job_ids())
    assert jobs.find(job_id).args == [known, kind]
    renderings.save(services, known, kind, b"what was made")
    answer = api.get(f"creatures/{known}/{kind}")
    assert (answer.status_code, answer.content) == (200, b"what was made")
    assert answer.headers["content-type"] == media_type
    again = api.get(
        f"creatures/{known}/{kind}", headers={"If-None-Match": answer.headers["etag"]}
    )
    assert again.status_code == 304
    assert renderings.existing(services, known, kind) == b"what was made"


def test_a_film_is_saved_under_the_creatures_name(api, services, known):
    renderings.save(services, known, "film.gif", b"GIF")
    answer = api.get(f"creatures/{known}/film.gif")
    expected = f'inline; filename="creature-{known[:12]}.gif"'
    assert answer.headers["content-disposition"] == expected


def test_one_kind_that_failed_leaves_the_others_alone(api, services, known):
    services.jobs.render(known, "audit")
    job = services.jobs.find(services.jobs.rendering_id(known, "audit"))
    services.jobs.give_up(job, "Traceback\nValueError: too large to refine\n")
    answer = api.get(f"creatures/{known}/audit")
    assert answer.status_code == 500
    assert "The audit failed: ValueError: too large" in answer.json()["detail"]
    assert api.get(f"creatures/{known}/film.gif").status_code == 202


def test_who_waits_to_watch_is_served_first(services, known):
    for kind in ("audit", "film.mp4", "replay"):
        services.jobs.render(known, kind)
    waiting = services.jobs.renderings.get_job_ids()
    kinds = [services.jobs.find(job_id).args[1] for job_id in waiting]
    assert kinds == ["replay", "film.mp4"], "and no audit before or among them"


def test_what_failed_is_told_by_the_first_line_of_what_was_raised(api, services, known):
    services.jobs.render(known, "audit")
    job = services.jobs.find(services.jobs.rendering_id(known, "audit"))
    raised = "sqlalchemy.exc.OperationalError: database is locked\n[SQL: BEGIN]\n(Background)"
    services.jobs.give_up(job, f'Traceback\n  File "a.py"\n    begin()\n{raised}\n')
    detail = api.get(f"creatures/{known}/audit").json()["detail"]
    assert "OperationalError: database is locked. It can" in detail


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
