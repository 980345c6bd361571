"""Requests to a server, repeated where that is safe and may help."""

import json
import random
import time
import weakref
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from email.utils import parsedate_to_datetime
from typing import Any
from urllib.parse import urlsplit

import httpx
import numpy as np

from ..version import VERSION
from . import errors

API = "/api/v1/"
LOOPBACK = ("127.0.0.1", "localhost", "::1")
IDEMPOTENT = ("GET", "HEAD", "PUT", "PATCH", "DELETE")
BUSY = (429, 502, 503, 504)
LONGEST_PAUSE = 8.0
FIRST_TRIES = 2
"""Tries while no server has answered yet; more would only delay the error."""


class Connection:
    """A server, with a token.

    For `patience` seconds, a request is repeated that did not arrive, or that can be answered
    twice without harm.
    """

    def __init__(
        self,
        url: str,
        token: str | None = None,
        patience: float = 30.0,
        transport: httpx.BaseTransport | None = None,
    ):
        self.url, self.patience = normal_url(url), patience
        self.answered = False
        headers = {"User-Agent": f"microcosmos/{VERSION}", "Accept": "*/*"}
        if token:
            headers["Authorization"] = f"Bearer {token}"
        self.http = httpx.Client(
            base_url=self.url,
            headers=headers,
            timeout=httpx.Timeout(60.0, connect=5.0),
            transport=transport,
            # A proxy that the environment names cannot reach this machine's own addresses.
            trust_env=urlsplit(self.url).hostname not in LOOPBACK,
        )
        weakref.finalize(self, self.http.close)  # People write `Client(url).submit(spec)`.

    def read(self, path: str, **params: Any) -> Any:
        return self.json(self.ask("GET", path, params=params))

    def items(self, path: str, **params: Any) -> Iterator[dict[str, Any]]:
        """Yield all entries of a list; request each page when it is needed."""
        page = self.read(path, **params)
        while isinstance(page, dict):
            yield from errors.records(page["items"], self.url)
            if not (cursor := page.get("next")):
                return
            page = self.read(path, **params, cursor=cursor)
        yield from errors.records(page, self.url)

    def rendering(self, path: str, timeout: float = 300.0) -> bytes:
        """Return a replay, picture or film, once the server has made it."""
        deadline = time.monotonic() + timeout
        while (answer := self.ask("GET", path)).status_code == 202:
            pause = float(answer.headers.get("retry-after", 1))
            if time.monotonic() + pause > deadline:
                raise errors.ServerError(
                    f"{path} was not made within {timeout:.0f} s; is a renderer running? "
                    "`make run` starts one."
                )
            time.sleep(pause)
        return answer.content

    def send(
        self,
        method: str,
        path: str,
        document: Any = None,
        *,
        key: str | None = None,
        **params: Any,
    ) -> Any:
        """Make a change and return its result; a `key` ensures that it is made once.

        Raise `ValueError` for NaN and infinities, `TypeError` for what JSON cannot express.
        """
        body: dict[str, Any] = {}
        if document is not None:
            content = json.dumps(document, default=_plain, allow_nan=False).encode()
            body = {"headers": {"Content-Type": "application/json"}, "content": content}
        return self.json(self.ask(method, path, key=key, params=params, **body))

    def json(self, answer: httpx.Response) -> Any:
        """Return the content of an answer; an object names itself where it lacks a field."""
        try:
            found = answer.json() if answer.content else None
        except ValueError:
            kind = answer.headers.get("content-type", "")
            raise errors.foreign_answer(answer, self.url, kind) from None
        return errors.record(found, self.url) if isinstance(found, dict) else found

    def ask(self, method: str, path: str, **options: Any) -> httpx.Response:
        """Return a successful answer, else raise `ServerError`."""
        return errors.checked(self._answer(method, path, **options), self.url)

    @contextmanager
    def stream(self, path: str, **options: Any) -> Iterator[httpx.Response]:
        """Yield an answer whose body is read as it arrives."""
        answer = self._answer("GET", path, stream=True, **options)
        try:
            yield errors.checked(answer, self.url)
        finally:
            answer.close()

    def close(self) -> None:
        self.http.close()

    def _answer(
        self,
        method: str,
        path: str,
        *,
        key: str | None = None,
        headers: Mapping[str, str] | None = None,
        params: Mapping[str, Any] | None = None,
        stream: bool = False,
        **options: Any,
    ) -> httpx.Response:
        """Send a request below the API, or from the root if the path begins with a slash."""
        request = self.http.build_request(
            method,
            path if path.startswith("/") else API + path,
            params={name: value for name, value in (params or {}).items() if value is not None},
            headers=dict(headers or {}) | ({"Idempotency-Key": key} if key else {}),
            **options,
        )
        repeatable = key is not None or method in IDEMPOTENT
        waited, attempt = 0.0, 0
        while True:
            start, answer, failure = time.monotonic(), None, None
            try:
                answer = self.http.send(request, stream=stream)
                self.answered = True
            except httpx.TransportError as error:
                failure = error
            waited += time.monotonic() - start
            pause = self._pause(answer, failure, repeatable, attempt)
            if pause is None or waited + pause > self.patience:
                break
            if answer:
                answer.close()
            time.sleep(pause)
            waited, attempt = waited + pause, attempt + 1
        if failure:
            raise errors.unreachable(failure, self.url) from failure
        assert answer is not None
        return answer

    def _pause(
        self,
        answer: httpx.Response | None,
        failure: httpx.TransportError | None,
        repeatable: bool,
        attempt: int,
    ) -> float | None:
        """Return seconds until the next try; None if it is useless or could do harm."""
        usual = min(LONGEST_PAUSE, 0.25 * 2**attempt) * random.uniform(0.5, 1.0)
        if answer is not None:
            busy = answer.status_code == 429 or (answer.status_code in BUSY and repeatable)
            return (_retry_after(answer) or usual) if busy else None
        if not self.answered and attempt >= FIRST_TRIES:
            return None
        arrived = not isinstance(failure, httpx.ConnectError | httpx.ConnectTimeout)
        return usual if repeatable or not arrived else None


def _retry_after(answer: httpx.Response) -> float | None:
    text = answer.headers.get("retry-after", "")
    if text.isdigit():
        return float(text)
    try:
        return max(0.0, parsedate_to_datetime(text).timestamp() - time.time())
    except ValueError:
        return None


def _plain(value: Any) -> Any:
    if isinstance(value, np.generic | np.ndarray):
        return value.tolist()
    raise TypeError(f"JSON cannot express {type(value).__name__}; got {value!r:.80}")


def normal_url(url: str) -> str:
    """Complete the address of a server: with a scheme, without the path of the API."""
    whole = url.strip() if "://" in url else f"http://{url.strip()}"
    try:
        parts = urlsplit(whole)
        valid = parts.scheme in ("http", "https") and bool(parts.hostname) and parts.port != 0
    except ValueError:
        valid = False
    if not valid:
        raise ValueError(f"`url` must be an address like http://127.0.0.1:8000, got {url!r}")
    return whole.partition("?")[0].rstrip("/").removesuffix(API.rstrip("/")).rstrip("/")
