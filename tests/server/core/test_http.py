"""HTTP itself: HEAD, methods, headers, JSON types, and requests that are only half sent."""

import asyncio
import re
import socket
import threading
import time
from contextlib import closing, contextmanager, suppress
from http.client import HTTPConnection
from pathlib import Path
from typing import ClassVar
from urllib.parse import urlsplit

import h11
import httpx
import psutil
import pytest
import uvicorn
from answers import detail, fields

from microcosmos_server.app import create_app
from microcosmos_server.core import static_files
from microcosmos_server.core.connections import Connection
from microcosmos_server.core.database import REQUEST_CONNECTIONS
from microcosmos_server.core.errors import StoreUnavailable
from microcosmos_server.creatures.sandbox import Sandbox
from microcosmos_server.maintenance.healthcheck import answers
from microcosmos_server.queue.jobs import Jobs
from microcosmos_server.renderings import storage as renderings
from microcosmos_server.services.services import connect
from microcosmos_server.settings import Settings, from_environment
from microcosmos_server.storage import space
from microcosmos_server.storage.artifacts import Artifacts
from microcosmos_server.tables import PREVIEW, REPLAY

ROUTER = Path(__file__).parents[3] / "web" / "src" / "store" / "router.ts"


@pytest.mark.parametrize("path", ["runs", "runs/{run}", "runs/{run}/generations", "sweeps"])
def test_many_requests_at_once_wait_for_each_other_and_all_are_answered(address, run_id, path):
    """More than there are threads, each of which needs a connection to the database."""

    async def ask():
        limits = httpx.Limits(max_connections=None)
        async with httpx.AsyncClient(timeout=20, verify=False, limits=limits) as client:
            url = f"{address}/api/v1/{path.format(run=run_id)}"
            return await asyncio.gather(*(client.get(url) for _ in range(100)))

    assert [one.status_code for one in asyncio.run(ask())] == [200] * 100


@pytest.mark.parametrize(
    "path",
    [
        *("api/v1/creatures/{creature}/replay", "api/v1/creatures/{creature}/poses"),
        *("api/v1/creatures/{creature}/motion", "api/v1/creatures/{creature}/poses.csv"),
        *("api/v1/creatures/{creature}/preview.png", "api/v1/shares/{slug}/preview.png"),
        *("api/v1/runs/{run}/archive.h5", "api/v1/queue", "s/{slug}", "readyz"),
    ],
)
def test_a_slow_store_or_redis_keeps_no_place_from_other_requests(
    address, api, services, run_id, attempt, record, known, path, monkeypatch, built
):
    """Each takes a thread, of which there are more than connections."""
    record(1, {5: 1.0})
    attempt.save(1, b"data")
    for kind in (REPLAY, PREVIEW) if path != "s/{slug}" else ():
        renderings.save(services, known, kind, b"a file")
    slug = api.post("shares", json={"creature": known}).json()["slug"]
    go, read, waiting = threading.Event(), Artifacts.read, threading.Semaphore(0)

    def slowly_of(function, *given, **named):
        waiting.release()
        go.wait(20)
        return function(*given, **named)

    def slowly(self, *given, **named):
        return slowly_of(read, self, *given, **named)

    monkeypatch.setattr(Artifacts, "read", slowly)
    free, find = space.free_bytes, Jobs.find
    monkeypatch.setattr(space, "free_bytes", lambda *given: slowly_of(free, *given))
    monkeypatch.setattr(Jobs, "find", lambda *given: slowly_of(find, *given))
    url = f"{address}/{path.format(creature=known, run=run_id, slug=slug)}"

    async def ask():
        async with httpx.AsyncClient(timeout=20, verify=False) as client:
            number = REQUEST_CONNECTIONS + 2
            asked = [asyncio.create_task(client.get(url)) for _ in range(number)]
            for _ in range(number):
                assert await asyncio.to_thread(waiting.acquire, timeout=10)
            found = await client.get(f"{address}/api/v1/runs", timeout=5)
            go.set()
            await asyncio.gather(*asked)
            return found

    try:
        assert asyncio.run(ask()).status_code == 200
    finally:
        go.set()


@pytest.fixture
def built(tmp_path, monkeypatch):
    (tmp_path / "assets").mkdir()
    (tmp_path / "index.html").write_text("<title>the page</title>")
    (tmp_path / "assets" / "a1b2.js").write_text("script")
    monkeypatch.setattr(static_files, "BUILT", tmp_path)


def test_head_is_get_without_content(address, built, api, run_id, record):
    record(1, {5: 1.0})
    paths = "/", "/healthz", "/assets/a1b2.js", "/api/v1/runs", f"/api/v1/runs/{run_id}/archive"
    for path in (*paths, "/api/v1/none", "/none"):
        get, head = httpx.get(f"{address}{path}"), httpx.head(f"{address}{path}")
        assert (head.status_code, head.content) == (get.status_code, b""), path
        for name in ("content-type", "content-length", "etag", "cache-control"):
            assert head.headers.get(name) == get.headers.get(name), (path, name)


def test_head_of_a_stream_without_an_end_ends(address):
    began = time.monotonic()
    answer = httpx.head(f"{address}/api/v1/events")
    assert answer.headers["content-type"].startswith("text/event-stream")
    assert time.monotonic() - began < 10


def test_paths_that_the_page_does_not_have_are_missing(address, built):
    names = re.search(r"const PAGES = (\[.*?\]);", ROUTER.read_text())
    pages = re.findall(r'"(\w+)"', names[1]) if names else []
    assert len(pages) > 5
    shown = [*pages, "", "runs/1", "runs/1/tree", "creatures/ab", "sweeps/1", "s/slug/embed"]
    for path in shown:
        if path != "commons":  # A page of its own.
            assert "the page" in httpx.get(f"{address}/{path}").text, path
    for path in ("none", "wp-login.php", ".env", "runs/1/none", "favicon.png", "new/1"):
        assert httpx.get(f"{address}/{path}").status_code == 404, path
        assert httpx.get(f"{address}/{path}").headers["content-type"].startswith("text/html")


def test_other_methods_are_named_where_a_path_looks_like_an_id(api):
    for path, allowed in (
        ("runs/estimate", "POST"),
        ("sweeps/estimate", "POST"),
        ("tokens/current", "GET, HEAD"),
    ):
        for method in ("PATCH", "DELETE"):
            answer = api.request(method, path, json={})
            assert f"takes {allowed}; got {method}." in detail(answer, 405), path
            assert answer.headers["allow"] == allowed
    assert api.get("runs/none").status_code == 422


@pytest.mark.parametrize(
    ("accepted", "media_type"),
    [
        ("application/vnd.microcosmos.columns", "application/vnd.microcosmos.columns"),
        (
            "application/vnd.microcosmos.columns;q=0.5, */*",
            "application/vnd.microcosmos.columns",
        ),
        ("application/vnd.microcosmos.columns;q=0", "application/json"),
        ("application/json, application/vnd.microcosmos.columns; q=0.000", "application/json"),
    ],
)
def test_a_weight_of_zero_refuses_a_media_type(api, run_id, record, accepted, media_type):
    record(1, {5: 1.0})
    answer = api.get(f"runs/{run_id}/archive", headers={"Accept": accepted})
    assert answer.headers["content-type"].split(";")[0] == media_type


def test_assets_heed_a_weight_of_zero(address, built):
    for accepted, encoding in (("gzip", "gzip"), ("gzip;q=0", None), ("x-gzip-not", None)):
        headers = {"Accept-Encoding": accepted}
        answer = httpx.get(f"{address}/assets/a1b2.js", headers=headers)
        assert answer.headers.get("content-encoding") == encoding, accepted


def test_entity_tags_may_come_in_several_lines(api, run_id, record):
    record(1, {5: 1.0})
    url = f"runs/{run_id}/archive"
    tag = api.get(url).headers["etag"]
    for tags in ([tag], ['"other"', tag], [tag, '"other"'], [f'"other", W/{tag}', '"more"']):
        answer = api.get(url, headers=[("If-None-Match", one) for one in tags])
        assert answer.status_code == 304, tags
    assert api.get(url, headers=[("If-None-Match", '"a"'), ("If-None-Match", '"b"')]).is_success


def test_json_types_are_strict(api, run_id, spec):
    run = f"runs/{run_id}"
    for method, path, body, field in (
        ("PATCH", run, {"device_patience": False}, "device_patience"),
        ("PATCH", run, {"device_patience": "5"}, "device_patience"),
        ("PATCH", run, {"may_yield": 1}, "may_yield"),
        ("PATCH", run, {"may_yield": "yes"}, "may_yield"),
        ("POST", f"{run}/extend", {"generations": "5"}, "generations"),
        ("POST", f"{run}/extend", {"generations": True}, "generations"),
        ("POST", f"{run}/extend", {"generations": 5.5}, "generations"),
        ("POST", "sweeps", {"spec": spec, "seeds": True}, "seeds"),
        ("POST", "tokens", {"name": "one", "scope": "read", "expires_at": False}, "expires_at"),
    ):
        found = fields(api.request(method, path, json=body))
        assert found[0].split(".")[0] == field, (path, body, found)
    assert api.patch(run, json={"device_patience": 5}).json()["device_patience"] == 5.0
    whole = api.post(f"{run}/extend", json={"generations": 5.0})
    assert whole.status_code == 409, "5.0 is a whole number; the run is not finished"


def test_a_store_that_cannot_be_written_is_named(serve, services, monkeypatch):
    """Anybody may ask, so the store is not tried at each request."""
    tried = []

    def refuse(store, path, data):
        if path == "probe":
            tried.append(path)
            raise StoreUnavailable("Read-only file system")

    monkeypatch.setattr(Artifacts, "write", refuse)
    with serve() as address:
        for _ in range(3):
            ready = httpx.get(f"{address}/readyz")
            assert (ready.status_code, ready.json()["store"]) == (503, "cannot be written")
    assert tried == ["probe"]


def send(address, *parts, pause=0.0):
    """The answer to bytes that are sent in parts, and whether the server closes."""
    place = urlsplit(address)
    with closing(socket.create_connection((place.hostname, place.port), timeout=20)) as opened:
        for part in parts:
            opened.sendall(part)
            time.sleep(pause)
        answer = b""
        while part := opened.recv(1 << 16):
            answer += part
        return answer


def test_two_lengths_are_refused_and_the_connection_is_closed(address):
    head = b"POST /api/v1/runs HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 5\r\n"
    answer = send(address, head + b"Transfer-Encoding: chunked\r\n\r\n0\r\n\r\n")
    assert answer.startswith(b"HTTP/1.1 400 ")
    assert b"got both" in answer


class Impatient(Connection):
    SECONDS: ClassVar[dict[type, float]] = {h11.IDLE: 0.5, h11.SEND_BODY: 0.7}
    PROGRESS = 1000
    UNREAD_SECONDS = 0.4


@pytest.fixture
def impatient(services):
    """A server that waits shortly for the rest of a request."""
    app = create_app(connect(services.settings))
    config = uvicorn.Config(app, port=0, log_level="warning", http=Impatient)
    with in_thread(uvicorn.Server(config)) as server:
        yield f"http://127.0.0.1:{server.servers[0].sockets[0].getsockname()[1]}"
        app.state.end_streams()


@contextmanager
def in_thread(server):
    thread = threading.Thread(target=server.run)
    thread.start()
    while not server.started:
        assert thread.is_alive()
        time.sleep(0.01)
    try:
        yield server
    finally:
        server.should_exit = True
        thread.join()


START = b"PATCH /api/v1/runs/none HTTP/1.1\r\nHost: 127.0.0.1\r\n"


@pytest.mark.parametrize(
    "sent",
    [b"", b"GET /he", START, START + b"Content-Length: 9\r\n\r\n{"],
    ids=["nothing", "a line", "a head", "a body"],
)
def test_a_half_sent_request_ends_at_a_deadline(impatient, sent, caplog):
    began = time.monotonic()
    send(impatient, sent)
    assert 0.3 < time.monotonic() - began < 15
    assert httpx.get(f"{impatient}/healthz").status_code == 200
    assert "Traceback" not in caplog.text


def test_a_slow_body_that_goes_on_and_a_second_request_are_answered(impatient):
    body = b" " * 6000
    head = START + b"Connection: close\r\nContent-Length: 6002\r\n\r\n{"
    parts = [body[k : k + 1000] for k in range(0, 6000, 1000)]
    assert b"422" in send(impatient, head, *parts, b"}", pause=0.25).split(b"\r\n")[0]
    place = urlsplit(impatient)
    with closing(HTTPConnection(place.hostname, place.port, timeout=20)) as connection:
        connection.connect()
        opened = connection.sock
        for _ in range(3):  # One connection, with pauses.
            connection.request("GET", "/healthz")
            answer = connection.getresponse()
            assert answer.status == 200
            answer.read()
            assert connection.sock is opened
            time.sleep(0.8)  # Longer than the deadline of a head: between requests none counts.


def test_a_client_that_reads_nothing_of_a_large_answer_is_left():
    """The system takes some megabytes; the rest waits in the server."""
    size, ended = 64 << 20, threading.Event()

    async def large(scope, receive, send):
        await send({"type": "http.response.start", "status": 200, "headers": []})
        await send({"type": "http.response.body", "body": bytes(size), "more_body": True})
        # It waits for the first.
        await send({"type": "http.response.body", "body": b"the end"})
        ended.set()

    config = uvicorn.Config(large, port=0, log_level="warning", http=Impatient, lifespan="off")
    with in_thread(uvicorn.Server(config)) as server:
        port = server.servers[0].sockets[0].getsockname()[1]
        with closing(socket.socket()) as opened:
            opened.settimeout(20)
            opened.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 14)
            opened.connect(("127.0.0.1", port))
            opened.sendall(b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n")
            got = 0
            for _ in range(40):  # As long as it reads, it may be slow.
                got += len(opened.recv(1 << 15))
                time.sleep(0.05)
            assert not ended.wait(0)
            assert ended.wait(20)
            with suppress(ConnectionResetError):
                while part := opened.recv(1 << 20):
                    got += len(part)
        assert got < size


def test_a_client_that_leaves_while_sending_writes_no_traceback(address, caplog):
    place = urlsplit(address)
    head = START + b"Content-Length: 900\r\n\r\n{"
    for _ in range(3):
        with closing(socket.create_connection((place.hostname, place.port))) as opened:
            opened.sendall(head)
            time.sleep(0.1)
    time.sleep(0.5)
    assert "Traceback" not in caplog.text
    assert not [one for one in caplog.records if one.levelname == "ERROR"]


def test_addresses_of_any_host_can_be_asked(start_server):
    assert Settings(host="::1", PORT=81).address == "http://[::1]:81"
    assert Settings(host="0.0.0.0", PORT=81).address == "http://127.0.0.1:81"
    with start_server(MICROCOSMOS_HOST="::1") as (_, address):
        assert address.startswith("http://[::1]:")
        assert answers(f"{address}/readyz")
        assert httpx.get(f"{address}/api/v1/runs").status_code == 200


@pytest.mark.parametrize("url", ["https://host/path", "https://host/?q", "host", "https://u@h"])
def test_a_public_url_with_a_path_is_refused(monkeypatch, url):
    monkeypatch.setenv("MICROCOSMOS_PUBLIC_URL", url)
    with pytest.raises(SystemExit, match="`public_url` must be http:// or https:// and a host"):
        from_environment()


def test_the_sandbox_inherits_no_variable_that_may_be_a_secret(monkeypatch):
    secrets = "MICROCOSMOS_WEBHOOK_SECRET", "AWS_SECRET_ACCESS_KEY", "PGPASSWORD", "OTHER"
    for name in secrets:
        monkeypatch.setenv(name, "secret")
    sandbox = Sandbox()
    with closing(sandbox):
        sandbox.start()
        assert sandbox._process
        inherited, end = {}, time.monotonic() + 10
        while not inherited and time.monotonic() < end:  # It has forked, and not begun yet.
            inherited = psutil.Process(sandbox._process.pid).environ()
    assert "PATH" in inherited
    assert not [name for name, value in inherited.items() if value == "secret"]
