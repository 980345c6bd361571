"""Whoever limit tokens is told to wait, and nobody else."""

import httpx
import pytest

from server.auth import tokens
from server.auth.ratelimit import ADDRESSES, BURST, INTERVAL, RateLimit, network_of


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


def test_some_wrong_tokens_are_forgiven_and_each_in_time(limit, clock):
    assert [limit.add("192.0.2.1") for _ in range(BURST)] == [0] * BURST
    assert limit.add("192.0.2.1") == INTERVAL
    clock.now += 2.0
    assert limit.add("192.0.2.1") == INTERVAL - 2.0
    clock.now += INTERVAL - 2.0
    assert limit.add("192.0.2.1") == 0
    clock.now += BURST * INTERVAL
    assert [limit.add("192.0.2.1") for _ in range(BURST)] == [0] * BURST


def test_addresses_wait_for_themselves(limit):
    for _ in range(BURST + 1):
        limit.add("192.0.2.1")
    assert limit.add("192.0.2.2") == 0


def test_only_so_many_addresses_are_remembered(limit):
    for number in range(2 * ADDRESSES):
        limit.add(f"198.18.{number // 256}.{number % 256}")
    assert len(limit._paid) == ADDRESSES


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
def test_who_has_many_addresses_counts_as_one(address, counted):
    assert network_of(address) == counted


def test_a_guesser_is_told_when_to_come_again_and_a_good_token_need_not_wait(serve, services):
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
        assert http.get("/?token=mc_other").status_code in (200, 503)  # The page asks for one.
