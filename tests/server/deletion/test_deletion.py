"""The bin and the purge: deleted runs come back whole or leave nothing."""

from pathlib import Path

import pytest
from answers import detail
from deletion import delete_for_good, files, finish, let_time_pass, row_counts, submit_another
from sqlalchemy import select, update

from microcosmos.archive import creature
from microcosmos_server.attempts.claim import claim
from microcosmos_server.core.database import clock
from microcosmos_server.deletion import purge
from microcosmos_server.maintenance.reconcile import reconcile
from microcosmos_server.notifications import outbox
from microcosmos_server.renderings.storage import existing, save
from microcosmos_server.runs import lifecycle
from microcosmos_server.shares import access
from microcosmos_server.storage import garbage
from microcosmos_server.tables import (
    GIF,
    REPLAY,
    Artifact,
    Creature,
    Elite,
    GarbageCreature,
    GarbageFile,
    Parent,
    Run,
    Share,
)

pytestmark = pytest.mark.postgresql


def test_a_deleted_run_is_hidden_and_restored_unchanged(api, services, run_id, report):
    finish(services, run_id, report(1, {0: 1.0}))
    api.patch(f"runs/{run_id}", json={"tags": ["mine"]})
    before = api.get(f"runs/{run_id}").json()
    deleted = api.delete(f"runs/{run_id}")
    assert deleted.status_code == 200
    assert deleted.json()["deleted_at"]
    assert deleted.json()["purge_at"] > deleted.json()["deleted_at"]
    assert api.get("runs").json()["items"] == api.get("tags").json() == []
    assert [r["id"] for r in api.get("runs?deleted=true").json()["items"]] == [str(run_id)]
    assert api.get(f"runs/{run_id}").json() == deleted.json()
    for path in ("archive", "archive.h5", "generations", "log"):
        answer = api.get(f"runs/{run_id}/{path}")
        assert answer.status_code == 404, path
    answer = api.get(f"runs/{run_id}/archive")
    assert "is in the bin until" in answer.json()["detail"]
    bodies = {"extend": {"generations": 1}, "fork": {"from": {"archive": True}}}
    for action in ("resume", "cancel", "extend", "fork"):
        answer = api.post(f"runs/{run_id}/{action}", json=bodies.get(action))
        assert answer.status_code == 404
    assert api.post(f"runs/{run_id}/restore").json() == before
    assert api.get("runs?deleted=true").json()["items"] == []
    assert api.get(f"runs/{run_id}/archive").json()["cell"] == [0]


def test_an_event_that_waits_for_the_webhook_outlives_its_run(api, services, run_id):
    claim(services, run_id, "worker").refuse("ValueError: 3 is no body")
    delete_for_good(api, services, run_id)
    one = outbox.take(services)
    assert (one.run_id, one.kind) == (run_id, "run.failed")
    assert outbox.take(services) is None


def test_only_idle_runs_are_deleted_and_restored_in_time(api, services, run_id):
    attempt = None
    for status in ("queued", "running"):
        refused = detail(api.delete(f"runs/{run_id}"), 409)
        assert refused.endswith(
            "it must be finished, failed, cancelled or paused: cancel it first"
        )
        assert f"it is {status}; " in refused
        attempt = attempt or claim(services, run_id, "worker")
    api.post(f"runs/{run_id}/pause")
    attempt.pause()
    assert "it is paused" in detail(api.post(f"runs/{run_id}/restore"), 409)
    assert api.delete(f"runs/{run_id}").json()["status"] == "paused"
    assert api.delete(f"runs/{run_id}").status_code == 404
    let_time_pass(services, run_id)
    assert api.post(f"runs/{run_id}/restore").status_code == 409
    assert api.get(f"runs/{run_id}").json()["deleted_at"]


def test_the_bin_keeps_runs_for_a_day(api, services, run_id, report):
    finish(services, run_id, report(1, {0: 1.0}))
    api.delete(f"runs/{run_id}")
    before = row_counts(services), files(services)
    reconcile(services)
    assert (row_counts(services), files(services)) == before
    with services.sessions.read() as session:
        run = session.get_one(Run, run_id)
    assert (run.purge_at - run.deleted_at).total_seconds() == 86_400


def test_a_purge_is_published(api, services, run_id, published):
    api.post(f"runs/{run_id}/cancel")
    delete_for_good(api, services, run_id)
    assert [kind for kind, _ in published()][-2:] == ["run", "purge"]


@pytest.fixture
def child(identity):
    """A report whose one elite is a creature with parents."""

    def make(report, number, parents):
        found = identity(number)
        elite = report.elites[0]
        elite.creature = creature.name(found)
        elite.identity = creature.canonical(found)
        elite.provenance = {**elite.provenance, "parents": parents}
        return report

    return make


def test_a_purge_leaves_no_row_or_file(api, services, spec, report, run_id):
    other = submit_another(services, spec, 7)
    finish(services, other, report(1, {3: 1.0}))
    before = row_counts(services), files(services)
    doomed = submit_another(services, spec, 8, key="a key")
    attempt = claim(services, doomed, "worker")
    attempt.record(report(1, {0: 1.0, 1: 2.0}), 1.0)
    attempt.save(1, b"one")
    attempt.record(report(2, {2: 1.0}), 1.0)
    again = claim(services, doomed, "worker")  # What was rewound counts as the run's too.
    again.record(report(2, {0: 3.0}, emptied=(1,)), 1.0)
    again.save(2, b"two")
    again.finish()
    named = set(api.get(f"runs/{doomed}/archive/history").json()["creature"])
    for name in named:
        save(services, name, REPLAY, name.encode())
    stray = Path(services.settings.artifacts) / f"runs/{doomed}/stray.part"
    stray.write_bytes(b"of a process that was killed")
    during = row_counts(services)
    assert during["creatures"] == before[0]["creatures"] + 4
    assert during["artifacts"] == before[0]["artifacts"] + 2 + len(named)
    delete_for_good(api, services, doomed)
    assert (row_counts(services), files(services)) == before
    assert not stray.parent.exists()
    assert api.get(f"creatures/{next(iter(named))}").status_code == 404


def test_a_purge_keeps_what_others_use(api, services, spec, report, identity, child, run_id):
    """Uses: another run, an import, initial creatures, and ancestors of those."""
    doomed, other = submit_another(services, spec, 1), submit_another(services, spec, 2)
    shared, brought, parent, grandparent, alone = (
        creature.name(identity(number)) for number in (1000, 1001, 1002, 1003, 1004)
    )
    finish(
        services,
        doomed,
        child(report(1, {3: 1.0}), 1003, []),
        child(report(2, {2: 1.0}), 1002, [grandparent]),
        child(report(3, {0: 1.0}), 1000, []),
        child(report(4, {1: 1.0}), 1001, []),
        child(report(5, {4: 1.0}), 1004, [parent]),
    )
    finish(services, other, report(1, {0: 1.0}), child(report(2, {5: 1.0}), 2000, [parent]))
    document = creature.document(identity(1001), None, None)
    assert api.post("creatures", json=document).status_code == 200
    for name in (shared, parent, alone):
        save(services, name, REPLAY, b"replay")
    kept = {name: api.get(f"creatures/{name}").json() for name in (shared, brought, parent)}
    delete_for_good(api, services, doomed)
    assert {name: api.get(f"creatures/{name}").json() for name in kept} == kept
    assert api.get(f"creatures/{grandparent}").status_code == 200
    assert api.get(f"creatures/{alone}").status_code == 404
    assert drawn(services) == {shared, parent}
    delete_for_good(api, services, other)
    assert [name for name in kept if api.get(f"creatures/{name}").status_code == 200] == [
        brought
    ], "what stayed for the sake of another goes with that"
    assert api.get(f"creatures/{grandparent}").status_code == 404


def test_a_purge_may_be_killed_anywhere(api, services, spec, report, run_id, monkeypatch):
    """Stop it after every transaction. A partly purged run cannot be restored."""
    monkeypatch.setattr(purge, "ROWS_PER_TRANSACTION", 2)
    monkeypatch.setattr("microcosmos_server.deletion.purge.CREATURES_PER_TRANSACTION", 2)
    before = row_counts(services), files(services)
    doomed = submit_another(services, spec, 3)
    finish(services, doomed, *(report(g, {0: g, 1: g, 2: g}) for g in range(1, 4)))
    api.delete(f"runs/{doomed}")
    let_time_pass(services, doomed)
    passes, steps = 0, (purge.purge_rows, purge.collect_creatures, purge.remove_files)
    while (row_counts(services), files(services)) != before:
        any(step(services) for step in steps)
        assert api.post(f"runs/{doomed}/restore").status_code in (404, 409)
        passes += 1
        assert passes < 100
    assert passes > 8


def test_a_file_that_cannot_be_removed_is_removed_later(
    api, services, run_id, report, monkeypatch
):
    def refuse(path):
        raise PermissionError(path)

    finish(services, run_id, report(1, {0: 1.0}))
    with monkeypatch.context() as patch:
        patch.setattr(services.artifacts, "delete", refuse)
        delete_for_good(api, services, run_id)
    assert len(files(services)) == row_counts(services)["garbage_files"] == 1
    reconcile(services)
    assert files(services) == []
    assert row_counts(services)["garbage_files"] == 0


def test_a_pass_ends_in_time_and_the_next_one_continues(services, monkeypatch):
    monkeypatch.setattr(purge, "SECONDS", 0.0)
    monkeypatch.setattr(garbage, "FILES_PER_STEP", 2)
    for number in range(5):
        services.artifacts.write(f"shares/{number}.h5", b"")
    with services.sessions.write.begin() as session:
        garbage.discard(session, [f"shares/{number}.h5" for number in range(5)])
    for left in (3, 1, 0):
        purge.purge(services)
        assert len(files(services)) == row_counts(services)["garbage_files"] == left


@pytest.mark.parametrize("local", [True, False])
def test_files_that_cannot_be_removed_do_not_keep_others(services, monkeypatch, local):
    """An object store may lock some of its objects."""
    monkeypatch.setattr(garbage, "FILES_PER_STEP", 2)
    remove = services.artifacts.delete

    def refuse_some(path):
        if path.startswith("shares/locked"):
            raise PermissionError(path)
        remove(path)

    names = [f"shares/{name}.h5" for name in ("locked-1", "locked-2", "x", "y", "z")]
    for name in names:
        services.artifacts.write(name, b"")
    with services.sessions.write.begin() as session:
        garbage.discard(session, names)
    monkeypatch.setattr(services.artifacts, "delete", refuse_some)
    monkeypatch.setattr(services.artifacts, "local", local)
    for _ in range(3):
        purge.purge(services)
    assert files(services) == names[:2]


def test_behind_a_lost_mount_no_file_counts_as_deleted(services):
    services.artifacts.write("shares/one.h5", b"")
    with services.sessions.write.begin() as session:
        garbage.discard(session, ["shares/one.h5"])
    store = Path(services.artifacts.root)
    away = store.rename(store.with_name("elsewhere"))
    store.mkdir()
    assert not garbage.remove_files(services.sessions, services.artifacts)
    assert row_counts(services)["garbage_files"] == 1
    store.rmdir()
    away.rename(store)
    assert garbage.remove_files(services.sessions, services.artifacts)
    assert files(services) == []


def test_a_file_that_a_row_names_is_kept(services, run_id, report):
    """Two publications of one archive write one file, and one of them ends early."""
    finish(services, run_id, report(1, {0: 1.0}))
    (path,) = files(services)
    with services.sessions.write.begin() as session:
        garbage.discard(session, [path])
    purge.purge(services)
    assert files(services) == [path]


def drawn(services):
    """The creatures of the files that are renderings."""
    names = (Path(file).name for file in files(services) if file.startswith("replays/"))
    return {name.partition("-")[0] for name in names}


def test_a_rendering_that_was_made_again_replaces_the_file(services, run_id, report, identity):
    finish(services, run_id, report(1, {0: 1.0}), files=False)
    name = creature.name(identity(1000))
    save(services, name, GIF, b"a film")
    save(services, name, GIF, b"a film")
    reconcile(services)
    (kept,) = files(services)
    assert services.artifacts.read(kept) == existing(services, name, GIF) == b"a film"
    assert row_counts(services)["garbage_files"] == 0


@pytest.mark.parametrize("write", ["rendering", "share"])
def test_a_file_without_its_row_is_deleted_in_time(
    api, services, run_id, report, identity, monkeypatch, write
):
    """The database goes away, or the process ends, between the two."""
    finish(services, run_id, report(1, {0: 1.0}))
    with monkeypatch.context() as patch:
        patch.setattr(access, "copy_checkpoint", lambda *_: None)
        slug = api.post("shares", json={"run": str(run_id)}).json()["slug"]
    before = files(services)
    write_file = services.artifacts.write

    def write_and_end(_, path, data):
        write_file(path, data)
        raise KeyboardInterrupt

    def write_file_of_share():
        with services.sessions.read() as session:
            share = session.get_one(Share, slug)
        access.copy_checkpoint(services, share)

    def write_rendering():
        save(services, creature.name(identity(1000)), GIF, b"a film")

    monkeypatch.setattr(access.export, "licensed", lambda data, *_: data)
    with monkeypatch.context() as patch:
        patch.setattr(type(services.artifacts), "write", write_and_end)
        with pytest.raises(KeyboardInterrupt):
            {"rendering": write_rendering, "share": write_file_of_share}[write]()
    (lost,) = set(files(services)) - set(before)
    purge.purge(services)
    assert lost in files(services)  # Its writer may be about to insert the row.
    with services.sessions.write.begin() as session:
        session.execute(update(GarbageFile).values(due_at=clock()))
    purge.purge(services)
    assert files(services) == before


def test_a_restored_run_is_not_purged_and_a_purged_one_is_not_restored(
    services, run_id, report, api
):
    """Purge and restore each check the time in their own transaction."""
    finish(services, run_id, report(1, {0: 1.0}))
    api.delete(f"runs/{run_id}")
    assert not purge.purge_rows(services)
    let_time_pass(services, run_id)
    with services.sessions.write.begin() as session:
        run = session.get_one(Run, run_id)
        with pytest.raises(Exception, match="Cannot restore this run"):
            lifecycle.restore(session, run)
    assert purge.purge_rows(services)


def test_a_creature_that_comes_into_use_during_a_purge_stays(
    services, run_id, spec, report, api
):
    """Another run records the creature between the purge and the garbage collection."""
    other = submit_another(services, spec, 4)
    finish(services, run_id, report(1, {0: 1.0}))
    api.delete(f"runs/{run_id}")
    let_time_pass(services, run_id)
    while purge.purge_rows(services):
        pass
    assert row_counts(services)["garbage_creatures"] == 1
    claim(services, other, "worker").record(report(1, {0: 1.0}), 1.0)
    reconcile(services)
    with services.sessions.read() as session:
        used = session.scalars(select(Elite.creature)).all()
        kept = session.scalars(select(Creature.sha256)).all()
        renderings = select(Artifact.path).where(Artifact.creature.in_(kept))
        assert session.scalars(select(GarbageCreature.creature)).all() == []
        assert session.scalars(renderings).all() == []
        assert session.scalars(select(Parent.child)).all() == kept
    assert used == kept
