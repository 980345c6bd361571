"""Tokens: creation, hashes, expiry, revocation, and ownership of runs."""

import stat
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import replace
from datetime import UTC, datetime, timedelta

import httpx
import pytest
from answers import detail, fields
from pydantic import SecretStr
from sqlalchemy import select

from microcosmos_server.auth import __main__ as commands
from microcosmos_server.auth import bootstrap, tokens
from microcosmos_server.core.errors import DomainError
from microcosmos_server.tables import Token

KEY = {"Idempotency-Key": "first"}


@pytest.fixture
def required(served, admin):
    return f"{served(auth='required')}/api/v1"


@pytest.fixture
def client():
    made = []

    def make(base: str, secret: str | None = None) -> httpx.Client:
        headers = {"Authorization": f"Bearer {secret}"} if secret else {}
        made.append(httpx.Client(base_url=base, headers=headers, timeout=20))
        return made[-1]

    yield make
    for one in made:
        one.close()


def test_a_token_is_shown_once_and_kept_as_a_hash(rows, required, client, admin, services):
    asked = {"name": " alice ", "scope": "write"}
    answer = client(required, admin).post("/tokens", json=asked)
    assert answer.status_code == 201
    secret = answer.json()["secret"]
    assert len(secret) == len("mc_") + 43  # 32 bytes in base64.
    listed = client(required, admin).get("/tokens")
    assert [token["name"] for token in listed.json()] == ["alice", "root"]
    assert listed.json()[0]["prefix"] == secret[:9]
    assert secret not in listed.text
    kept = [repr(vars(row)) for row in rows()]
    assert not any(secret[9:] in text for text in kept)
    who = client(required, secret).get("/tokens/current").json()
    assert (who["name"], who["scope"], who["needed"]) == ("alice", "write", True)


def test_a_revoked_token_is_refused_at_once_by_name(required, client, admin, services):
    made = tokens.create(services, "bob", "read")
    bob = client(required, made.secret)
    assert bob.get("/runs").status_code == 200
    assert client(required, admin).delete(f"/tokens/{made.token.id}").json()["revoked_at"]
    answer = bob.get("/runs")
    assert (answer.status_code, answer.headers["www-authenticate"]) == (401, "Bearer")
    assert answer.json()["detail"] == "The token `bob` was revoked."


def test_an_expired_token_is_refused_and_its_name_is_free(required, client, services):
    soon = datetime.now(UTC) + timedelta(hours=1)
    made = tokens.create(services, "carol", "read", soon)
    with pytest.raises(DomainError, match="name 'carol' is taken"):
        tokens.create(services, "carol", "read")
    expire(services, made.token.id)
    answer = client(required, made.secret).get("/runs")
    assert "The token `carol` expired at 2020-01-01 00:00 UTC" in detail(answer, 401)
    assert tokens.create(services, "carol", "read").token.id != made.token.id


def expire(services, token):
    with services.sessions.write.begin() as session:
        session.get_one(Token, token).expires_at = datetime(2020, 1, 1, tzinfo=UTC)


def test_an_invalid_token_is_refused_with_its_field(api):
    for change in (
        {"name": ""},
        {"name": "a" * 65},
        {"scope": "everything"},
        {"expires_at": "2020-01-01T00:00:00Z"},
        {"expires_at": "2090-01-01T00:00:00"},
        {"expires_at": "9999-12-31T23:59:59-05:00"},
    ):
        answer = api.post("tokens", json={"name": "dave", "scope": "read"} | change)
        assert fields(answer)[0] in change


def test_the_last_admin_token_is_not_revoked(required, client, admin):
    root = client(required, admin)
    (mine,) = root.get("/tokens").json()
    answer = root.delete(f"/tokens/{mine['id']}")
    assert "No other token of an admin lasts as long as `root`." in detail(answer, 409)
    soon = (datetime.now(UTC) + timedelta(hours=1)).isoformat()
    for name, end in (("an hour", soon), ("an hour too", soon)):
        given = {"name": name, "scope": "admin", "expires_at": end}
        brief = root.post("/tokens", json=given).json()
    assert root.delete(f"/tokens/{mine['id']}").status_code == 409
    assert root.delete(f"/tokens/{brief['id']}").status_code == 200
    other = root.post("/tokens", json={"name": "other", "scope": "admin"}).json()
    assert root.delete(f"/tokens/{mine['id']}").status_code == 200
    assert client(required, other["secret"]).get("/tokens").status_code == 200


@pytest.mark.postgresql
def test_of_two_admins_that_revoke_each_other_at_once_one_stays(required, services, admin):
    strict = replace(
        services, settings=services.settings.model_copy(update={"auth": "required"})
    )

    def revoked(token):
        with suppress(DomainError):
            return tokens.revoke(strict, token)

    with ThreadPoolExecutor(4) as pool:
        for turn in range(5):
            for number in range(3):
                tokens.create(services, f"{turn} {number}", "admin")
            with services.sessions.read() as session:
                live = select(Token.id).where(Token.scope == "admin", Token.live())
                ids = session.scalars(live).all()
            done = list(pool.map(revoked, ids))
            assert sum(one is None for one in done) == 1


def test_a_run_belongs_to_the_token_that_submitted_it(owners, client, required, admin, spec):
    alice, bob = owners
    run = alice.post("/runs", json=spec).json()["id"]
    refused = detail(bob.post(f"/runs/{run}/pause"), 403)
    assert f"run {run} belongs to `alice`" in refused
    assert "you are `bob`" in refused
    assert bob.get(f"/runs/{run}").json()["owner"] == "alice"
    sweep = alice.post("/sweeps", json={"spec": spec}).json()["id"]
    assert bob.get(f"/sweeps/{sweep}").json()["owner"] == "alice"
    refused = detail(bob.post("/shares", json={"run": run}), 403)
    assert "only its owner or an admin may publish it; you are `bob`" in refused
    assert client(required, admin).post(f"/runs/{run}/pause").status_code == 202


@pytest.fixture
def owners(required, client, services) -> list[httpx.Client]:
    made = (tokens.create(services, name, "write") for name in ("alice", "bob"))
    return [client(required, one.secret) for one in made]


@pytest.mark.parametrize("noun", ["runs", "sweeps"])
def test_idempotency_keys_belong_to_a_token(owners, spec, noun):
    alice, bob = owners
    sent = {"json": spec if noun == "runs" else {"spec": spec}, "headers": KEY}
    mine = alice.post(f"/{noun}", **sent).json()["id"]
    his = bob.post(f"/{noun}", **sent)
    assert (his.status_code, his.json()["id"] == mine) == (202, False)
    again = alice.post(f"/{noun}", **sent)
    assert (again.status_code, again.json()["id"]) == (200, mine)


def test_only_admins_change_runs_without_an_owner(owners, client, required, admin, run_id):
    _, bob = owners
    refused = bob.patch(f"/runs/{run_id}", json={"name": "mine"})
    assert "was made without a token" in detail(refused, 403)
    named = client(required, admin).patch(f"/runs/{run_id}", json={"name": "x"})
    assert (named.status_code, named.json()["owner"]) == (200, None)


def test_a_stream_ends_with_its_token(required, client, admin, services):
    made = tokens.create(services, "watcher", "read")
    with client(required, made.secret).stream("GET", "/events") as answer:
        lines = answer.iter_lines()
        while next(lines):  # The event `start`.
            pass
        client(required, admin).delete(f"/tokens/{made.token.id}")
        assert [line for line in lines if line.startswith("data")] == []
    assert client(required, made.secret).get("/events").status_code == 401


def test_signing_in_keeps_a_cookie_and_signing_out_forgets_it(required, client, admin):
    page = client(required)
    assert page.post("/session", json={"token": "mc_wrong"}).status_code == 401
    answer = page.post("/session", json={"token": admin})
    assert (answer.status_code, answer.json()["name"]) == (200, "root")
    for word in ("HttpOnly", "SameSite=strict", "Max-Age="):
        assert word in answer.headers["set-cookie"]
    assert page.get("/tokens").status_code == 200
    assert page.delete("/session").status_code == 204
    assert page.get("/tokens").status_code == 401


def test_bodies_of_anonymous_requests_are_limited_and_checked(required, client, admin):
    page = client(required)
    for body, status in {
        b'{"token": "' + bytes(1 << 22): 413,
        b'{"token": "\\ud800"}': 422,
        b'{"token": "\\u0000"}': 422,
        b"[" * 1000: 422,
        b'{"token": {}}': 422,
    }.items():
        answer = page.post("/session", content=body)
        assert answer.status_code == status
        assert answer.headers["content-type"] == "application/problem+json"


def test_loopback_still_checks_a_token_that_is_sent(api, services, spec):
    reader = tokens.create(services, "reader", "read")
    sent = {"Authorization": f"Bearer {reader.secret}"}
    assert api.get("tokens/current").json()["name"] == "local"
    assert api.get("tokens/current", headers=sent).json()["name"] == "reader"
    assert api.post("runs", json=spec, headers=sent).status_code == 403
    assert api.get("runs", headers={"Authorization": "Bearer wrong"}).status_code == 401


@pytest.fixture
def settings(services, tmp_path):
    """The server's settings, with an empty data folder."""
    return services.settings.model_copy(update={"data": tmp_path})


def test_the_first_start_beyond_loopback_creates_an_admin_token(serve, services, settings):
    open_to_all = settings.model_copy(update={"host": "0.0.0.0"})
    exposed = with_settings(services, open_to_all)
    secret = bootstrap.create_first_token(exposed)
    assert secret is not None
    file = settings.data / bootstrap.FILE
    assert file.read_text() == f"{secret}\n"
    assert stat.S_IMODE(file.stat().st_mode) == 0o600
    assert secret in bootstrap.announcement(open_to_all, secret)
    assert str(file) in bootstrap.announcement(open_to_all, secret)
    assert bootstrap.create_first_token(exposed) is None  # The second start makes none.
    assert tokens.principal_of(services, secret).scope == "admin"


def test_a_first_token_that_cannot_be_kept_is_made_at_the_next_start(
    rows, services, settings, tmp_path
):
    changes = {"host": "0.0.0.0", "data": tmp_path}
    exposed = with_settings(services, settings.model_copy(update=changes))
    (tmp_path / bootstrap.FILE).mkdir()
    with pytest.raises(ValueError, match=r"first admin token must be writable; got "):
        bootstrap.create_first_token(exposed)
    assert rows() == []
    (tmp_path / bootstrap.FILE).rmdir()
    secret = bootstrap.create_first_token(exposed)
    assert (tmp_path / bootstrap.FILE).read_text() == f"{secret}\n"


def with_settings(services, settings):
    return replace(services, settings=settings)


def test_no_token_is_created_when_unneeded_or_given(rows, services, settings):
    assert bootstrap.create_first_token(services) is None
    given = settings.model_copy(update={"host": "0.0.0.0", "token": SecretStr("secret")})
    assert bootstrap.create_first_token(with_settings(services, given)) is None
    assert rows() == []


def test_a_server_without_admins_does_not_listen(rows, services, settings, admin):
    exposed = with_settings(services, settings.model_copy(update={"host": "0.0.0.0"}))
    bootstrap.refuse_without_admin(exposed)
    tokens.revoke(services, rows()[0].id, last=True)
    for begin in (bootstrap.create_first_token, bootstrap.refuse_without_admin):
        with pytest.raises(ValueError, match=r"python -m microcosmos_server\.auth create"):
            begin(exposed)


def test_tokens_are_made_and_revoked_on_the_command_line(
    services, settings, monkeypatch, capsys
):
    monkeypatch.setattr(commands, "from_environment", lambda: settings)
    commands.main(["create", "frank", "--scope", "admin", "--days", "1"])
    secret = capsys.readouterr().out.strip()
    assert tokens.principal_of(services, secret).name == "frank"
    commands.main(["create", "eve\x1b[2J"])
    capsys.readouterr()
    commands.main(["list"])
    listed = capsys.readouterr().out
    assert "frank\tadmin\t" + secret[:9] in listed
    assert "eve\\u001b[2J\tread" in listed, "a name does nothing to the terminal"
    commands.main(["revoke", "frank"])
    with pytest.raises(DomainError, match="`frank` was revoked"):
        tokens.principal_of(services, secret)
    with pytest.raises(SystemExit, match="No live token is named 'frank'"):
        commands.main(["revoke", "frank"])


DAYS = "`days` must be above 0 and end before the year 10000"
NAME = "`name` must have 1 to 64 characters"


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        # Zero days are not for ever.
        *((("frank", f"--days={days}"), DAYS) for days in ("0", "-1", "1e9", "nan")),
        *(((name,), NAME) for name in ("", " ", "a" * 65, "a\udcff")),
    ],
)
def test_a_token_on_the_command_line_has_a_name_and_ends_or_has_no_days(
    words, reason, services, settings, monkeypatch, capsys
):
    monkeypatch.setattr(commands, "from_environment", lambda: settings)
    with pytest.raises(SystemExit):
        commands.main(["create", *words])
    assert reason in capsys.readouterr().err
    with services.sessions.read() as session:
        assert not tokens.all_tokens(session)


@pytest.mark.parametrize(
    ("url", "reason"),
    [
        ("", "there is no .*/mistyped/microcosmos.sqlite"),
        ("foo://u:hunter2@x", "`database_url` must be postgresql"),
        ("sqlite:////proc/none/x", "there is no /proc/none/x"),
        ("sqlite:///{}/text", "The database does not answer: file is not a database"),
    ],
)
def test_the_command_line_names_a_wrong_database_and_makes_none(
    url, reason, tmp_path, monkeypatch
):
    (tmp_path / "text").write_text("no database")
    monkeypatch.setenv("MICROCOSMOS_DATA", str(tmp_path / "mistyped"))
    monkeypatch.setenv("MICROCOSMOS_DATABASE_URL", url.format(tmp_path))
    with pytest.raises(SystemExit, match=reason) as caught:
        commands.main(["list"])
    assert "hunter2" not in str(caught.value)
    assert not (tmp_path / "mistyped").exists()
