"""Middleware: tokens, cookies, host names, other sites and the rate limit."""

import logging
from contextlib import contextmanager
from urllib.parse import urlsplit

import httpx
import pytest
from pydantic import SecretStr
from sqlalchemy.exc import OperationalError

from microcosmos_server.auth import authenticate, tokens
from microcosmos_server.auth.authenticate import (
    ADDRESSES,
    BURST,
    INTERVAL,
    RateLimit,
    network_of,
)
from microcosmos_server.auth.middleware import COOKIE
from microcosmos_server.settings import MIN_TOKEN_LENGTH, Settings

TYPED = {"Sec-Fetch-Site": "none"}
"""What a browser says where somebody typed or opened an address."""


@pytest.fixture
def guarded(served) -> str:
    """The address of a server that needs a token."""
    return served(token=SecretStr("secret"))


def test_only_loopback_goes_without_a_token_unless_configured():
    for host in ("0.0.0.0", "192.0.2.1", "::"):
        assert Settings(host=host, token=None).needs_token, host
    assert not Settings(host="127.0.0.1", token=None).needs_token
    assert Settings(host="127.0.0.1", token=None, auth="required").needs_token
    assert Settings(host="127.0.0.1", token=SecretStr("s" * MIN_TOKEN_LENGTH)).needs_token
    assert not Settings(host="127.0.0.1", token=SecretStr("")).needs_token


def test_only_host_names_of_this_machine_are_accepted(api):
    for name in ("evil.example", "127.0.0.1.evil.example", "", "["):
        assert api.get("runs", headers={"Host": name}).status_code in (400, 403), name
    for name in ("localhost:8000", "127.0.0.1", "[::1]:8000"):
        assert api.get("runs", headers={"Host": name}).status_code == 200, name
    assert api.get("runs", headers={"Origin": "http://["}).status_code == 403


def test_pages_of_other_sites_are_refused(api, address, spec):
    origins = {"http://evil.example": 403, "http://127.0.0.1:1": 403, address: 202}
    for origin, status in origins.items():
        answer = api.post("runs", json=spec, headers={"Origin": origin})
        assert answer.status_code == status, origin


def test_a_configured_token_is_needed_from_any_host(guarded):
    with httpx.Client() as client:
        url = f"{guarded}/api/v1/runs"
        assert client.get(url).status_code == 401
        assert client.get(url, headers={"Authorization": "Bearer wrong"}).status_code == 401
        sent = {"Authorization": "Bearer secret", "Host": "microcosmos.example"}
        assert client.get(url, headers=sent).status_code == 200
        cookie = {"Cookie": f"microcosmos_token_{urlsplit(url).port}=secret"}
        assert client.get(url, headers=cookie).status_code == 200
        assert client.get(f"{guarded}/healthz").status_code == 200


def test_no_shared_cache_keeps_what_needs_a_token(guarded, known):
    paths = "", "/plan.json", "/network.json", "/poses", "/creature.h5", "/ancestors"
    for token, statuses in {"wrong": {401}, "secret": {200, 202, 404}}.items():
        for path in paths:
            url = f"{guarded}/api/v1/creatures/{known}{path}"
            answer = httpx.get(url, headers={"Authorization": f"Bearer {token}"})
            assert answer.status_code in statuses, path
            assert answer.headers["cache-control"] == "private, no-cache", path


@pytest.mark.parametrize(
    ("sent", "signed_in"),
    [
        ({}, False),
        (TYPED, True),
        ({"Sec-Fetch-Site": "same-origin"}, True),
        ({"Sec-Fetch-Site": "cross-site"}, False),
        ({"Sec-Fetch-Site": "same-site"}, False),
        ({"Referer": "http://evil.example/runs"}, False),
        ({"Referer": "http://127.0.0.1:PORT/runs"}, True),
        ({"Referer": "http://127.0.0.1:1/runs"}, False),
        ({"Referer": "http://["}, False),
    ],
)
def test_a_link_of_another_site_signs_nobody_in(guarded, sent, signed_in):
    with httpx.Client() as browser:
        port = str(urlsplit(guarded).port)
        sent = {name: value.replace("PORT", port) for name, value in sent.items()}
        answer = browser.get(f"{guarded}/runs?token=secret&view=map", headers=sent)
        assert answer.headers["location"] == f"{guarded}/runs?view=map"
        assert ("set-cookie" in answer.headers) == signed_in
        status = browser.get(f"{guarded}/api/v1/runs").status_code
        assert status == (200 if signed_in else 401)


def test_a_cookie_does_not_work_from_other_sites(guarded, spec):
    """A browser may send it by itself; a header it does not."""
    url = f"{guarded}/api/v1/runs"
    cookie = {"Cookie": f"microcosmos_token_{urlsplit(url).port}=secret"}
    other = {"Origin": "http://evil.example"}
    assert httpx.post(url, json=spec, headers=cookie | other).status_code == 403
    own = {"Origin": guarded}
    assert httpx.post(url, json=spec, headers=cookie | own).status_code == 202
    bearer = {"Authorization": "Bearer secret"}
    assert httpx.post(url, json=spec, headers=bearer | other).status_code == 202


@contextmanager
def listening(caplog):
    """Collect the addresses in the server's log of requests."""
    log = logging.getLogger("uvicorn.access")
    log.addHandler(caplog.handler)
    caplog.set_level("INFO", "uvicorn.access")
    # Its handler gets other records too, such as those of servers that other tests started.
    lines = (one for one in caplog.records if one.name == log.name)
    yield lambda: [one.getMessage().partition('"')[2].split()[1] for one in lines]
    log.removeHandler(caplog.handler)


def test_the_log_of_requests_does_not_name_shares(address, caplog):
    slug, sha = "q7Xv-_0123456789abcdefghijklmnop", "ab" * 32
    with listening(caplog) as logged:
        for path in (f"/s/{slug}", f"/s/{slug}/creatures/{sha}"):
            httpx.get(address + path)
        for path in (f"shares/{slug}", f"shares/{slug}/preview.png", f"commons?cursor={slug}"):
            httpx.get(f"{address}/api/v1/{path}")
        httpx.delete(f"{address}/api/v1/shares/{slug}")
        lines = logged()
    assert not any(slug[4:] in line for line in lines)
    assert lines[:2] == ["/s/q7Xv…", f"/s/q7Xv…/creatures/{sha}"]
    assert len(lines) == 6


def test_a_token_is_not_wrong_without_the_database(guarded, monkeypatch):
    def away(*_):
        raise OperationalError("SELECT", {}, ConnectionError("gone"))

    monkeypatch.setattr(authenticate.tokens, "principal_of", away)
    sent = {"Authorization": "Bearer mc_other"}
    answer = httpx.get(f"{guarded}/api/v1/runs", headers=sent)
    assert (answer.status_code, answer.headers["retry-after"]) == (503, "2")
    assert answer.json()["detail"] == "The database does not answer; try again."


def test_the_cookie_is_named_after_the_port_that_the_browser_knows(guarded):
    """Two boxes may be brought to two ports of a laptop by `ssh -L`, both from port 8000."""
    with httpx.Client() as client:
        for host, name in (("localhost:9000", "microcosmos_token_9000"), ("box", COOKIE)):
            sent = {"Host": host}
            answer = client.get(f"{guarded}/?token=secret", headers=sent | TYPED)
            assert answer.headers["set-cookie"].startswith(f"{name}=")


def test_other_sites_cannot_frame_or_read_our_pages(api, address):
    """Without tokens, a frame would have all rights."""
    for path in ("/", "/runs", "/settings", "/api/v1/runs", "/api/v1/nothing", "/metrics"):
        headers = httpx.get(address + path).headers
        assert "frame-ancestors 'none'" in headers["content-security-policy"], path
        assert "default-src 'self'" in headers["content-security-policy"], path
        assert headers["cross-origin-resource-policy"] == "same-origin", path
        assert headers["x-content-type-options"] == "nosniff", path
    refused = api.get("runs", headers={"Host": "evil.example"})
    assert refused.headers["cross-origin-resource-policy"] == "same-origin"
    shared = api.get("shares/whatever/preview.png")
    assert shared.headers["cross-origin-resource-policy"] == "cross-origin"


class Clock:
    now = 0.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def limit(clock) -> RateLimit:
    return RateLimit(clock)


def test_a_burst_of_wrong_tokens_from_an_address_is_allowed_and_recovers(limit, clock):
    assert [limit.add("192.0.2.1") for _ in range(BURST)] == [0] * BURST
    assert limit.add("192.0.2.1") == INTERVAL
    assert limit.add("192.0.2.2") == 0, "each address counts alone"
    clock.now += 2.0
    assert limit.add("192.0.2.1") == INTERVAL - 2.0
    clock.now += INTERVAL - 2.0
    assert limit.add("192.0.2.1") == 0
    clock.now += BURST * INTERVAL
    assert [limit.add("192.0.2.1") for _ in range(BURST)] == [0] * BURST


def test_several_processes_allow_no_more_than_one(clock):
    one, other = limits = [RateLimit(clock, processes=2) for _ in range(2)]
    allowed = [limit.add("192.0.2.1") == 0 for limit in limits for _ in range(BURST)]
    assert allowed.count(True) == BURST
    clock.now += 2 * INTERVAL
    assert [one.add("192.0.2.1") == 0 for _ in range(2)] == [True, False]
    assert other.add("192.0.2.1") == 0


def test_the_rate_limit_remembers_limited_addresses(limit):
    for number in range(2 * ADDRESSES):
        limit.add(f"198.18.{number // 256}.{number % 256}")
    assert len(limit._charged_until) == ADDRESSES


@pytest.mark.parametrize(
    ("address", "counted"),
    [
        ("192.0.2.1", "192.0.2.1"),
        ("::ffff:192.0.2.1", "192.0.2.1"),
        ("2001:db8:1:2:3:4:5:6", "2001:db8:1:2::/64"),
        ("fe80::1%eth0", "fe80::/64"),
        ("", "unknown"),
        ("x" * 60_000, "unknown"),
    ],
)
def test_an_ipv6_network_counts_as_one_address(address, counted):
    assert network_of(address) == counted


def test_wrong_tokens_are_limited_and_valid_ones_pass(serve, services):
    tokens.create(services, "root", "admin")
    good = tokens.create(services, "alice", "read").secret
    ended = tokens.create(services, "bob", "read")
    tokens.revoke(services, ended.token.id)
    with serve(auth="required") as address, httpx.Client(base_url=address) as http:

        def ask(secret):
            sent = {"Authorization": f"Bearer {secret}"}
            return http.get("/api/v1/runs", headers=sent)

        for _ in range(2 * BURST):  # Neither is a guess.
            assert http.get("/api/v1/runs").status_code == 401
            assert ask(ended.secret).status_code == 401
        for number in range(BURST):
            assert ask(f"mc_{number}").status_code == 401
        # A slow machine may have earned a guess meanwhile.
        assert any(ask(f"mc_{BURST + n}").status_code == 429 for n in range(BURST))
        ways = (
            lambda: ask("mc_other"),
            lambda: http.post("/api/v1/session", json={"token": "mc_other"}),
            lambda: http.get("/api/v1/nothing", headers={"Authorization": "Bearer mc_other"}),
        )
        for refused in (way() for way in ways):
            assert refused.status_code == 429
            assert 1 <= int(refused.headers["retry-after"]) <= INTERVAL
            assert refused.json()["title"] == "Too many wrong tokens"
        assert ask(good).status_code == 200
        assert http.post("/api/v1/session", json={"token": good}).status_code == 200
        assert http.get("/?token=mc_other", headers=TYPED).status_code in (
            200,
            503,
        )  # The page asks for one.
