"""The event stream: every change in order, once, also after an outage."""

import asyncio
import json
import os
import signal
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from functools import partial
from uuid import UUID, uuid4

import httpx
import pytest
from redis import RedisError

from microcosmos_server.core.processes import end
from microcosmos_server.events import routes
from microcosmos_server.events.schemas import EVENTS
from microcosmos_server.local import redis_embedded
from microcosmos_server.runs import announce as announcing
from microcosmos_server.runs.announce import announce
from microcosmos_server.services import messages
from microcosmos_server.services import services as connecting
from microcosmos_server.services.services import connect


def read(lines):
    """Events as (id, kind, data)."""
    event = {}
    for line in lines:
        if not line and event:
            yield event.get("id"), event.get("event"), json.loads(event.get("data", "null"))
            event = {}
        elif line and not line.startswith(":"):
            key, _, value = line.partition(": ")
            event[key] = value


@contextmanager
def stream(address, last=None, **query):
    headers = {"Last-Event-ID": last} if last else {}
    url = f"{address}/api/v1/events"
    with httpx.stream("GET", url, params=query, headers=headers, timeout=10) as answer:
        assert answer.headers["content-type"].startswith("text/event-stream")
        yield read(answer.iter_lines())


def take(found, number):
    return [next(found) for _ in range(number)]


def test_the_stream_carries_every_change_of_a_run(address, run_id, claim_run, report):
    with stream(address) as found:
        identifier, kind, data = next(found)
        assert (kind, data) == ("start", {})  # The place from which it goes on.
        assert identifier
        attempt = claim_run()
        attempt.record(report(1, {3: 1.0, 9: 2.0}), 1.5)
        attempt.finish()
        received = take(found, 5)
    kinds = [kind for _, kind, _ in received]
    assert kinds == ["run", "generation", "elites", "run", "run"]
    data = [data for _, _, data in received]
    for kind, content in zip(kinds, data, strict=True):
        EVENTS[kind].model_validate_json(json.dumps(content))
    assert data[0]["status"] == "running"
    assert data[1] == {
        "run": str(run_id),
        "generation": 1,
        "qd_score": 10.0,
        "coverage": 1 / 256,
        "best": 1.0,
        "mean": 0.5,
        "evaluations": 16,
        "infeasible": 1,
        "seconds": 1.5,
        "summary": None,
    }
    assert (data[2]["cell"], data[2]["fitness"]) == ([3, 9], [1.0, 2.0])
    assert (data[3]["generation"], data[4]["status"]) == (1, "finished")
    assert [("spec" in data[i]) for i in (0, 3, 4)] == [True, False, True]


def test_claiming_a_run_again_rewinds_it(address, run_id, claim_run, attempt, record):
    for generation in (1, 2, 3):
        record(generation)
        if generation == 2:
            attempt.save(2, b"state")
    with stream(address) as found:
        next(found)
        claim_run()
        (_, kind, data), (_, then, run) = take(found, 2)
    assert (kind, data) == ("rewind", {"run": str(run_id), "generation": 2})
    assert (then, run["generation"]) == ("run", 2)


def test_the_last_event_of_a_run_is_its_current_state(services, run_id, claim_run, monkeypatch):
    """A slow reader publishes a stale state after a newer one."""
    sent, publish = [], services.events.publish

    def be_overtaken(kind, run, data):
        monkeypatch.setattr(services.events, "publish", note)
        claim_run()
        note(kind, run, data)

    def note(kind, run, data):
        sent.append(data["status"])
        publish(kind, run, data)

    monkeypatch.setattr(services.events, "publish", be_overtaken)
    announce(services, run_id)
    assert sent == ["running", "queued", "running"]


def test_an_unchanged_run_is_published_once(services, run_id, monkeypatch, record, attempt):
    sent = []
    monkeypatch.setattr(services.events, "publish", lambda *event: sent.append(event))
    record(1)
    sent.clear()
    announce(services, run_id, without=["spec"])
    assert len(sent) == 1


def test_an_event_carries_no_long_spec(services, run_id, monkeypatch):
    """Redis keeps thousands of events: with specs of a megabyte, ten gigabytes."""
    sent = []
    monkeypatch.setattr(services.events, "publish", lambda _kind, _run, data: sent.append(data))
    announce(services, run_id)
    assert "search" in sent[-1]["spec"]
    length = len(json.dumps(sent[-1]["spec"]))
    monkeypatch.setattr(announcing, "SPEC_BYTES", length)
    announce(services, run_id)
    assert "spec" in sent[-1]
    monkeypatch.setattr(announcing, "SPEC_BYTES", length - 1)
    (run,) = announce(services, run_id)
    assert run.spec
    assert sent[-1].keys() == sent[0].keys() - {"spec"}


def test_a_stream_of_one_run_excludes_others(address, services):
    mine, other = uuid4(), uuid4()
    with stream(address, run=mine) as found:
        next(found)
        for number in range(4):
            services.events.publish("run", other if number % 2 else mine, {"number": number})
        assert [data["number"] for _, _, data in take(found, 2)] == [0, 2]


def test_nothing_is_lost_or_doubled_over_restarts_of_the_server(services, serve):
    run_id, received, last, total = uuid4(), [], None, 400

    def publish():
        for number in range(total):
            services.events.publish("run", run_id, {"number": number})
            time.sleep(0.002)

    publisher = threading.Thread(target=publish)
    for _ in range(4):
        with serve() as address, stream(address, last) as found:
            if last is None:
                last = next(found)[0]
                publisher.start()
            for identifier, _, data in found:
                last = identifier
                received.append(data["number"])
                if len(received) % 100 == 0:
                    break
    publisher.join()
    assert received == list(range(total))


@pytest.mark.parametrize("last", ["1-0", "99999999999999-0", "nonsense"])
def test_a_client_that_missed_too_much_is_reset(address, services, last):
    services.events.publish("run", uuid4(), {})
    with stream(address, last) as found:
        identifier, kind, _ = next(found)
        assert kind == "reset"
        services.events.publish("run", uuid4(), {"number": 1})
        later = [event for event in take(found, 1) if event[1] == "run"]
    assert later
    assert routes.position(later[0][0]) > routes.position(identifier)


def test_a_malformed_id_within_the_stream_is_reset(address, services, published):
    for _ in range(2):
        services.events.publish("run", uuid4(), {})
        published()
        time.sleep(0.01)  # Ids of two milliseconds.
    first = services.redis.xrange(services.events.stream)[0][0].decode()
    milliseconds = first.partition("-")[0]
    for last in (f"{milliseconds}-{2**64}", f"{milliseconds[:3]}_{milliseconds[3:]}-0"):
        with stream(address, last) as found:
            assert next(found)[1] == "reset"
            services.events.publish("run", uuid4(), {"number": 1})
            assert next(found)[2] == {"number": 1}


async def has_all(services, last):
    """Whether a client with a last id misses no event that was trimmed."""
    fanout = routes.Fanout(services.settings.redis_url, services.events.stream)
    found = await fanout._contains(last)
    await fanout.redis.aclose()
    return found


def test_only_who_missed_trimmed_events_is_reset(address, services, flush):
    """All events were trimmed: one client has none of them, others some and all."""
    flush()
    with stream(address) as found:  # The server has read them before they are trimmed.
        next(found)
        for _ in range(3):
            services.events.publish("run", uuid4(), {})
        take(found, 3)
    ids = [one.decode() for one, _ in services.redis.xrange(services.events.stream)]
    services.redis.xtrim(services.events.stream, maxlen=0, approximate=False)
    for last in ("0-0", ids[1]):
        with stream(address, last) as found:
            assert next(found)[:2] == (ids[2], "reset")
    # Not by a stream: an event may come before the server has looked.
    assert asyncio.run(has_all(services, ids[2]))
    assert not asyncio.run(has_all(services, ids[1]))


def test_an_emptied_stream_resets_its_clients(address, services, flush):
    with stream(address) as found:
        next(found)
        services.events.publish("run", uuid4(), {})
        last = next(found)[0]
    flush()
    with stream(address, last) as found:
        assert next(found)[1] == "reset"


def test_a_slow_listener_is_reset():
    listener = routes.Listener("0-0")
    for number in range(routes.QUEUE_SIZE + 1):
        listener.put(routes.Entry(f"{number + 1}-0", "run"))
    waiting = [listener.waiting.get_nowait() for _ in range(listener.waiting.qsize())]
    assert [(entry.id, entry.kind) for entry in waiting] == [
        (f"{routes.QUEUE_SIZE + 1}-0", "reset")
    ]


def test_what_waits_for_a_slow_listener_is_limited_in_length(monkeypatch):
    monkeypatch.setattr(routes, "QUEUE_LENGTH", 1000)
    listener = routes.Listener("0-0")
    kinds, longest = [], 0

    async def take():
        entry = await listener.get()
        kinds.append((entry.id, entry.kind))

    for number in range(6):
        listener.put(routes.Entry(f"{number}-0", "elites", data="x" * 300))
        longest = max(longest, listener.length)
    while not listener.waiting.empty():
        asyncio.run(take())
    assert kinds == [("3-0", "reset"), ("4-0", "elites"), ("5-0", "elites")]
    assert longest == 900
    assert listener.length == 0


def test_events_trimmed_while_a_client_catches_up_are_not_skipped_in_silence(services, flush):
    """It reads a page at its own pace; long events may trim many others meanwhile."""
    flush()
    for _ in range(9):
        services.events.publish("run", uuid4(), {})
    services.events.messenger.flush(10)
    ids = [one.decode() for one, _ in services.redis.xrange(services.events.stream)]

    async def catch_up():
        fanout = routes.Fanout(services.settings.redis_url, services.events.stream)
        fanout.read_up_to = ids[-1]
        sent = []
        with fanout.listening() as listener:
            async for event in fanout.follow(listener, ids[0], None):
                sent.append((event.id, event.event))
                if len(sent) == 1:
                    services.redis.xtrim(services.events.stream, maxlen=2, approximate=False)
                    listener.put(None)
        await fanout.redis.aclose()
        return sent

    assert asyncio.run(catch_up()) == [(ids[1], "run"), (ids[-1], "reset")]


def test_few_long_events_are_read_at_once():
    """What is read waits in memory for a client that takes it at its own pace."""
    long, short = (routes.Entry("1-0", "elites", data="x" * size) for size in (1_000_000, 10))
    pace, counts = routes.Pace(), []
    for entry in (short, short, short, short, long, long, short):
        counts.append(pace.count)
        pace.note([entry] * pace.count)
    assert counts == [1, 4, 16, 64, 100, 1, 1]
    pace.note([])  # Nothing came, so nothing is known of what will.
    assert pace.count == 4


@pytest.fixture
def frozen(tmp_path):
    """A Redis, and a function that freezes it for a block: it accepts, and is silent."""
    redis = redis_embedded.prepare(tmp_path / "redis")
    process = redis.start(tmp_path / "log")
    redis.wait(process, tmp_path / "log")

    @contextmanager
    def freeze():
        process.send_signal(signal.SIGSTOP)
        try:
            yield
        finally:
            process.send_signal(signal.SIGCONT)

    yield redis.url, freeze
    end(process)
    os.close(redis.lock)


def test_nobody_waits_for_a_frozen_redis_and_clients_learn_of_the_loss(
    frozen, serve, services, spec, monkeypatch
):
    monkeypatch.setattr(messages, "SILENT_SECONDS", 0.5)
    monkeypatch.setattr(connecting, "MESSAGE_SECONDS", 1.0)
    url, freeze = frozen
    with serve(redis_url=url) as address, stream(address) as found:
        next(found)
        run = httpx.post(f"{address}/api/v1/runs", json=spec).json()["id"]
        assert next(found)[1] == "run"
        here = connect(services.settings.model_copy(update={"redis_url": url}))
        with freeze(), ThreadPoolExecutor(45) as pool:
            began = time.monotonic()
            for number in range(300):  # As many as 100 generations publish.
                here.events.publish("generation", UUID(run), {"number": number})
            assert time.monotonic() - began < 5
            change = partial(httpx.patch, f"{address}/api/v1/runs/{run}", timeout=20)
            changes = [pool.submit(change, json={"note": f"{n}"}) for n in range(45)]
            assert httpx.get(f"{address}/healthz", timeout=20).status_code == 200
            assert {one.result().status_code for one in changes} == {200}
            assert time.monotonic() - began < 30
            time.sleep(2.5)  # Until reading ends, too.
        time.sleep(0.6)
        here.events.publish("generation", UUID(run), {"number": "last"})
        kinds = []
        for _, kind, data in found:
            kinds.append(kind)
            if data.get("number") == "last":
                break
        assert "reset" in kinds
        here.close()


def test_long_messages_are_dropped_before_they_fill_the_memory(frozen, services, monkeypatch):
    monkeypatch.setattr(messages, "WAITING_BYTES", 3000)
    url, freeze = frozen
    here = connect(services.settings.model_copy(update={"redis_url": url}))
    with freeze():
        for number in range(20):
            here.events.publish("run", uuid4(), {"number": number, "long": "x" * 1000})
        assert here.events.messenger._waiting.qsize() <= 4
    here.events.messenger.flush(20)
    here.close()
    assert here.events.messenger._bytes == 0


def test_a_loss_is_told_though_nothing_follows(frozen, services, monkeypatch):
    monkeypatch.setattr(messages, "SILENT_SECONDS", 0.3)
    monkeypatch.setattr(connecting, "MESSAGE_SECONDS", 1.0)
    url, freeze = frozen
    here = connect(services.settings.model_copy(update={"redis_url": url}))
    with freeze():
        here.events.publish("run", uuid4(), {})
        here.events.messenger.flush(5)
    deadline = time.monotonic() + 20
    while not here.redis.xlen(here.events.stream):
        assert time.monotonic() < deadline
        time.sleep(0.05)
    assert [e[b"event"] for _, e in here.redis.xrange(here.events.stream)] == [b"reset"]
    here.close()


@pytest.mark.parametrize(
    ("errors", "delivered"),
    [
        ([AttributeError("a bug")], ["run"]),
        ([RedisError("away"), AttributeError("a bug")], ["reset", "run"]),
    ],
    ids=["at a message", "while it tells of a loss"],
)
def test_no_error_ends_the_thread_that_sends(
    services, monkeypatch, published, eventually, errors, delivered
):
    monkeypatch.setattr(messages, "SILENT_SECONDS", 0.1)
    send = services.events.redis.execute_command
    left = [*errors]

    def sometimes(*command, **options):
        if command[0] == "XADD" and left:
            raise left.pop(0)
        return send(*command, **options)

    monkeypatch.setattr(services.events.redis, "execute_command", sometimes)
    services.events.publish("run", uuid4(), {"number": 0})
    eventually(lambda: not left)
    if len(errors) > 1:
        eventually(lambda: services.redis.xlen(services.events.stream))
    services.events.publish("run", uuid4(), {"number": 1})
    assert [kind for kind, _ in published()] == delivered


def test_the_stream_is_trimmed(services, monkeypatch):
    monkeypatch.setattr(messages, "STREAM_LENGTH", 100)
    for _ in range(500):
        services.events.publish("run", uuid4(), {})
    messages.flush()
    assert services.redis.xlen(services.events.stream) <= 200


def test_the_bytes_of_the_stream_are_limited(services, monkeypatch, published):
    """Each event here takes a part of Redis's list of its own, which trims whole parts."""
    monkeypatch.setattr(messages, "STREAM_BYTES", 100_000)
    for number in range(50):
        services.events.publish("elites", uuid4(), {"number": number, "creature": "a" * 9_900})
    services.events.publish("run", uuid4(), {})
    found = [data.get("number") for _, data in published()]
    assert found == [*range(40, 50), None]
