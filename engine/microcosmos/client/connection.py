"""Requests to a server, again where that is safe and may help."""

import random
import time
import weakref
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from email.utils import parsedate_to_datetime
from typing import Any
from urllib.parse import urlsplit

import httpx

from ..version import VERSION
from . import errors, jsonable

API = "/api/v1/"
LOOPBACK = ("127.0.0.1", "localhost", "::1")
IDEMPOTENT = ("GET", "HEAD", "PUT", "PATCH", "DELETE")
BUSY = (429, 502, 503, 504)
LONGEST_PAUSE = 8.0
FIRST_TRIES = 2
"""Where nobody has ever answered, more of them would only keep a person waiting."""


class Connection:
    """One server, and whoever speaks to it.

    For `patience` seconds, a request is made again that did not arrive, or that can be
    answered twice without harm.
    """

    def __init__(
        self,
        url: str,
        token: str | None = None,
        patience: float = 30.0,
        transport: httpx.BaseTransport | None = None,
    ):
        self.url, self.patience = normal(url), patience
        self.answered = False
        headers = {"User-Agent": f"microcosmos/{VERSION}", "Accept": "*/*"}
        if token:
            headers["Authorization"] = f"Bearer {token}"
        self.http = httpx.Client(
            base_url=self.url,
            headers=headers,
            timeout=httpx.Timeout(60.0, connect=5.0),
            transport=transport,
            # A proxy that the environment names does not know this machine's own addresses.
            trust_env=urlsplit(self.url).hostname not in LOOPBACK,
        )
        weakref.finalize(self, self.http.close)  # People write `Client(url).submit(spec)`.

    def read(self, path: str, **params: Any) -> Any:
        """The JSON that is at a path."""
        return self.json(self.ask("GET", path, params=params))

    def send(
        self,
        method: str,
        path: str,
        document: Any = None,
        *,
        key: str | None = None,
        **params: Any,
    ) -> Any:
        """What a change comes to; `key` names it, so that it is made once."""
        body: dict[str, Any] = {}
        if document is not None:
            kind = {"Content-Type": "application/json"}
            body = {"headers": kind, "content": jsonable.dumps(document)}
        return self.json(self.ask(method, path, key=key, params=params, **body))

    def json(self, answer: httpx.Response) -> Any:
        try:
            return answer.json() if answer.content else None
        except ValueError:
            kind = answer.headers.get("content-type", "")
            raise errors.stranger(answer, self.url, kind) from None

    def ask(
        self,
        method: str,
        path: str,
        *,
        key: str | None = None,
        headers: Mapping[str, str] | None = None,
        **options: Any,
    ) -> httpx.Response:
        """An answer that is no error, else `ServerError`."""
        request = self.request(method, path, key=key, headers=headers, **options)
        return errors.checked(self._patiently(request, key is not None), self.url)

    @contextmanager
    def stream(
        self, path: str, *, headers: Mapping[str, str] | None = None, **options: Any
    ) -> Iterator[httpx.Response]:
        """An answer whose body is read as it comes."""
        request = self.request("GET", path, headers=headers, **options)
        answer = self._patiently(request, stream=True)
        try:
            yield errors.checked(answer, self.url)
        finally:
            answer.close()

    def request(
        self,
        method: str,
        path: str,
        *,
        key: str | None = None,
        headers: Mapping[str, str] | None = None,
        params: Mapping[str, Any] | None = None,
        **options: Any,
    ) -> httpx.Request:
        """Below the API, or from the root where the path begins with a slash."""
        headers = dict(headers or {}) | ({"Idempotency-Key": key} if key else {})
        given = {name: value for name, value in (params or {}).items() if value is not None}
        path = path if path.startswith("/") else API + path
        return self.http.build_request(method, path, params=given, headers=headers, **options)

    def close(self) -> None:
        self.http.close()

    def _patiently(
        self, request: httpx.Request, named: bool = False, stream: bool = False
    ) -> httpx.Response:
        twice = named or request.method in IDEMPOTENT
        waited, attempt = 0.0, 0
        while True:
            begun = time.monotonic()
            answer, failure = self._once(request, stream)
            waited += time.monotonic() - begun
            pause = self._pause(answer, failure, twice, attempt)
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

    def _once(
        self, request: httpx.Request, stream: bool
    ) -> tuple[httpx.Response | None, httpx.TransportError | None]:
        try:
            answer = self.http.send(request, stream=stream)
        except httpx.TransportError as error:
            return None, error
        self.answered = True
        return answer, None

    def _pause(
        self,
        answer: httpx.Response | None,
        failure: httpx.TransportError | None,
        twice: bool,
        attempt: int,
    ) -> float | None:
        """Seconds until it is worth trying again; None where it is not, or could do harm."""
        usual = min(LONGEST_PAUSE, 0.25 * 2**attempt) * random.uniform(0.5, 1.0)
        if answer is not None:
            again = answer.status_code == 429 or (answer.status_code in BUSY and twice)
            return (_told(answer) or usual) if again else None
        if not self.answered and attempt >= FIRST_TRIES:
            return None
        arrived = not isinstance(failure, httpx.ConnectError | httpx.ConnectTimeout)
        return usual if twice or not arrived else None


def _told(answer: httpx.Response) -> float | None:
    """Seconds that the server asks to wait."""
    told = answer.headers.get("retry-after", "")
    if told.isdigit():
        return float(told)
    try:
        return max(0.0, parsedate_to_datetime(told).timestamp() - time.time())
    except ValueError:
        return None


def normal(url: str) -> str:
    """The address of a server as people write it: with a scheme, without a path of the API."""
    whole = url.strip() if "://" in url else f"http://{url.strip()}"
    try:
        parts = urlsplit(whole)
        sound = parts.scheme in ("http", "https") and bool(parts.hostname) and parts.port != 0
    except ValueError:
        sound = False
    if not sound:
        raise ValueError(f"`url` must be an address like http://127.0.0.1:8000, got {url!r}")
    return whole.partition("?")[0].rstrip("/").removesuffix(API.rstrip("/")).rstrip("/")
