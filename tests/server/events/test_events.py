"""The event stream: every change in order, once, also after an outage."""

import json
import threading
import time
from contextlib import ExitStack, contextmanager
from uuid import uuid4

import httpx
import pytest

from server.events import fanout
from server.runs.announce import announce
from server.services import event_stream as events


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
        assert (kind, data) == (None, None)  # The place from which it goes on.
        assert identifier
        attempt = claim_run()
        attempt.record(report(1, {3: 1.0, 9: 2.0}), 1.5)
        attempt.finish()
        received = take(found, 5)
    kinds = [kind for _, kind, _ in received]
    assert kinds == ["run", "generation", "elites", "run", "run"]
    data = [data for _, _, data in received]
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


def test_requested_actions_are_published(address, api, run_id):
    with stream(address) as found:
        next(found)
        api.post(f"runs/{run_id}/pause")
        api.post(f"runs/{run_id}/resume")
        assert [data["status"] for _, _, data in take(found, 2)] == ["paused", "queued"]


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


def test_stopping_the_server_ends_its_streams(serve):
    with ExitStack() as server:
        address = server.enter_context(serve())
        with stream(address) as found:
            next(found)
            begun = time.monotonic()
            server.close()
            assert list(found) == []
    assert time.monotonic() - begun < 3


@pytest.mark.parametrize("last", ["1-0", "99999999999999-0", "nonsense"])
def test_a_client_that_missed_too_much_is_reset(address, services, last):
    services.events.publish("run", uuid4(), {})
    with stream(address, last) as found:
        identifier, kind, _ = next(found)
        assert kind == "reset"
        services.events.publish("run", uuid4(), {"number": 1})
        later = [event for event in take(found, 1) if event[1] == "run"]
    assert later
    assert fanout.position(later[0][0]) > fanout.position(identifier)


def test_an_emptied_stream_resets_its_clients(address, services, flush):
    with stream(address) as found:
        next(found)
        services.events.publish("run", uuid4(), {})
        last = next(found)[0]
    flush()
    with stream(address, last) as found:
        assert next(found)[1] == "reset"


def test_a_slow_listener_is_reset():
    listener = fanout.Listener("0-0")
    for number in range(fanout.QUEUE_SIZE + 1):
        listener.put(fanout.Entry(f"{number + 1}-0", "run"))
    waiting = [listener.waiting.get_nowait() for _ in range(listener.waiting.qsize())]
    assert [(entry.id, entry.kind) for entry in waiting] == [
        (f"{fanout.QUEUE_SIZE + 1}-0", "reset")
    ]


def test_the_stream_is_trimmed(services, monkeypatch):
    monkeypatch.setattr(events, "STREAM_LENGTH", 100)
    for _ in range(500):
        services.events.publish("run", uuid4(), {})
    assert services.redis.xlen(services.events.stream) <= 200
