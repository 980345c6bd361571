"""A relay that breaks connections off, and a foreign server."""

import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from urllib.parse import urlsplit


class Relay:
    """Hands bytes on between a client and a server, and breaks connections off."""

    def __init__(self, address: str):
        parts = urlsplit(address)
        self.to = (parts.hostname, parts.port)
        self.allowance: list[int] = []
        """Bytes of an answer after which a connection breaks, for one after another."""
        self.asked: list[bytes] = []
        self.open: list[socket.socket] = []
        self.door = socket.create_server(("127.0.0.1", 0))
        self.url = f"http://127.0.0.1:{self.door.getsockname()[1]}"
        threading.Thread(target=self.serve, daemon=True).start()

    def serve(self) -> None:
        with suppress(OSError):
            while True:
                client, _ = self.door.accept()
                server = socket.create_connection(self.to)
                self.open += [client, server]
                left = self.allowance.pop(0) if self.allowance else None
                for work in (
                    (self.requests, client, server),
                    (self.answers, server, client, left),
                ):
                    threading.Thread(target=work[0], args=work[1:], daemon=True).start()

    def requests(self, client: socket.socket, server: socket.socket) -> None:
        with suppress(OSError):
            while sent := client.recv(65536):
                self.asked.append(sent)
                server.sendall(sent)

    def answers(self, server: socket.socket, client: socket.socket, left: int | None) -> None:
        with suppress(OSError):
            while came := server.recv(65536):
                client.sendall(came if left is None else came[:left])
                left = left if left is None else left - len(came)
                if left is not None and left <= 0:
                    break
        hang_up(client)
        hang_up(server)

    def cut(self) -> None:
        for each in self.open:
            hang_up(each)

    def close(self) -> None:
        self.door.close()
        self.cut()
        for each in self.open:
            each.close()


def hang_up(end: socket.socket) -> None:
    with suppress(OSError):
        end.shutdown(socket.SHUT_RDWR)


@contextmanager
def other(*answers: tuple[int, dict[str, str], bytes]) -> Iterator[tuple[str, list[str]]]:
    """A foreign server with these answers in order, the last one repeated."""
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

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    try:
        yield f"http://127.0.0.1:{server.server_port}", asked
    finally:
        server.shutdown()
        server.server_close()
        thread.join()
