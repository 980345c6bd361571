"""Publishing creatures and archives, and reading them through a share."""

import re
from datetime import UTC, datetime, timedelta

import httpx
import pytest
from answers import detail, fields
from pydantic import SecretStr
from reports import audit

from microcosmos.archive import creature, creature_h5
from microcosmos_server.auth.authorize import SHARE_HEADER
from microcosmos_server.renderings import storage as renderings
from microcosmos_server.shares.schemas import Terms
from microcosmos_server.tables import AUDIT, LOOP, PREVIEW, Share

STRANGE = {"Host": "microcosmos.example"}


@pytest.fixture
def other(upload, identity) -> str:
    return upload(identity(4))


@pytest.fixture
def shared(api, known) -> dict:
    answer = api.post("shares", json={"creature": known, "title": "A swimmer"})
    assert answer.status_code == 201
    return answer.json()


def test_a_share_has_a_slug_that_cannot_be_guessed(api, shared, known):
    assert re.fullmatch(r"[\w-]{32}", shared["slug"], re.ASCII)  # 192 random bits.
    assert shared["url"].endswith(f"/s/{shared['slug']}")
    assert (shared["creature"], shared["cover"], shared["state"]) == (known, known, "live")
    assert (shared["licence"], shared["credit"]) == ("CC-BY-4.0", ["Ada"])
    assert api.get(f"shares/{shared['slug']}").json() == shared
    assert api.get("shares").json()["items"] == [shared]


def test_each_field_of_a_publisher_is_stored_compared_and_read(api, known, shared):
    for name, declared in Terms.model_fields.items():
        value = {bool: True, str: "x"}.get(declared.annotation, "2040-01-01T00:00:00Z")
        if declared.annotation == str | None:
            value = "a text"
        sent = {"creature": known, "title": "A swimmer", name: value}
        other = api.post("shares", json=sent)
        assert other.status_code == 201, f"another {name} makes another share"
        assert other.json()[name] == value
        assert api.post("shares", json=sent).json() == other.json()


def test_a_share_states_the_verdict_of_its_creatures_audit(
    api, through, services, shared, known
):
    slug = shared["slug"]
    assert shared["trusted"] is None
    for trusted in (True, False):
        renderings.save(services, known, AUDIT, audit(trusted))
        assert api.get(f"shares/{slug}").json()["trusted"] is trusted
        assert api.get("shares").json()["items"][0]["trusted"] is trusted
        assert through(slug, f"creatures/{known}/verdict").json() == {"trusted": trusted}


def test_publishing_twice_gives_the_same_live_share(api, services, shared, known):
    jobs = services.jobs.renderings.get_jobs()
    assert [job.args for job in jobs] == [[known, PREVIEW], [known, LOOP]]
    sent = {"creature": known, "title": "A swimmer"}
    again = api.post("shares", json=sent)
    assert (again.status_code, again.json()) == (200, shared)
    assert api.post("shares", json={**sent, "listed": True}).status_code == 201
    api.delete(f"shares/{shared['slug']}")
    anew = api.post("shares", json=sent)
    assert anew.status_code == 201
    assert anew.json()["slug"] != shared["slug"]


@pytest.mark.parametrize(
    ("sent", "field"),
    [
        ({}, "creature"),
        ({"creature": "ab"}, "creature"),
        ({"creature": "ab" * 32, "generation": 3}, "generation"),
        ({"creature": "ab" * 32, "expires_at": "2030-01-01T00:00:00"}, "expires_at"),
        ({"creature": "ab" * 32, "expires_at": "2020-01-01T00:00:00Z"}, "expires_at"),
        ({"creature": "ab" * 32, "expires_at": "9999-12-31T23:59:59-05:00"}, "expires_at"),
        ({"creature": "ab" * 32, "title": " "}, "title"),
        ({"creature": "ab" * 32, "credit": [""]}, "credit.0"),
        ({"creature": "ab" * 32, "sing": True}, "sing"),
    ],
)
def test_an_invalid_share_is_refused_with_its_field(api, sent, field):
    assert fields(api.post("shares", json=sent))[0] == field


def test_missing_things_cannot_be_published(api, run_id, sweep_id):
    assert api.post("shares", json={"creature": "ab" * 32}).status_code == 404
    assert api.post("shares", json={"run": str(sweep_id)}).status_code == 422
    early = api.post("shares", json={"run": str(run_id)})
    assert (early.status_code, early.json()["title"]) == (409, "Nothing to publish")


def test_a_share_shows_its_creature_and_no_other(api, through, shared, known, other):
    slug = shared["slug"]
    document = through(slug, f"creatures/{known}").json()
    assert creature.parse(document)["sha256"] == known
    files = ("/creature.h5", "/network.svg", "/network.json", "/poses.csv")
    for path in ("", "/verdict", "/ancestors", *files, "/replay", "/poses", "/evaluation"):
        assert through(slug, f"creatures/{known}{path}").status_code in (200, 202), path
        assert through(slug, f"creatures/{other}{path}").status_code == 404, path
    for path in (f"creatures/{known}/children", f"creatures/{known}/audit", "runs", "workers"):
        assert through(slug, path).status_code == 403, path
    holder = {SHARE_HEADER: slug}
    assert api.post(f"creatures/{known}/measurement", headers=holder).status_code == 403
    assert api.get(f"shares/{'A' * 32}").status_code == 404
    assert through("A" * 32, f"creatures/{known}").status_code == 404


def test_a_revoked_share_is_gone(api, through, shared, known):
    under = f"shares/{shared['slug']}"
    for _ in range(2):
        revoked = api.delete(under)
        assert (revoked.status_code, revoked.json()["state"]) == (200, "revoked")
    slug = shared["slug"]
    for answer in (
        api.get(under),
        api.get(f"{under}/preview.png"),
        through(slug, f"creatures/{known}"),
        through(slug, f"creatures/{known}/replay"),
    ):
        assert detail(answer, 410) == "Its owner has revoked this share."
    assert api.delete(f"shares/{'A' * 32}").status_code == 404


def test_an_expired_share_is_gone(api, through, update_rows, known):
    until = datetime.now(UTC) + timedelta(days=1)
    sent = {"creature": known, "listed": True, "expires_at": until.isoformat()}
    slug = api.post("shares", json=sent).json()["slug"]
    assert api.get(f"shares/{slug}").status_code == 200
    update_rows(Share, expires_at=datetime(2026, 1, 2, 3, 4, tzinfo=UTC))
    answer = through(slug, f"creatures/{known}")
    assert detail(answer, 410) == "This share expired on 02 January 2026, 03:04 UTC."
    assert api.get("commons").json()["items"] == []
    assert api.get("shares").json()["items"][0]["state"] == "expired"


def test_answers_keep_a_share_out_of_search_engines(api, through, shared, known):
    for headers in (
        api.get(f"shares/{shared['slug']}").headers,
        through(shared["slug"], f"creatures/{known}").headers,
        through(shared["slug"], "creatures/none").headers,
    ):
        assert headers["referrer-policy"] == "no-referrer"
        assert headers["x-robots-tag"] == "noindex"
        assert headers["cache-control"] == "private, no-cache"
    listed = api.post("shares", json={"creature": known, "listed": True}).json()
    assert "x-robots-tag" not in api.get(f"shares/{listed['slug']}").headers


def test_anonymous_requests_read_shares_and_nothing_else(served, shared, known):
    holder = {SHARE_HEADER: shared["slug"]}
    address = served(token=SecretStr("secret"))
    with httpx.Client(base_url=f"{address}/api/v1/", headers=STRANGE) as client:
        for path in (f"shares/{shared['slug']}", "commons"):
            assert client.get(path).status_code == 200, path
        assert client.get(f"creatures/{known}", headers=holder).status_code == 200
        assert client.get("shares", headers=holder).status_code == 403
        assert client.post("shares", json={}, headers=holder).status_code == 403
        for path in ("shares", "shares/", f"creatures/{known}", f"shares/{shared['slug']}x"):
            assert client.get(path).status_code in (401, 404), path
        assert client.post("commons").status_code == 401


def test_licence_and_credit_travel_with_the_file(api, through, known):
    sent = {"creature": known, "licence": "CC0-1.0", "credit": ["Ada", "Bob"]}
    slug = api.post("shares", json=sent).json()["slug"]
    document = through(slug, f"creatures/{known}").json()
    assert (document["licence"], document["credit"]) == ("CC0-1.0", ["Ada", "Bob"])
    assert api.get(f"creatures/{known}").json()["credit"] == ["Ada"]


def test_what_is_published_with_much_credit_and_a_long_licence_can_be_read(api, through, file):
    names = [f"Ada {i}" for i in range(60)]
    sent = {"creature": file["sha256"], "credit": names[40:], "licence": "a" * 10_000}
    api.post("creatures", json=file | {"credit": names[:40]})
    slug = api.post("shares", json=sent).json()["slug"]
    path = f"creatures/{sent['creature']}"
    for name, read in (("", creature.parse), ("/creature.h5", creature_h5.read)):
        found = read(through(slug, f"{path}{name}").content)
        assert (found["licence"], found["credit"]) == (sent["licence"], names)


def test_holders_of_a_share_read_films_but_order_none(through, services, shared, known):
    slug, film = shared["slug"], f"creatures/{known}/film.gif"
    assert through(slug, film).status_code == 404
    assert through(slug, film.replace("film.gif", "audit")).status_code == 403
    assert through(slug, film.replace("film.gif", "measurement")).status_code == 204
    renderings.save(services, known, "film.gif", b"GIF")
    assert through(slug, film).content == b"GIF"
    assert len(services.jobs.renderings) == 2, "the preview alone"


@pytest.mark.parametrize(("kind", "media"), [(PREVIEW, "image/png"), (LOOP, "video/mp4")])
def test_a_preview_is_the_covers(api, services, shared, known, kind, media):
    assert api.get(f"shares/{shared['slug']}/{kind}").status_code == 202
    renderings.save(services, known, kind, b"bytes")
    answer = api.get(f"shares/{shared['slug']}/{kind}")
    assert (answer.content, answer.headers["content-type"]) == (b"bytes", media)


def test_holders_of_a_share_do_not_read_renderer_errors(api, services, shared, known):
    """They may name files, hosts and whatever else stands in an error."""
    job, _ = services.jobs.renderings.get_jobs()
    raised = "OSError: [Errno 28] No space left on device: '/home/ada/data/artifacts/x.part'"
    services.jobs.give_up(job, raised)
    owner = api.get(f"creatures/{known}/preview.png")
    assert "/home/ada" in owner.json()["detail"]
    stranger = api.get(f"shares/{shared['slug']}/preview.png")
    assert detail(stranger, 500) == ("The picture failed. Try again in a minute.")
    assert stranger.headers["retry-after"] == "60"
