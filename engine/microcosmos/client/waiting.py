"""What a server makes when it is first asked for: replays, pictures, films."""

import time

import httpx

from .connection import Connection
from .errors import ServerError


def made(connection: Connection, path: str, timeout: float = 300.0) -> httpx.Response:
    """What is at a path, once it is made; `ServerError` where that takes too long."""
    deadline = time.monotonic() + timeout
    while True:
        answer = connection.ask("GET", path)
        if answer.status_code != 202:
            return answer
        pause = float(answer.headers.get("retry-after", 1))
        if time.monotonic() + pause > deadline:
            raise ServerError(
                f"{path} was not made within {timeout:.0f} s; is a renderer running? "
                "`make run` starts one."
            )
        time.sleep(pause)
