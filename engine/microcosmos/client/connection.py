"""Requests to a server, repeated where that is safe and may help."""

import json
import math
import random
import re
import time
import weakref
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from email.utils import parsedate_to_datetime
from typing import Any
from urllib.parse import urlsplit

import httpx
import numpy as np

from ..invalid import InvalidField
from ..version import VERSION
from . import arguments, errors

API = "/api/v1/"
LOOPBACK = ("127.0.0.1", "localhost", "::1")
IDEMPOTENT = ("GET", "HEAD", "PUT", "PATCH", "DELETE")
BUSY = (429, 502, 503, 504)
PATIENCE = 30.0
SHORTEST_PAUSE, LONGEST_PAUSE = 0.25, 8.0
FIRST_TRIES = 2
"""Repetitions while no server has answered yet; more would only delay the error."""
TOKEN = re.compile("[!-~]+")
KEY = re.compile("[!-~]([ -~]*[!-~])?")
"""Texts that a header can carry (RFC 9110, section 5.5)."""


class Connection:
    """A server, with a token.

    Requests that did not arrive, and those that are safe to repeat, are repeated for `patience`
    seconds, 30 unless it is given; without it, a server that has never answered gets three
    tries.
    """

    def __init__(
        self,
        url: str,
        token: str | None = None,
        patience: float | None = None,
        transport: httpx.BaseTransport | None = None,
    ):
        self.url = normal_url(url)
        given = PATIENCE if patience is None else patience
        self.patience = arguments.seconds("patience", given)
        # Who names a patience waits for a server that has yet to start.
        self.awaited = patience is not None
        headers = {"User-Agent": f"microcosmos/{VERSION}", "Accept": "*/*"}
        if token:
            # The token is secret: errors of the library would show it.
            if not isinstance(token, str) or not TOKEN.fullmatch(token):
                needed = "must be ASCII letters, digits and signs, without spaces or ends of "
                raise InvalidField("token", f"{needed}lines; got others, which stay hidden")
            headers["Authorization"] = f"Bearer {token}"
        # A proxy that the environment names cannot reach this machine's own addresses.
        through_proxy = urlsplit(self.url).hostname not in LOOPBACK
        try:
            self.http = httpx.Client(
                base_url=self.url,
                headers=headers,
                # A busy server may take a minute to answer, an absent one is known in seconds.
                timeout=httpx.Timeout(60.0, connect=5.0),
                transport=transport,
                trust_env=through_proxy,
            )
        # The address itself was checked; that of a proxy may hold a password.
        except (httpx.InvalidURL, ValueError, ImportError):
            raise ValueError(
                "HTTP_PROXY, HTTPS_PROXY and ALL_PROXY must be addresses like "
                "http://proxy:3128, for socks5:// with httpx[socks], and NO_PROXY names of "
                "hosts, without brackets around IPv6; got another"
            ) from None
        weakref.finalize(self, self.http.close)  # People write `Client(url).submit(spec)`.

    def read(self, path: str, **params: Any) -> errors.Answer:
        """Return an object; raise `NotMicrocosmos` for anything else."""
        return errors.record(self.content(path, **params), self.url)

    def content(self, path: str, **params: Any) -> Any:
        return self.json(self.ask("GET", path, params=params))

    def items(self, path: str, **params: Any) -> Iterator[dict[str, Any]]:
        """Yield all entries of a list; request each page when it is needed."""
        page, cursors = self.content(path, **params), [""]
        while isinstance(page, dict):
            items = errors.records(page["items"], self.url)
            yield from items
            if not (cursor := page.get("next")):
                return
            cursors.append(cursor)
            # Pages of our server always hold something and lead on.
            if not items or cursor in cursors[:-1]:
                raise errors.not_ours(self.url, "with a list that does not end")
            page = self.content(path, **params, cursor=cursor)
        yield from errors.records(page, self.url)

    def rendering(self, path: str, timeout: float = 300.0) -> bytes:
        """Return a replay, picture or film, once the server has made it."""
        deadline = time.monotonic() + arguments.seconds("timeout", timeout)
        while (answer := self.ask("GET", path)).status_code == 202:
            pause = _retry_after(answer) or 1.0
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
    ) -> errors.Answer:
        """Make a change and return its record; a `key` ensures that it is made once.

        Raise `InvalidField` for what JSON cannot express, such as NaN.
        """
        body: dict[str, Any] = {}
        if document is not None:
            body = {
                "headers": {"Content-Type": "application/json"},
                "content": _written(document),
            }
        answer = self.ask(method, path, key=key, params=params, **body)
        return errors.record(self.json(answer) if answer.content else {}, self.url)

    def json(self, answer: httpx.Response) -> Any:
        """Return the content of an answer, as an `errors.Answer` if it is an object."""
        try:
            content = answer.json() if answer.content else None
        except (ValueError, RecursionError):
            kind = answer.headers.get("content-type", "")
            raise errors.foreign_answer(answer, self.url, kind) from None
        return errors.record(content, self.url) if isinstance(content, dict) else content

    def ask(self, method: str, path: str, **options: Any) -> httpx.Response:
        """Return a successful answer, else raise `ServerError`."""
        return errors.checked(self._answer(method, path, **options), self.url)

    @contextmanager
    def stream(self, path: str, **options: Any) -> Iterator[httpx.Response]:
        """Yield an answer whose body is read as it arrives."""
        answer = self._answer("GET", path, stream=True, **options)
        try:
            yield errors.checked(answer, self.url)
        except httpx.DecodingError as error:
            raise errors.undecodable(self.url) from error
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
        if key is not None and not (isinstance(key, str) and KEY.fullmatch(key)):
            raise InvalidField("key", f"must be ASCII letters, digits and signs; got {key!r}")
        for name, value in (params or {}).items():
            refuse_bytes(name, value)
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
                self.awaited = True
            except httpx.TransportError as error:
                failure = error
            except httpx.DecodingError as error:
                raise errors.undecodable(self.url) from error
            # Silence uses up patience too (test_patience_includes_the_length_of_silences).
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
        # The exponent ends: a float overflows after a thousand tries.
        usual = min(LONGEST_PAUSE, SHORTEST_PAUSE * 2.0 ** min(attempt, 10))
        usual *= random.uniform(0.5, 1.0)
        if answer is not None:
            # A request over the rate limit had no effect; one behind a broken proxy may have
            # had.
            busy = answer.status_code == 429 or (answer.status_code in BUSY and repeatable)
            return (_retry_after(answer) or usual) if busy else None
        if not self.awaited and attempt >= FIRST_TRIES:
            return None
        arrived = not isinstance(failure, httpx.ConnectError | httpx.ConnectTimeout)
        return usual if repeatable or not arrived else None


def _retry_after(answer: httpx.Response) -> float | None:
    # The header has seconds or a date (RFC 9110, section 10.2.3).
    text = answer.headers.get("retry-after", "")
    if text.isdecimal():
        return float(text)
    try:
        return max(0.0, parsedate_to_datetime(text).timestamp() - time.time())
    except (ValueError, OverflowError):  # A zone may be as long as it likes.
        return None


def _written(document: Any) -> bytes:
    """Return a document as JSON; raise `InvalidField` for a value that JSON does not have."""
    try:
        return json.dumps(document, default=_plain, allow_nan=False).encode()
    except RecursionError:
        raise ValueError("JSON must nest less deeply") from None
    except (TypeError, ValueError) as error:
        for path, leaf in _leaves(document):
            if isinstance(leaf, float) and not math.isfinite(leaf):
                raise InvalidField(path, f"must be a finite number; got {leaf}") from None
            if not isinstance(leaf, str | int | float | None):
                needed = "must be text, a number, a list or fields by name"
                raise InvalidField(path, f"{needed}; got {leaf!r:.80}") from None
        raise ValueError(f"a document must be JSON: {error}") from error


def _leaves(part: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the values of a document that have no parts, each with its dotted path."""
    if isinstance(part, np.generic | np.ndarray):
        part = part.tolist()
    if isinstance(part, dict):
        for name, one in part.items():
            yield from _leaves(one, f"{path}.{name}" if path else str(name))
    elif isinstance(part, list | tuple):
        for place, one in enumerate(part):
            yield from _leaves(one, f"{path}.{place}" if path else str(place))
    else:
        yield path, part


def refuse_bytes(field: str, value: Any) -> None:
    """Raise `InvalidField` for a text with bytes that are not UTF-8, as a shell may pass."""
    for text in value if isinstance(value, list) else [value]:
        try:
            str(text).encode()
        except UnicodeEncodeError:
            raise InvalidField(field, f"must be text in UTF-8; got {text!r}") from None


def _plain(value: Any) -> Any:
    # Grids of sweeps are often made by NumPy, whose numbers JSON does not know.
    if isinstance(value, np.generic | np.ndarray):
        return value.tolist()
    raise TypeError(f"JSON cannot express {type(value).__name__}; got {value!r:.80}")


def normal_url(url: str) -> str:
    """Complete the address of a server: with a scheme, without the path of the API."""
    whole = url.strip() if isinstance(url, str) else ""
    whole = whole if "://" in whole else f"http://{whole}"
    if "@" in re.split("[/?#]", re.sub(r"^(\w+:/*)+", "", whole), maxsplit=1)[0]:
        # Links and errors repeat the address, and the library would send no token.
        raise ValueError(
            "`url` must be an address without a user name or password; give a token instead"
        )
    try:
        parts = urlsplit(whole)
        valid = parts.scheme in ("http", "https") and bool(parts.hostname) and parts.port != 0
        # The library refuses more, and the system names with empty or long parts.
        _ = httpx.URL(whole), (parts.hostname or "").encode("idna")
    except (ValueError, httpx.InvalidURL):
        valid = False
    if not valid:
        got = "" if "@" in whole else f", got {url!r}"  # There may be a password.
        raise ValueError(f"`url` must be an address like http://127.0.0.1:8000{got}")
    # People paste the address of a page or of the API.
    return whole.partition("?")[0].rstrip("/").removesuffix(API.rstrip("/")).rstrip("/")
