"""Shares of an archive: as it was, without its owner's notes."""

import errno
from pathlib import Path

import pytest
from answers import detail

from microcosmos.archive import file
from microcosmos.client import Client, sharing
from microcosmos_server.attempts.claim import claim
from microcosmos_server.renderings import storage as renderings
from microcosmos_server.storage.artifacts import Artifacts
from microcosmos_server.storage.garbage import remove_files
from microcosmos_server.tables import LOOP, PREVIEW, REPLAY, Artifact


@pytest.fixture
def attempt(services, run_id, report):
    """An attempt that has recorded two generations and saved a file."""
    held = claim(services, run_id, "worker")
    held.record(report(1, {3: 1.0}), 1.0)
    held.record(report(2, {3: 2.0, 7: 1.5}), 1.0)
    held.save(2, file.dump({"archive": {"cell": [3, 7]}}, {"format": file.FORMAT}))
    return held


@pytest.fixture
def archive(api, run_id, attempt) -> dict:
    sent = {"run": str(run_id), "title": "Swimmers", "credit": "Ada", "licence": "CC0-1.0"}
    return api.post("shares", json=sent).json()


def test_an_archive_is_shared_as_it_was(through, archive, attempt, report, run_id):
    slug, under = archive["slug"], f"runs/{run_id}"
    before = through(slug, f"{under}/archive").json()
    assert (archive["generation"], before["generation"]) == (2, 2)
    later = report(3, {3: 9.0, 8: 9.0})
    attempt.record(later, 1.0)
    assert through(slug, f"{under}/archive").json() == before
    assert through(slug, f"{under}/archive", params={"generation": 3}).status_code == 422
    assert before["cell"] == [3, 7]
    assert through(slug, under).json()["face"] == before["creature"][0]
    history = through(slug, f"{under}/archive/history").json()
    assert history["fitness"] == [1.0, 2.0, 1.5]
    assert through(slug, f"{under}/generations").json()["generation"] == [1, 2]
    for sha in history["creature"]:
        assert through(slug, f"creatures/{sha}").status_code == 200
    for elite in later.elites:
        found = through(slug, f"creatures/{elite.creature}")
        assert found.status_code == 404


def test_a_share_shows_the_poses_of_its_elites_and_no_later_ones(
    api, through, archive, attempt, report, run_id
):
    attempt.record(report(3, {3: 9.0, 8: 9.0}, poses=True), 1.0)
    path = f"runs/{run_id}/archive/poses"
    assert len(api.get(path, params={"cells": "3,7,8"}).content) > 0
    shared = through(archive["slug"], path, params={"cells": "3,7,8"})
    assert (shared.status_code, shared.content) == (200, b"")


def test_a_shared_run_hides_its_owners_notes(api, through, archive, run_id):
    api.patch(f"runs/{run_id}", json={"name": "mine", "tags": ["a"], "note": "secret"})
    answer = through(archive["slug"], f"runs/{run_id}")
    assert "secret" not in answer.text
    run = answer.json()
    assert (run["name"], run["tags"], run["note"]) == ("Swimmers", [], None)
    assert (run["status"], run["generation"], run["best"]) == ("finished", 2, 2.0)
    other = "00000000-0000-4000-8000-000000000000"
    assert through(archive["slug"], f"runs/{other}").status_code == 404


def test_the_file_of_an_archive_carries_licence_and_credit(
    api, through, archive, attempt, run_id
):
    slug, under = archive["slug"], f"runs/{run_id}"
    _, attributes = file.load(through(slug, f"{under}/archive.h5").content)
    assert (attributes["licence"], attributes["credit"]) == ("CC0-1.0", '["Ada"]')
    attempt.save(2, file.dump({"archive": {"cell": [1]}}, {"format": file.FORMAT}))
    tree, _ = file.load(through(slug, f"{under}/archive.h5").content)
    assert list(tree["archive"]["cell"]) == [3, 7], "as it was when it was shared"
    api.delete(f"shares/{archive['slug']}")
    assert through(slug, f"{under}/archive.h5").status_code == 410


def test_an_archive_is_shared_under_the_terms_of_all_its_creatures(
    api, through, run_id, attempt, report
):
    sent = {"run": str(run_id)}
    first = api.post("shares", json=sent).json()
    assert (first["licence"], first["credit"]) == ("CC-BY-4.0", [])
    attempt.terms = {"licence": "CC-BY-NC-4.0", "credit": ["Ada"]}
    attempt.record(report(3, {8: 0.5}), 1.0)
    shared = api.post("shares", json=sent | {"generation": 3}).json()
    assert (shared["licence"], shared["credit"]) == ("CC-BY-NC-4.0", ["Ada"])
    again = api.post("shares", json=sent | {"generation": 2}).json()
    assert (again["licence"], again["credit"]) == ("CC-BY-4.0", []), "as it was"


def test_a_past_generation_is_shared_without_a_file(api, through, run_id, attempt):
    answer = api.post("shares", json={"run": str(run_id), "generation": 1})
    assert (answer.status_code, answer.json()["generation"]) == (201, 1)
    slug, under = answer.json()["slug"], f"runs/{run_id}"
    assert through(slug, f"{under}/archive").json()["fitness"] == [1.0]
    assert "The share has no file" in through(slug, f"{under}/archive.h5").json()["detail"]
    beyond = api.post("shares", json={"run": str(run_id), "generation": 3})
    assert beyond.json()["errors"][0]["field"] == "generation"


def test_an_archive_is_published_on_a_full_disk_and_gets_its_file_later(
    api, through, attempt, run_id, monkeypatch
):
    def refuse(artifacts, path, data):
        raise OSError(errno.ENOSPC, "No space left on device", path)

    sent = {"run": str(run_id), "listed": True}
    with monkeypatch.context() as full:
        full.setattr(Artifacts, "write", refuse)
        first = api.post("shares", json=sent)
    assert first.status_code == 201
    slug, path = first.json()["slug"], f"runs/{run_id}/archive.h5"
    assert "has no file of generation 2" in detail(through(slug, path), 404)
    again = api.post("shares", json=sent)
    assert (again.status_code, again.json()["slug"]) == (200, slug)
    assert through(slug, path).status_code == 200


@pytest.mark.postgresql
def test_a_share_whose_file_is_lost_gets_another_when_it_is_published_again(
    api, services, through, archive, attempt, run_id
):
    slug, path = archive["slug"], f"runs/{run_id}/archive.h5"
    (Path(services.artifacts.root) / "shares" / f"{slug}.h5").unlink()
    assert f"The store has lost shares/{slug}.h5" in detail(through(slug, path), 500)
    # The newest file of the generation, which is another one by now.
    attempt.save(2, file.dump({"archive": {"cell": [3, 7, 8]}}, {"format": file.FORMAT}))
    sent = {"run": str(run_id), "title": "Swimmers", "credit": "Ada", "licence": "CC0-1.0"}
    assert api.post("shares", json={**sent, "generation": 2}).json()["slug"] == slug
    answer = through(slug, path)
    assert list(file.load(answer.content)[0]["archive"]["cell"]) == [3, 7, 8]
    with services.sessions.read() as session:
        row = session.get(Artifact, f"shares/{slug}.h5")
    assert services.artifacts.read_verified(row.path, row.sha256) == answer.content
    assert row.size == len(answer.content)


@pytest.mark.postgresql
def test_a_share_that_is_revoked_while_its_file_is_written_leaves_none(
    api, services, attempt, run_id, monkeypatch
):
    write = Artifacts.write

    def revoke_then_write(artifacts, path, data):
        api.delete(f"shares/{path.removeprefix('shares/').removesuffix('.h5')}")
        return write(artifacts, path, data)

    with monkeypatch.context() as slow:
        slow.setattr(Artifacts, "write", revoke_then_write)
        slug = api.post("shares", json={"run": str(run_id)}).json()["slug"]
    path = f"shares/{slug}.h5"
    with services.sessions.read() as session:
        assert session.get(Artifact, path) is None
    assert services.artifacts.find(path)
    assert remove_files(services.sessions, services.artifacts)
    assert services.artifacts.find(path) is None


def test_renderings_for_shares_wait_last_and_are_limited(
    through, services, archive, attempt, monkeypatch
):
    monkeypatch.setattr(renderings, "ANONYMOUS_LIMIT", 3)
    ordered = [job.args for job in services.jobs.renderings.get_jobs()]
    names = through(archive["slug"], f"runs/{archive['run']}/archive/history").json()
    for sha in names["creature"]:
        answer = through(archive["slug"], f"creatures/{sha}/poses")
        assert (answer.status_code, answer.json()) == (202, {"status": "rendering"})
    jobs = services.jobs.renderings.get_jobs()
    assert ordered == [[archive["cover"], PREVIEW], [archive["cover"], LOOP]]
    assert [job.args for job in jobs] == [*ordered, [names["creature"][0], REPLAY]]


def test_a_deleted_run_leaves_the_commons_until_restored(
    api, through, services, attempt, run_id
):
    attempt.finish()
    sent = {"run": str(run_id), "title": "Swimmers", "listed": True}
    share = api.post("shares", json=sent).json()
    under, film = f"shares/{share['slug']}", f"creatures/{share['cover']}/film.gif"
    renderings.save(services, share["cover"], "film.gif", b"GIF")
    assert api.get("commons").json()["items"] == [share]
    assert api.delete(f"runs/{run_id}").status_code == 200
    for path in ("", "/preview.png"):
        assert api.get(under + path).status_code == 410, path
    for path in (f"runs/{run_id}", f"runs/{run_id}/archive.h5", film):
        assert through(share["slug"], path).status_code == 410, path
    assert api.get("commons").json()["items"] == []
    assert api.post(f"runs/{run_id}/restore").status_code == 200
    assert api.get("commons").json()["items"] == [share]
    assert through(share["slug"], film).status_code == 200


def test_a_client_carries_out_a_shared_run_again(address, archive, spec):
    at = sharing.address(f"{address}/s/{archive['slug']}")
    assert at
    with Client(address) as client:
        run = client.submit(f"{address}/s/{archive['slug']}")
        assert run.spec == sharing.spec(at)
    assert run.id != archive["run"]


def test_all_creatures_of_an_archive_are_imported_the_best_first(
    api, address, archive, attempt, report, monkeypatch
):
    attempt.record(report(3, {3: 9.0, 8: 9.0}), 1.0)  # Later than the share.
    found = api.get(f"runs/{archive['run']}/archive", params={"generation": 2}).json()
    names = api.get(f"shares/{archive['slug']}/creatures.json").json()["creatures"]
    assert (names, found["fitness"]) == (found["creature"], [2.0, 1.5])
    with Client(address) as client:
        assert [one.sha for one in client.import_all(archive["url"])] == names
        (one,) = client.import_all(f"{archive['url']}/creatures/{names[1]}")
        assert one.sha == names[1]
        whole = sharing.Address.read

        def forged(self, path, headers=None, **params):
            document = whole(self, path, headers, **params)
            if params.get("creature") == names[1]:
                document["identity"]["task"]["steps"] += 1
            return document

        monkeypatch.setattr(sharing.Address, "read", forged)
        with pytest.raises(ValueError, match="sha256"):
            list(client.import_all(archive["url"]))
