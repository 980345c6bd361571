"""A receiver of the webhook's events."""

import json
from base64 import b64encode
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from threading import Thread

KEY = b"0123456789abcdef0123456789abcdef"
SECRET = f"whsec_{b64encode(KEY).decode()}"


class Receiver:
    """A real HTTP server that keeps what it is sent and gives the `answers`, then 204."""

    def __init__(self, answers=()):
        self.answers, self.got = list(answers), []

    def events(self):
        """Return the id and the content of each event in the order of arrival."""
        return [(headers["webhook-id"], json.loads(body)) for _, headers, body in self.got]

    @contextmanager
    def serve(self):
        receiver = self

        class Handler(BaseHTTPRequestHandler):
            def do_POST(self):
                body = self.rfile.read(int(self.headers["Content-Length"]))
                receiver.got.append((self.path, dict(self.headers), body))
                status, *place = receiver.answers.pop(0) if receiver.answers else (204,)
                self.send_response(status)
                for one in place:
                    self.send_header("Location", one)
                self.end_headers()

            def log_message(self, *_):
                pass

        server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        Thread(target=server.serve_forever, daemon=True).start()
        try:
            yield f"http://127.0.0.1:{server.server_port}"
        finally:
            server.shutdown()
            server.server_close()
