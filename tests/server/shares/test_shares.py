"""Publishing creatures and archives, and what strangers come to see of them."""

import re
from datetime import UTC, datetime, timedelta

import httpx
import pytest
from pydantic import SecretStr

from microcosmos.archive import creature, file
from server.attempts.begin import claim
from server.renderings import storage as renderings
from server.tables import PREVIEW, REPLAY, Share

STRANGE = {"Host": "microcosmos.example"}


@pytest.fixture
def known(api, identity) -> str:
    file = creature.document(identity(3), None, None)
    return api.post("creatures", json={**file, "credit": ["Ada"]}).json()["creature"]


@pytest.fixture
def other(api, identity) -> str:
    file = creature.document(identity(4), None, None)
    return api.post("creatures", json=file).json()["creature"]


@pytest.fixture
def shared(api, known) -> dict:
    answer = api.post("shares", json={"creature": known, "title": "A swimmer"})
    assert answer.status_code == 201
    return answer.json()


@pytest.fixture
def attempt(services, run_id, report):
    """A run that has come to its second generation, with a file of it."""
    held = claim(services, run_id, "worker")
    held.record(report(1, {3: 1.0}), 1.0)
    held.record(report(2, {3: 2.0, 7: 1.5}), 1.0)
    held.save(2, file.dump({"archive": {"cell": [3, 7]}}, {"format": file.FORMAT}))
    return held


@pytest.fixture
def archive(api, run_id, attempt) -> dict:
    sent = {"run": str(run_id), "title": "Swimmers", "credit": "Ada", "licence": "CC0-1.0"}
    return api.post("shares", json=sent).json()


def test_a_creature_is_published_under_a_name_that_cannot_be_guessed(api, shared, known):
    assert re.fullmatch(r"[\w-]{32}", shared["slug"], re.ASCII)  # 192 random bits.
    assert shared["url"].endswith(f"/s/{shared['slug']}")
    assert (shared["creature"], shared["cover"], shared["state"]) == (known, known, "live")
    assert (shared["licence"], shared["credit"]) == ("CC-BY-4.0", ["Ada"])
    assert api.get(f"shares/{shared['slug']}").json() == shared
    assert api.get("shares").json()["items"] == [shared]


def test_the_same_again_is_the_same_share_while_it_is_live(api, shared, known):
    sent = {"creature": known, "title": "A swimmer"}
    again = api.post("shares", json=sent)
    assert (again.status_code, again.json()) == (200, shared)
    assert api.post("shares", json={**sent, "listed": True}).status_code == 201
    api.delete(f"shares/{shared['slug']}")
    anew = api.post("shares", json=sent)
    assert anew.status_code == 201
    assert anew.json()["slug"] != shared["slug"]


def test_publishing_has_preview_and_replay_made_beforehand(services, shared, known):
    (job,) = services.jobs.renderings.get_jobs()
    assert job.args == [known, PREVIEW]


@pytest.mark.parametrize(
    ("sent", "field"),
    [
        ({}, "creature"),
        ({"creature": "ab"}, "creature"),
        ({"creature": "ab" * 32, "generation": 3}, "generation"),
        ({"creature": "ab" * 32, "expires_at": "2030-01-01T00:00:00"}, "expires_at"),
        ({"creature": "ab" * 32, "expires_at": "2020-01-01T00:00:00Z"}, "expires_at"),
        ({"creature": "ab" * 32, "title": " "}, "title"),
        ({"creature": "ab" * 32, "credit": [""]}, "credit.0"),
        ({"creature": "ab" * 32, "sing": True}, "sing"),
    ],
)
def test_what_cannot_be_published_is_refused_by_its_field(api, sent, field):
    answer = api.post("shares", json=sent)
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["field"] == field


def test_what_is_not_there_cannot_be_published(api, run_id, sweep_id):
    assert api.post("shares", json={"creature": "ab" * 32}).status_code == 404
    assert api.post("shares", json={"run": str(sweep_id)}).status_code == 422
    early = api.post("shares", json={"run": str(run_id)})
    assert (early.status_code, early.json()["title"]) == (409, "Nothing to publish")


def test_a_share_shows_its_creature_and_no_other(api, shared, known, other):
    under = f"shares/{shared['slug']}"
    document = api.get(f"{under}/creatures/{known}").json()
    assert creature.parse(document)["sha256"] == known
    for path in ("", "/creature.h5", "/ancestors", "/network.svg", "/replay", "/motion"):
        assert api.get(f"{under}/creatures/{known}{path}").status_code in (200, 202), path
        assert api.get(f"{under}/creatures/{other}{path}").status_code == 404, path
    assert api.get(f"{under}/creatures/{known}/children").status_code == 404
    assert api.get(f"{under}/runs").status_code == 404
    assert api.get(f"{under}/../runs").status_code in (200, 404)  # The client resolves it.
    assert api.get(f"shares/{'A' * 32}").status_code == 404


def test_what_is_taken_back_is_gone_for_everybody(api, shared, known):
    under = f"shares/{shared['slug']}"
    for _ in range(2):
        revoked = api.delete(under)
        assert (revoked.status_code, revoked.json()["state"]) == (200, "revoked")
    for path in ("", f"/creatures/{known}", f"/creatures/{known}/replay", "/preview.png"):
        answer = api.get(under + path)
        assert answer.status_code == 410
        assert answer.json()["detail"] == "Whoever shared this has taken it back."
    assert api.delete(f"shares/{'A' * 32}").status_code == 404


def test_what_has_expired_is_gone(api, services, known):
    until = datetime.now(UTC) + timedelta(days=1)
    sent = {"creature": known, "listed": True, "expires_at": until.isoformat()}
    slug = api.post("shares", json=sent).json()["slug"]
    assert api.get(f"shares/{slug}").status_code == 200
    with services.sessions.write.begin() as session:
        session.get_one(Share, slug).expires_at = datetime(2026, 1, 2, 3, 4, tzinfo=UTC)
    answer = api.get(f"shares/{slug}/creatures/{known}")
    assert answer.status_code == 410
    assert answer.json()["detail"] == "This was shared until 02 January 2026, 03:04 UTC."
    assert api.get("commons").json()["items"] == []
    assert api.get("shares").json()["items"][0]["state"] == "expired"


def test_only_listed_shares_stand_in_the_commons_page_by_page(api, shared, known):
    listed = [
        api.post("shares", json={"creature": known, "title": title, "listed": True}).json()
        for title in "abc"
    ]
    first = api.get("commons", params={"limit": 2}).json()
    rest = api.get("commons", params={"limit": 2, "cursor": first["next"]}).json()
    found = [*first["items"], *rest["items"]]
    assert found == listed[::-1]
    assert rest["next"] is None
    assert api.get("commons", params={"cursor": "x"}).status_code == 422


def test_answers_keep_the_address_among_those_who_know_it(api, shared, known):
    for path in ("", f"/creatures/{known}", "/creatures/none"):
        headers = api.get(f"shares/{shared['slug']}{path}").headers
        assert headers["referrer-policy"] == "no-referrer"
        assert headers["x-robots-tag"] == "noindex"
        assert headers["cache-control"] == "no-cache"
    listed = api.post("shares", json={"creature": known, "listed": True}).json()
    assert "x-robots-tag" not in api.get(f"shares/{listed['slug']}").headers


def test_strangers_read_shares_and_nothing_else(serve, services, identity):
    with serve(token=SecretStr("secret")) as address, httpx.Client(headers=STRANGE) as client:
        api = f"{address}/api/v1"
        bearer = {"Authorization": "Bearer secret"}
        sent = creature.document(identity(3), None, None)
        known = client.post(f"{api}/creatures", json=sent, headers=bearer).json()["creature"]
        asked = {"creature": known}
        slug = client.post(f"{api}/shares", json=asked, headers=bearer).json()["slug"]
        for path in (f"shares/{slug}", f"shares/{slug}/creatures/{known}", "commons"):
            assert client.get(f"{api}/{path}").status_code == 200, path
        for path in ("shares", "shares/", f"creatures/{known}", "runs", f"shares/{slug}x"):
            assert client.get(f"{api}/{path}").status_code in (401, 404), path
        assert client.get(f"{api}/shares").status_code == 401
        assert client.post(f"{api}/shares", json=asked).status_code == 401
        assert client.delete(f"{api}/shares/{slug}").status_code == 401
        assert client.post(f"{api}/commons").status_code == 401
        assert client.get(f"{address}/s/{slug}").status_code in (200, 503)


def test_an_archive_is_shared_as_it_was(api, archive, attempt, report, run_id):
    under = f"shares/{archive['slug']}/runs/{run_id}"
    before = api.get(f"{under}/archive").json()
    assert (archive["generation"], before["generation"]) == (2, 2)
    later = report(3, {3: 9.0, 8: 9.0})
    attempt.record(later, 1.0)
    assert api.get(f"{under}/archive").json() == before
    assert api.get(f"{under}/archive", params={"generation": 3}).json() == before
    assert before["cell"] == [3, 7]
    history = api.get(f"{under}/archive/history").json()
    assert history["fitness"] == [1.0, 2.0, 1.5]
    assert api.get(f"{under}/generations").json()["generation"] == [1, 2]
    for sha in history["creature"]:
        assert api.get(f"shares/{archive['slug']}/creatures/{sha}").status_code == 200
    for elite in later.elites:
        found = api.get(f"shares/{archive['slug']}/creatures/{elite.creature}")
        assert found.status_code == 404


def test_a_shared_run_tells_nothing_that_its_owner_noted(api, archive, run_id):
    api.patch(f"runs/{run_id}", json={"name": "mine", "tags": ["a"], "note": "secret"})
    told = api.get(f"shares/{archive['slug']}/runs/{run_id}")
    assert "secret" not in told.text
    run = told.json()
    assert (run["name"], run["tags"], run["note"]) == ("Swimmers", [], None)
    assert (run["status"], run["generation"], run["best"]) == ("finished", 2, 2.0)
    other = "00000000-0000-4000-8000-000000000000"
    assert api.get(f"shares/{archive['slug']}/runs/{other}").status_code == 404


def test_the_file_of_an_archive_carries_licence_and_credit(api, archive, attempt, run_id):
    under = f"shares/{archive['slug']}/runs/{run_id}"
    _, attributes = file.load(api.get(f"{under}/archive.h5").content)
    assert (attributes["licence"], attributes["credit"]) == ("CC0-1.0", '["Ada"]')
    attempt.save(2, file.dump({"archive": {"cell": [1]}}, {"format": file.FORMAT}))
    tree, _ = file.load(api.get(f"{under}/archive.h5").content)
    assert list(tree["archive"]["cell"]) == [3, 7], "as it was when it was shared"
    api.delete(f"shares/{archive['slug']}")
    assert api.get(f"{under}/archive.h5").status_code == 410


def test_a_past_generation_is_shared_without_a_file(api, run_id, attempt):
    answer = api.post("shares", json={"run": str(run_id), "generation": 1})
    assert (answer.status_code, answer.json()["generation"]) == (201, 1)
    under = f"shares/{answer.json()['slug']}/runs/{run_id}"
    assert api.get(f"{under}/archive").json()["fitness"] == [1.0]
    assert "No file was kept" in api.get(f"{under}/archive.h5").json()["detail"]
    beyond = api.post("shares", json={"run": str(run_id), "generation": 3})
    assert beyond.json()["errors"][0]["field"] == "generation"


def test_licence_and_credit_travel_with_the_file(api, known, serve):
    sent = {"creature": known, "licence": "CC0-1.0", "credit": ["Ada", "Bob"]}
    slug = api.post("shares", json=sent).json()["slug"]
    document = api.get(f"shares/{slug}/creatures/{known}").json()
    assert (document["licence"], document["credit"]) == ("CC0-1.0", ["Ada", "Bob"])
    assert api.get(f"creatures/{known}").json()["credit"] == ["Ada"]


def test_strangers_wait_behind_everybody_and_only_so_many_of_them(
    api, services, archive, attempt, monkeypatch
):
    monkeypatch.setattr(renderings, "STRANGERS", 2)
    (cover,) = (job.args[0] for job in services.jobs.renderings.get_jobs())
    names = api.get(f"shares/{archive['slug']}/runs/{archive['run']}/archive/history").json()
    for sha in names["creature"]:
        answer = api.get(f"shares/{archive['slug']}/creatures/{sha}/motion")
        assert (answer.status_code, answer.json()) == (202, {"status": "rendering"})
    jobs = services.jobs.renderings.get_jobs()
    assert [job.args for job in jobs] == [[cover, PREVIEW], [names["creature"][0], REPLAY]]


def test_strangers_see_films_that_were_made_and_have_none_made(api, services, shared, known):
    film = f"shares/{shared['slug']}/creatures/{known}/film.gif"
    assert api.get(film).status_code == 404
    assert api.get(film.replace("film.gif", "audit")).status_code == 404
    renderings.save(services, known, "film.gif", b"GIF")
    assert api.get(film).content == b"GIF"
    assert len(services.jobs.renderings) == 1, "the preview alone"


def test_a_preview_is_the_covers_picture(api, services, shared, known):
    assert api.get(f"shares/{shared['slug']}/preview.png").status_code == 202
    renderings.save(services, known, PREVIEW, b"PNG")
    answer = api.get(f"shares/{shared['slug']}/preview.png")
    assert (answer.content, answer.headers["content-type"]) == (b"PNG", "image/png")


def test_a_deleted_run_leaves_the_commons_and_comes_back_to_them(
    api, services, attempt, run_id
):
    attempt.finish()
    sent = {"run": str(run_id), "title": "Swimmers", "listed": True}
    share = api.post("shares", json=sent).json()
    under, film = f"shares/{share['slug']}", f"creatures/{share['cover']}/film.gif"
    renderings.save(services, share["cover"], "film.gif", b"GIF")
    assert api.get("commons").json()["items"] == [share]
    assert api.delete(f"runs/{run_id}").status_code == 200
    for path in (
        "",
        "/preview.png",
        f"/runs/{run_id}",
        f"/runs/{run_id}/archive.h5",
        f"/{film}",
    ):
        assert api.get(under + path).status_code == 410, path
    assert api.get("commons").json()["items"] == []
    assert api.post(f"runs/{run_id}/restore").status_code == 200
    assert api.get("commons").json()["items"] == [share]
    assert api.get(f"{under}/{film}").status_code == 200


def test_strangers_are_not_told_the_renderers_words(api, services, shared, known):
    """They may name files, hosts and whatever else stands in an error."""
    (job,) = services.jobs.renderings.get_jobs()
    raised = "OSError: [Errno 28] No space left on device: '/home/ada/data/artifacts/x.part'"
    services.jobs.give_up(job, f'Traceback\n  File "a.py"\n    begin()\n{raised}\n')
    owner = api.get(f"creatures/{known}/preview.png")
    assert "/home/ada" in owner.json()["detail"]
    stranger = api.get(f"shares/{shared['slug']}/preview.png")
    assert stranger.status_code == 500
    assert stranger.json()["detail"] == (
        "The picture could not be made. It can be tried again in a minute."
    )
    assert stranger.headers["retry-after"] == "60"
