"""Shares of an archive: as it was, without its owner's notes."""

import pytest

from microcosmos.archive import file
from microcosmos.client import Client, shared
from server.attempts.claim import claim
from server.renderings import storage as renderings
from server.tables import LOOP, PREVIEW, REPLAY


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
    assert through(slug, f"{under}/archive", params={"generation": 3}).json() == before
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


def test_a_past_generation_is_shared_without_a_file(api, through, run_id, attempt):
    answer = api.post("shares", json={"run": str(run_id), "generation": 1})
    assert (answer.status_code, answer.json()["generation"]) == (201, 1)
    slug, under = answer.json()["slug"], f"runs/{run_id}"
    assert through(slug, f"{under}/archive").json()["fitness"] == [1.0]
    assert "The share has no file" in through(slug, f"{under}/archive.h5").json()["detail"]
    beyond = api.post("shares", json={"run": str(run_id), "generation": 3})
    assert beyond.json()["errors"][0]["field"] == "generation"


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
    at = shared.address(f"{address}/s/{archive['slug']}")
    assert at
    with Client(address) as client:
        run = client.submit(f"{address}/s/{archive['slug']}")
        assert run.spec == shared.spec(at)
    assert run.id != archive["run"]


def test_the_address_of_an_archive_stands_for_its_best(archive):
    at = shared.address(archive["url"])
    assert at
    assert shared.creature(at)["sha256"] == archive["cover"]


def test_all_creatures_of_an_archive_are_imported_the_best_first(
    api, address, archive, attempt, report, monkeypatch
):
    attempt.record(report(3, {3: 9.0, 8: 9.0}), 1.0)  # Later than the share.
    found = api.get(f"runs/{archive['run']}/archive", params={"generation": 2}).json()
    (best, other) = found["creature"]
    assert found["fitness"] == [2.0, 1.5]
    names = api.get(f"shares/{archive['slug']}/creatures.json").json()["creatures"]
    assert names == [best, other]
    with Client(address) as client:
        assert [one.sha for one in client.import_all(archive["url"])] == names
        (one,) = client.import_all(f"{archive['url']}/creatures/{other}")
        assert one.sha == other
    at = shared.address(archive["url"])
    assert at
    assert [one["sha256"] for one in shared.creatures(at)] == names
    assert all(one["ancestors"] == [] for one in shared.creatures(at))
    whole = shared.Address.read

    def forged(self, path, headers=None, **params):
        document = whole(self, path, headers, **params)
        if params.get("creature") == other:
            document["identity"]["task"]["steps"] += 1
        return document

    monkeypatch.setattr(shared.Address, "read", forged)
    with Client(address) as client, pytest.raises(ValueError, match="sha256"):
        list(client.import_all(archive["url"]))
