"""A real S3 server as a process, and a proxy before it that can fail."""

import http.client
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from threading import Thread
from urllib.parse import urlsplit
from uuid import uuid4

from microcosmos_server.local.redis_embedded import free_port

BUCKET = "microcosmos"
CREDENTIALS = {
    "AWS_ACCESS_KEY_ID": "tester",
    "AWS_SECRET_ACCESS_KEY": "of-tests-alone",
    "AWS_DEFAULT_REGION": "us-east-1",
}


class Proxy(ThreadingHTTPServer):
    """Passes requests on to a server, or answers 503 to those whose path holds a text."""

    daemon_threads = True

    def __init__(self, server: str):
        super().__init__(("127.0.0.1", 0), _Handler)
        self.server = urlsplit(server).netloc
        self.failing: str | None = None
        """Requests whose path holds it fail; all with an empty text."""
        self.failures = 0
        """Number of the next requests that fail, whatever their path."""
        self.failed = 0
        """Number of requests that have failed."""

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.server_port}"

    def fails(self, path: str) -> bool:
        if self.failures:
            self.failures -= 1
            return True
        return self.failing is not None and self.failing in path


class _Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"

    def answer(self) -> None:
        body = self.rfile.read(int(self.headers.get("Content-Length", 0)))
        if self.server.fails(self.path):
            self.server.failed += 1
            self.send_response(503)
            self.send_header("Content-Length", "0")
            self.end_headers()
            return
        connection = http.client.HTTPConnection(self.server.server, timeout=20)
        connection.request(self.command, self.path, body, dict(self.headers))
        answer = connection.getresponse()
        content = answer.read()
        self.send_response(answer.status)
        for name, value in answer.getheaders():
            if name.lower() not in ("connection", "transfer-encoding", "date", "server"):
                self.send_header(name, value)
        self.end_headers()
        self.wfile.write(content)
        connection.close()

    do_GET = do_PUT = do_POST = do_DELETE = do_HEAD = answer

    def log_message(self, *_: object) -> None:
        """Say nothing."""


@contextmanager
def own_object_store() -> Iterator[Proxy]:
    """A new S3 server with one bucket, behind a proxy."""
    port = free_port()
    command = [sys.executable, "-m", "moto.server", "-H", "127.0.0.1", "-p", str(port)]
    process = subprocess.Popen(
        command,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env=os.environ | CREDENTIALS,
    )
    try:
        _create_bucket(port)
        with Proxy(f"http://127.0.0.1:{port}") as proxy:
            thread = Thread(target=proxy.serve_forever, kwargs={"poll_interval": 0.05})
            thread.start()
            yield proxy
            proxy.shutdown()
            thread.join()
    finally:
        process.kill()
        process.wait()


def _create_bucket(port: int) -> None:
    deadline = time.monotonic() + 60
    while True:
        try:
            connection = http.client.HTTPConnection("127.0.0.1", port, timeout=20)
            connection.request("PUT", f"/{BUCKET}")
            assert connection.getresponse().read() is not None
            connection.close()
            return
        except ConnectionRefusedError:
            assert time.monotonic() < deadline, "the S3 server did not start"
            time.sleep(0.1)


def new_prefix() -> str:
    return f"s3://{BUCKET}/{uuid4().hex[:12]}"
