"""A relay that breaks connections off, and a server of another program."""

import socket
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any
from urllib.parse import urlsplit

ENDLESS = 1 << 60


class Relay:
    """Forwards bytes between clients and a server, and breaks connections off."""

    def __init__(self, address: str):
        parts = urlsplit(address)
        self.to = (parts.hostname, parts.port)
        self.allowance: list[int] = []
        """Bytes of an answer after which a connection breaks, for one after another."""
        self.asked: list[bytes] = []
        self.going = threading.Event()
        """While it is clear, nothing is forwarded and nothing breaks, as by a frozen server."""
        self.going.set()
        self.open: list[socket.socket] = []
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.url = f"http://127.0.0.1:{self.listener.getsockname()[1]}"
        start(self.serve)

    def serve(self) -> None:
        with suppress(OSError):
            while True:
                client, _ = self.listener.accept()
                server = socket.create_connection(self.to)
                self.open += [client, server]
                start(forward, client, server, ENDLESS, self.asked, self.going)
                allowance = (self.allowance or [ENDLESS]).pop(0)
                start(forward, server, client, allowance, [], self.going)

    def cut(self) -> None:
        for each in self.open:
            hang_up(each)

    def close(self) -> None:
        self.listener.close()
        self.cut()
        for each in self.open:
            each.close()


def start(work: Callable[..., None], *arguments: Any) -> None:
    threading.Thread(target=work, args=arguments, daemon=True).start()


def forward(
    source: socket.socket,
    target: socket.socket,
    allowance: int,
    seen: list[bytes],
    going: threading.Event,
) -> None:
    with suppress(OSError):
        while allowance > 0 and (data := source.recv(65536)):
            going.wait()
            seen.append(data)
            target.sendall(data[:allowance])
            allowance -= len(data)
    hang_up(source)
    hang_up(target)


def hang_up(end: socket.socket) -> None:
    with suppress(OSError):
        end.shutdown(socket.SHUT_RDWR)


@contextmanager
def foreign_server(
    *answers: tuple[int, dict[str, str], bytes],
) -> Iterator[tuple[str, list[str]]]:
    """A server of another program, with its answers in order, the last one repeated."""
    left, asked = list(answers), []

    class Handler(BaseHTTPRequestHandler):
        def answer(self) -> None:
            asked.append(self.command)
            self.rfile.read(int(self.headers.get("content-length") or 0))
            status, headers, body = left.pop(0) if len(left) > 1 else left[0]
            self.send_response(status)
            for name, value in {**headers, "Content-Length": str(len(body))}.items():
                self.send_header(name, value)
            self.end_headers()
            self.wfile.write(body)

        do_GET = do_POST = do_DELETE = answer

        def log_message(self, *_: object) -> None: ...

    with ThreadingHTTPServer(("127.0.0.1", 0), Handler) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        try:
            yield f"http://127.0.0.1:{server.server_port}", asked
        finally:
            server.shutdown()
            thread.join()
