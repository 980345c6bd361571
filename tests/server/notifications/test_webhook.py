"""The webhook: signed, repeated until it is accepted, and told of each event once."""

import hmac
import json
import logging
import socket
import time
from base64 import b64encode
from contextlib import contextmanager, suppress
from threading import Thread

import httpx
import jsonschema
import pytest
from pydantic import SecretStr, ValidationError
from webhook import KEY, SECRET, Receiver

from microcosmos_server.attempts.attempt import Attempt
from microcosmos_server.core import logs
from microcosmos_server.core.database import clock
from microcosmos_server.notifications import __main__ as trial
from microcosmos_server.notifications import delivery, outbox
from microcosmos_server.notifications.delivery import send_next
from microcosmos_server.runs.lifecycle import change
from microcosmos_server.settings import Settings, explain
from microcosmos_server.tables import Notification, Run
from microcosmos_server.workers import totals


@pytest.fixture
def receiver():
    return Receiver()


@pytest.fixture
def told(receiver, services, monkeypatch):
    """The installation with a webhook, whose address has a secret in its path."""
    with receiver.serve() as url:
        for name, value in (("url", f"{url}/hook/s3cret?k=k3y"), ("secret", SECRET)):
            monkeypatch.setattr(services.settings, f"webhook_{name}", SecretStr(value))
        yield services


def make_due(update_rows):
    update_rows(Notification, due_at=clock())


def test_a_receiver_that_fails_twice_is_told_once(
    told, receiver, attempt, record, update_rows, count, caplog
):
    receiver.answers = [(500,), (503,)]
    record(4, {5: 1.0})
    attempt.refuse("ValueError: 3 is no body")
    for tries in (1, 2):
        assert not send_next(told), "a receiver that fails has a pause"
        assert not send_next(told), "it is not due"
        assert len(receiver.got) == tries
        make_due(update_rows)
    assert send_next(told)
    assert not send_next(told)
    assert count(Notification) == 0
    ids = {headers["webhook-id"] for _, headers, _ in receiver.got}
    bodies = {body for _, _, body in receiver.got}
    assert (len(receiver.got), len(ids), len(bodies)) == (3, 1, 1)
    with told.sessions.read() as session:
        found = totals.read(session)
    assert (found[outbox.FAILED], found[outbox.DELIVERED]) == (2, 1)
    assert found[totals.Key(totals.RUNS_ENDED, "failed")] == 1, "the event counts once"
    # Servers of other tests may warn too.
    ours = [one for one in caplog.records if one.name == delivery.__name__]
    warnings = [one.getMessage() for one in ours if one.levelno >= logging.WARNING]
    assert "at try 1: it answers 500" in warnings[0]
    assert not any(word in caplog.text for word in ("s3cret", "k3y", SECRET, KEY.decode()))


def test_a_delivery_logs_no_part_of_the_address(told, receiver, attempt, capsys):
    with restored_logging():
        logs.set_up(told.settings)
        attempt.finish()
        assert send_next(told)
    assert len(receiver.got) == 1
    assert "s3cret" not in capsys.readouterr().err


@contextmanager
def restored_logging():
    root = logging.getLogger()
    before = root.handlers[:], root.level
    try:
        yield
    finally:
        logging.captureWarnings(False)
        root.handlers[:] = before[0]
        root.setLevel(before[1])


def test_what_is_sent_is_signed_and_as_documented(told, receiver, api, attempt, record, run_id):
    record(4, {5: 1.0})
    attempt.refuse("ValueError: 3 is no body")
    send_next(told)
    path, headers, body = receiver.got[0]
    assert path == "/hook/s3cret?k=k3y"
    moment = headers["webhook-timestamp"]
    assert abs(time.time() - int(moment)) < 60
    signed = f"{headers['webhook-id']}.{moment}.".encode() + body
    digest = b64encode(hmac.new(KEY, signed, "sha256").digest()).decode()
    assert headers["webhook-signature"] == f"v1,{digest}"
    document = api.get("openapi.json").json()
    schema = document["webhooks"]["run"]["post"]["requestBody"]["content"]["application/json"]
    whole = {**schema["schema"], "components": document["components"]}
    event = json.loads(body)
    jsonschema.Draft202012Validator(whole).validate(event)
    assert (event["type"], event["data"]["run"]) == ("run.failed", str(run_id))
    assert event["data"]["reason"] == "ValueError: 3 is no body"
    assert (event["data"]["generation"], event["data"]["url"]) == (4, None)


def finish(attempt: Attempt) -> None:
    attempt.finish()


def ask_to_pause(attempt: Attempt) -> None:
    attempt.pause()


def lack_a_plugin(attempt: Attempt) -> None:
    attempt.pause_until_resumed("It needs the plug-in mine.sway")


def fail_to_save(attempt: Attempt) -> None:
    attempt.services.artifacts.write = full
    attempt.end(True, 4, lambda: b"")


def full(*_):
    raise OSError(28, "No space left on device")


@pytest.mark.parametrize(
    ("act", "kinds"),
    [
        (finish, ["run.finished"]),
        (ask_to_pause, []),
        (lack_a_plugin, ["run.paused"]),
        (fail_to_save, ["run.paused"]),
    ],
)
def test_who_must_act_is_told_and_who_acted_is_not(
    told, receiver, attempt, record, act, kinds, monkeypatch
):
    monkeypatch.setattr(told.artifacts, "write", told.artifacts.write)  # `full` for this test.
    record(4, {5: 1.0})
    act(attempt)
    while send_next(told):
        pass
    assert [one["type"] for _, one in receiver.events()] == kinds


def test_a_redirect_is_not_followed(told, receiver, attempt, caplog):
    other = Receiver()
    with other.serve() as elsewhere:
        receiver.answers = [(307, elsewhere)]
        attempt.finish()
        assert not send_next(told)
    assert other.got == []
    assert "it answers 307, and redirects are not followed" in caplog.text


@pytest.fixture
def dripping():
    """The address of a receiver that sends one byte after another and comes to no end."""
    with socket.create_server(("127.0.0.1", 0)) as listening:

        def drip():
            connection, _ = listening.accept()
            with connection, suppress(OSError):
                for byte in b"HTTP/1.1 200 " + 1000 * b"O":
                    connection.send(bytes([byte]))
                    time.sleep(0.02)

        thread = Thread(target=drip)
        thread.start()
        yield f"http://127.0.0.1:{listening.getsockname()[1]}"
        thread.join()


def test_the_time_to_answer_is_that_of_the_whole_exchange(told, dripping, monkeypatch):
    monkeypatch.setattr(told.settings, "webhook_url", SecretStr(dripping))
    monkeypatch.setattr(delivery, "TIMEOUT", 0.3)
    with pytest.raises(delivery.NotDelivered, match=r"has not answered within 0\.3 s"):
        delivery.send(told.settings, "1", b"{}")


LOOKED_UP = socket.getaddrinfo


def known_addresses(host, *given, **more):
    """No name is looked up: a resolver may hang."""
    if host not in ("127.0.0.1", b"127.0.0.1"):
        raise socket.gaierror(-2, "Name or service not known")
    return LOOKED_UP(host, *given, **more)


@pytest.mark.parametrize(
    ("address", "reason"),
    [
        ("http://s3cret.invalid/", "its name is not known"),
        ("http://127.0.0.1:1/s3cret", "Connection refused"),
        ("http://s3cret..invalid/", ""),
        ("http://[s3cret/", ""),
        ("http://s3cret:99999/", ""),
        ("http://127.0.0.1:1/s3cret\x01", ""),
    ],
)
def test_no_part_of_an_address_that_fails_is_told(told, monkeypatch, address, reason):
    monkeypatch.setattr(told.settings, "webhook_url", SecretStr(address))
    monkeypatch.setattr(socket, "getaddrinfo", known_addresses)
    with pytest.raises(delivery.NotDelivered) as caught:
        delivery.send(told.settings, "1", b"{}")
    assert reason in str(caught.value)
    assert not any(part in str(caught.value) for part in ("s3cret", "127.0.0.1", "99999"))


def test_an_event_that_nobody_accepts_for_days_is_discarded(
    told, receiver, attempt, update_rows, count
):
    attempt.finish()
    receiver.answers = [(500,)]
    with told.sessions.read() as session:
        then = session.query(Notification).one().created_at - outbox.LIFETIME
    update_rows(Notification, created_at=then)
    send_next(told)
    assert count(Notification) == 0
    with told.sessions.read() as session:
        assert totals.read(session)[outbox.DISCARDED] == 1


def test_a_change_that_is_rolled_back_tells_nobody(services, run_id, count):
    with services.sessions.write() as session:
        change(session, run_id, status="failed")
        session.flush()
        session.rollback()
    assert count(Notification) == 0


def test_a_server_sends_by_itself_and_without_a_webhook_discards(
    serve, receiver, attempt, count, eventually
):
    with receiver.serve() as url:
        settings = {"webhook_url": SecretStr(url), "webhook_secret": SecretStr(SECRET)}
        attempt.finish()
        settings["reconcile_interval"] = 0.05
        with serve(**settings, public_url="https://box.example"):
            eventually(lambda: receiver.got and count(Notification) == 0)
        ((_, event),) = receiver.events()
        assert event["data"]["url"] == f"https://box.example/runs/{event['data']['run']}"
        with serve(reconcile_interval=0.05) as address:
            run = attempt.services.sessions.read().query(Run).one()
            httpx.post(f"{address}/api/v1/runs/{run.id}/extend", json={"generations": 1})
            httpx.post(f"{address}/api/v1/runs/{run.id}/cancel")
            eventually(lambda: count(Notification) == 0)
        assert len(receiver.got) == 1


@pytest.mark.parametrize(
    ("given", "field"),
    [
        ({"WEBHOOK_URL": "ftp://s3cret"}, "webhook_url"),
        ({"WEBHOOK_URL": "http://u:s3cret@host/"}, "webhook_url"),
        ({"WEBHOOK_URL": "http://host:99999/s3cret"}, "webhook_url"),
        ({"WEBHOOK_URL": "http://s3cret:abc"}, "webhook_url"),
        ({"WEBHOOK_URL": "http://:80/s3cret"}, "webhook_url"),
        ({"WEBHOOK_URL": "http://s3cret..host"}, "webhook_url"),
        ({"WEBHOOK_URL": f"http://{64 * 'l'}/s3cret"}, "webhook_url"),
        ({"WEBHOOK_URL": "http://host/s3cret/ä"}, "webhook_url"),
        ({"WEBHOOK_URL": "http://host/s3cret two"}, "webhook_url"),
        ({"WEBHOOK_URL": "http://host/s3cret\ntwo"}, "webhook_url"),
        ({"WEBHOOK_URL": "http://host/s3cret\n"}, "webhook_url"),
        ({"WEBHOOK_URL": "http://[s3cret"}, "webhook_url"),
        ({"WEBHOOK_URL": "http://host/s3cret"}, "webhook_secret"),
        ({"WEBHOOK_SECRET": "whsec_s3cret"}, "webhook_secret"),
        ({"TOKEN": "s3cret"}, "token"),
    ],
)
def test_a_wrong_secret_is_named_and_not_printed(monkeypatch, given, field):
    for name, value in given.items():
        monkeypatch.setenv(f"MICROCOSMOS_{name}", value)
    with pytest.raises(ValidationError) as caught:
        Settings()
    for text in (str(caught.value), explain(caught.value)):
        assert field in text
        assert "s3cret" not in text


def test_a_wrong_setting_that_is_no_secret_is_printed(monkeypatch):
    monkeypatch.setenv("PORT", "0")
    with pytest.raises(ValidationError) as caught:
        Settings()
    assert explain(caught.value).endswith("greater than or equal to 1; got '0'")


def test_the_command_tries_the_webhook(receiver, monkeypatch, capsys):
    with receiver.serve() as url:
        monkeypatch.setenv("MICROCOSMOS_WEBHOOK_URL", url)
        monkeypatch.setenv("MICROCOSMOS_WEBHOOK_SECRET", SECRET)
        receiver.answers = [(401,)]
        with pytest.raises(SystemExit, match="The webhook was not told: it answers 401"):
            trial.main()
        trial.main()
    assert "accepted" in capsys.readouterr().out
    assert [one["type"] for _, one in receiver.events()] == ["run.finished"] * 2
