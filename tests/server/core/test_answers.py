"""The cache of answers: its limits of memory and of work."""

import asyncio
from threading import Event

import pytest

from microcosmos_server.core.answers import AnswerCache
from microcosmos_server.core.errors import DomainError, Invalid


def never():
    raise AssertionError("the answer is kept")


def get(cache, tag, content):
    return cache.get(tag, lambda: content)


def test_answers_are_kept_within_a_limit_of_bytes():
    async def use():
        cache = AnswerCache(10)
        for tag in "abc":
            await get(cache, tag, tag.encode() * 3)
        assert await cache.get("a", never) == b"aaa"
        await get(cache, "d", b"ddd")  # The oldest, b, makes room.
        assert await get(cache, "b", b"new") == b"new"  # And now c.
        assert [await cache.get(tag, never) for tag in "adb"] == [b"aaa", b"ddd", b"new"]
        assert await get(cache, "large", bytes(11)) == bytes(11)
        assert await get(cache, "large", b"not kept") == b"not kept"
        cache.close()

    asyncio.run(use())


def test_an_error_reaches_all_who_wait_and_is_not_kept():
    go = Event()

    def fail():
        assert go.wait(60)
        raise Invalid("It cannot be made.")

    async def use():
        cache = AnswerCache(10)
        waiting = [asyncio.create_task(cache.get("a", fail)) for _ in range(3)]
        await asyncio.sleep(0)
        go.set()
        found = await asyncio.gather(*waiting, return_exceptions=True)
        assert all(isinstance(one, DomainError) for one in found)
        assert await get(cache, "a", b"good") == b"good"
        cache.close()

    asyncio.run(use())


def test_a_client_that_leaves_does_not_disturb_others():
    go = Event()

    async def use():
        cache = AnswerCache(10)
        first, other = (
            asyncio.create_task(cache.get("a", lambda: go.wait(60) and b"made"))
            for _ in range(2)
        )
        await asyncio.sleep(0)
        first.cancel()
        await asyncio.sleep(0)
        go.set()
        assert await other == b"made"
        cache.close()

    asyncio.run(use())


def test_more_answers_than_may_wait_are_refused():
    go = Event()

    async def use():
        cache = AnswerCache(10, waiting=2)
        waiting = [
            asyncio.create_task(cache.get(tag, lambda: go.wait(60) and b"made")) for tag in "ab"
        ]
        await asyncio.sleep(0)
        with pytest.raises(DomainError) as refused:
            await get(cache, "c", b"c")
        assert refused.value.problem.status == 503
        go.set()
        await asyncio.gather(*waiting)
        assert await get(cache, "c", b"c") == b"c"
        cache.close()

    asyncio.run(use())


def test_anonymous_requests_leave_places_to_others():
    go = Event()

    def wait():
        return go.wait(60) and b"made"

    async def use():
        cache = AnswerCache(10, threads=1, waiting=8)
        first = [asyncio.create_task(cache.get(tag, wait, anonymous=True)) for tag in "ab"]
        await asyncio.sleep(0)
        with pytest.raises(DomainError):
            await cache.get("c", wait, anonymous=True)
        assert await cache.get("c", lambda: b"at once") == b"at once"
        go.set()
        assert await asyncio.gather(*first) == [b"made", b"made"]
        cache.close()

    asyncio.run(use())
