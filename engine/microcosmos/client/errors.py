"""Errors of a server, as sentences."""

from collections.abc import Mapping, Sequence
from typing import Any

import httpx

PROBLEM = "application/problem+json"
TOKEN = "Give one with --token, MICROCOSMOS_TOKEN, or Client(url, token)."


class ServerError(Exception):
    """A failed request, with the HTTP `status` and the `errors` of fields."""

    def __init__(
        self, message: str, status: int | None = None, errors: Sequence[Mapping[str, Any]] = ()
    ):
        super().__init__(message)
        self.status, self.errors = status, list(errors)


class NoAnswer(ServerError):
    """No server answers at the address."""


class NotMicrocosmos(ServerError):
    """Another program answers at the address."""


class NotFound(ServerError):
    """No such thing exists."""


class NotAllowed(ServerError):
    """The request needs a token, or one with a wider scope."""


class Conflict(ServerError):
    """The state of a run does not allow the action."""


class Refused(ServerError):
    """The request is wrong."""


KINDS = {401: NotAllowed, 403: NotAllowed, 404: NotFound, 409: Conflict}


class Answer(dict[str, Any]):
    """An object that a server sent; `NotMicrocosmos` for a field that it lacks."""

    url: str

    def __missing__(self, name: str) -> Any:
        raise not_ours(self.url, f"without the field `{name}`")


def record(found: Any, url: str) -> Answer:
    """Return an object of an answer; raise `NotMicrocosmos` for anything else."""
    if not isinstance(found, Mapping):
        raise not_ours(url, f"with {found!r:.40} in place of a record")
    answer = Answer(found)
    answer.url = url
    return answer


def records(found: Any, url: str) -> list[Answer]:
    """Return a list of objects of an answer; raise `NotMicrocosmos` for anything else."""
    if not isinstance(found, list):
        raise not_ours(url, f"with {found!r:.40} in place of a list")
    return [record(one, url) for one in found]


def not_ours(url: str, answer: str) -> NotMicrocosmos:
    text = "as no Microcosmos server of this version does: is the address right?"
    return NotMicrocosmos(f"{url} answers {answer}, {text}")


def checked(answer: httpx.Response, url: str) -> httpx.Response:
    """Return a successful answer of a Microcosmos server, else raise its error."""
    kind = answer.headers.get("content-type", "").partition(";")[0].strip()
    if (answer.is_success or answer.status_code == 304) and kind != "text/html":
        return answer
    answer.read()
    if kind != PROBLEM:
        raise foreign_answer(answer, url, kind)
    raise of(answer)


def of(answer: httpx.Response) -> ServerError:
    """Return the error that a problem document describes."""
    try:
        problem = answer.json()
        errors = problem.get("errors") or []
        message = sentence(str(problem["detail"]), errors)
    except (ValueError, AttributeError, KeyError, TypeError):
        message, errors = f"The server answered {answer.status_code} without a reason.", []
    if answer.status_code == 401:
        message = f"{message} {TOKEN}"
    usual = Refused if answer.status_code < 500 else ServerError
    return KINDS.get(answer.status_code, usual)(message, answer.status_code, errors)


def sentence(detail: str, errors: Sequence[Mapping[str, Any]]) -> str:
    """Name the problem and every wrong field in one sentence."""
    text = detail.strip()
    for error in errors:
        if str(error["message"]) not in text:
            text = f"{text.rstrip('.')}; {error['field']}: {error['message']}"
    return text if text.endswith((".", "!", "?")) else f"{text}."


def foreign_answer(answer: httpx.Response, url: str, kind: str) -> ServerError:
    """Return the error for an answer that no Microcosmos server would give."""
    status = f"{answer.status_code} {answer.reason_phrase}".strip()
    if answer.status_code in (502, 503, 504):
        text = "the server behind it is down or starting. Try again in a moment."
        return NoAnswer(f"A proxy at {url} answers {status}: {text}", answer.status_code)
    if answer.is_redirect:
        where = answer.headers.get("location", "another address")
        text = f"{url} redirects to {where}: give the address that answers itself."
    else:
        content = "a web page" if kind == "text/html" else kind or "nothing"
        text = (
            f"{url} answers {status} with {content}, as no Microcosmos server does: is the "
            "address right, and is a proxy in between that wants a log-in?"
        )
    return NotMicrocosmos(text, answer.status_code)


def unreachable(error: httpx.TransportError, url: str) -> NoAnswer:
    """Explain why no answer came."""
    if isinstance(error, httpx.ConnectTimeout | httpx.ReadTimeout | httpx.PoolTimeout):
        return NoAnswer(f"The server at {url} did not answer in time; it may be overloaded.")
    if isinstance(error, httpx.ConnectError):
        text = str(error)
        reason = "" if not text or "refused" in text.lower() else f" ({text})"
        return NoAnswer(
            f"No server answers at {url}{reason}: start one with `make run`, or name another "
            "with --url or MICROCOSMOS_URL."
        )
    return NoAnswer(f"The connection to {url} broke off ({error or type(error).__name__}).")
