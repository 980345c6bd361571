"""Whoever guesses tokens is told to wait, and nobody else."""

import httpx
import pytest

from server.auth import tokens
from server.auth.ratelimit import ADDRESSES, AT_ONCE, EVERY, Guesses, household


class Clock:
    now = 0.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def guesses(clock) -> Guesses:
    return Guesses(clock)


def test_some_wrong_tokens_are_forgiven_and_each_in_time(guesses, clock):
    assert [guesses.add("192.0.2.1") for _ in range(AT_ONCE)] == [0] * AT_ONCE
    assert guesses.add("192.0.2.1") == EVERY
    clock.now += 2.0
    assert guesses.add("192.0.2.1") == EVERY - 2.0
    clock.now += EVERY - 2.0
    assert guesses.add("192.0.2.1") == 0
    clock.now += AT_ONCE * EVERY
    assert [guesses.add("192.0.2.1") for _ in range(AT_ONCE)] == [0] * AT_ONCE


def test_addresses_wait_for_themselves(guesses):
    for _ in range(AT_ONCE + 1):
        guesses.add("192.0.2.1")
    assert guesses.add("192.0.2.2") == 0


def test_only_so_many_addresses_are_remembered(guesses):
    for number in range(2 * ADDRESSES):
        guesses.add(f"198.18.{number // 256}.{number % 256}")
    assert len(guesses._paid) == ADDRESSES


@pytest.mark.parametrize(
    ("address", "counted"),
    [
        ("192.0.2.1", "192.0.2.1"),
        ("::ffff:192.0.2.1", "192.0.2.1"),
        ("2001:db8:1:2:3:4:5:6", "2001:db8:1:2::/64"),
        ("fe80::1%eth0", "fe80::/64"),
        ("", "somebody"),
        ("x" * 60_000, "somebody"),
    ],
)
def test_who_has_many_addresses_counts_as_one(address, counted):
    assert household(address) == counted


def test_a_guesser_is_told_when_to_come_again_and_a_good_token_need_not_wait(serve, services):
    tokens.create(services, "root", "admin")
    good = tokens.create(services, "alice", "read").secret
    ended = tokens.create(services, "bob", "read")
    tokens.revoke(services, ended.token.id)
    with serve(auth="required") as address, httpx.Client(base_url=address) as http:

        def ask(secret):
            sent = {"Authorization": f"Bearer {secret}"}
            return http.get("/api/v1/runs", headers=sent)

        for _ in range(2 * AT_ONCE):  # Neither is a guess.
            assert http.get("/api/v1/runs").status_code == 401
            assert ask(ended.secret).status_code == 401
        for number in range(AT_ONCE):
            assert ask(f"mc_{number}").status_code == 401
        ways = (
            lambda: ask("mc_other"),
            lambda: http.post("/api/v1/session", json={"token": "mc_other"}),
            lambda: http.get("/api/v1/nothing", headers={"Authorization": "Bearer mc_other"}),
        )
        for refused in (way() for way in ways):
            assert refused.status_code == 429
            assert 1 <= int(refused.headers["retry-after"]) <= EVERY
            assert refused.json()["title"] == "Too many wrong tokens"
        assert ask(good).status_code == 200
        assert http.post("/api/v1/session", json={"token": good}).status_code == 200
        assert http.get("/?token=mc_other").status_code in (200, 503)  # The page asks for one.
