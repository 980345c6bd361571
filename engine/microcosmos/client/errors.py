"""Errors of a server, as sentences."""

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import httpx

PROBLEM = "application/problem+json"
TOKEN = "Give one with --token, MICROCOSMOS_TOKEN, or Client(url, token)."


class ServerError(Exception):
    """A failed request: the HTTP `status`, and `errors` with a `field` and a `reason` each."""

    def __init__(
        self, message: str, status: int | None = None, errors: Sequence[Mapping[str, Any]] = ()
    ):
        super().__init__(message)
        self.status, self.errors = status, list(errors)

    @property
    def field(self) -> str | None:
        """Return the first wrong field; None if the error is about no field."""
        return self.errors[0]["field"] if self.errors else None

    @property
    def reason(self) -> str | None:
        """Return what is wrong with that field."""
        return self.errors[0]["reason"] if self.errors else None


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
    """An object of an answer. Reading a field that it lacks raises `NotMicrocosmos`."""

    url: str

    def __missing__(self, name: str) -> Any:
        raise not_ours(self.url, f"without the field `{name}`")


Kinds = Mapping[str, tuple[type, ...]]
"""Types of fields by name."""
NUMBER = (int, float)
UNKNOWN = (int, float, type(None))
RUN: Kinds = {
    **dict.fromkeys(("id", "experiment", "status"), (str,)),
    "name": (str, type(None)),
    "spec": (dict,),
    "summary": (dict, type(None)),
    **dict.fromkeys(("progress", "generation", "generations"), NUMBER),
    **dict.fromkeys(("qd_score", "coverage", "best"), UNKNOWN),
    **dict.fromkeys(("eta_seconds", "evaluations_per_second"), UNKNOWN),
}
SWEEP: Kinds = {
    "id": (str,),
    "name": (str, type(None)),
    "status_counts": (dict,),
    "total": NUMBER,
}
"""Fields that the client computes with or prints."""
NAMING = re.compile(r"\w[\w.-]*")
NAMES = ("id", "experiment", "run")
"""Fields that name files or paths: a foreign server must not choose their folder."""


def record(content: Any, url: str, kinds: Kinds | None = None) -> Answer:
    """Return an object of an answer; raise `NotMicrocosmos` for anything else, and for a field
    of another type."""
    if not isinstance(content, Mapping):
        raise not_ours(url, f"with {content!r:.40} in place of a record")
    for name, types in (kinds or {}).items():
        if name not in content:
            continue
        fits = isinstance(content[name], types)
        if fits and name in NAMES and isinstance(content[name], str):
            fits = NAMING.fullmatch(content[name]) is not None
        if not fits:
            raise not_ours(url, f"with {content[name]!r:.40} as the field `{name}`")
    answer = Answer(content)
    answer.url = url
    return answer


def records(content: Any, url: str) -> list[Answer]:
    """Return a list of objects of an answer; raise `NotMicrocosmos` for anything else."""
    if not isinstance(content, list):
        raise not_ours(url, f"with {content!r:.40} in place of a list")
    return [record(one, url) for one in content]


def not_ours(url: str, answer: str) -> NotMicrocosmos:
    text = "as no Microcosmos server of this version does: is the address right?"
    return NotMicrocosmos(f"{url} answers {answer}, {text}")


def undecodable(url: str) -> NotMicrocosmos:
    """Return the error for an answer that is not compressed as its header says."""
    return not_ours(url, "with bytes that are not in the encoding they are said to be in")


def checked(answer: httpx.Response, url: str) -> httpx.Response:
    """Return a successful answer of a Microcosmos server, else raise its error."""
    kind = answer.headers.get("content-type", "").partition(";")[0].strip()
    # A web page in place of JSON is a log-in, or another program
    # (test_a_foreign_server_is_recognised).
    if (answer.is_success or answer.status_code == 304) and kind != "text/html":
        return answer
    answer.read()
    if kind != PROBLEM:
        raise foreign_answer(answer, url, kind)
    raise from_problem(answer)


def from_problem(answer: httpx.Response) -> ServerError:
    """Return the error that a problem document describes."""
    try:
        problem = answer.json()
        errors = problem.get("errors") or []
        message = sentence(str(problem["detail"]), errors)
    # The problem document may come from another version, or from a proxy.
    except (ValueError, AttributeError, KeyError, TypeError, RecursionError):
        message, errors = f"The server answered {answer.status_code} without a reason.", []
    if answer.status_code == 401:
        message = f"{message} {TOKEN}"
    usual = Refused if answer.status_code < 500 else ServerError
    return KINDS.get(answer.status_code, usual)(message, answer.status_code, errors)


def sentence(detail: str, errors: Sequence[Mapping[str, Any]]) -> str:
    """Name the problem and every wrong field in one sentence."""
    text = detail.strip()
    for error in errors:
        if str(error["reason"]) not in text:
            text = f"{text.rstrip('.')}; {error['field']}: {error['reason']}"
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


def _causes(error: BaseException | None) -> Iterator[BaseException]:
    while error is not None:
        yield error
        error = error.__cause__ or error.__context__


def unreachable(error: httpx.TransportError, url: str) -> NoAnswer:
    """Explain why no answer came."""
    if isinstance(error, httpx.ConnectTimeout | httpx.ReadTimeout | httpx.PoolTimeout):
        return NoAnswer(f"The server at {url} did not answer in time; it may be overloaded.")
    if isinstance(error, httpx.ConnectError):
        refused = any(isinstance(one, ConnectionRefusedError) for one in _causes(error))
        reason = "" if refused or not str(error) else f" ({error})"
        return NoAnswer(
            f"No server answers at {url}{reason}: start one with `make run`, or name another "
            "with --url or MICROCOSMOS_URL."
        )
    return NoAnswer(f"The connection to {url} broke off ({error or type(error).__name__}).")
