"""Answer requests for renderings: send the file, or enqueue it; their wire types."""

from typing import Literal

from fastapi import Request
from fastapi.responses import JSONResponse, Response

from ..core.api import Answers, named
from ..core.schemas import Wire
from ..queue.jobs import KINDS
from ..services.services import Services
from ..storage import ranges
from ..tables import Artifact
from . import storage


class Rendering(Wire):
    status: Literal["rendering"] = "rendering"


class Verdict(Wire):
    """The verdict of a creature's audit."""

    trusted: bool | None
    """Null without an audit."""


class Comparison(Wire):
    """A recorded figure and the same one measured here; None if it is not finite."""

    name: str
    recorded: float
    measured: float | None


class Measurement(Wire):
    """The result of evaluating a creature again with the program that measured it."""

    creature: str
    exact: bool
    """The fitness and every recorded measure are the same to the bit."""
    device: str
    recorded_device: str
    fitness: Comparison
    figures: list[Comparison]
    """Figures that differ, the largest relative difference first."""
    missing: list[str]
    """Measures that the evaluation has and the creature's record lacks."""


PENDING: Answers = {202: {"model": Rendering}}


def existing(request: Request, sha: str, services: Services, kind: str) -> Response | None:
    """Return the answer with a rendering, or None if it does not exist."""
    headers: dict[str, str] = {}
    if "." in kind:  # A file for people.
        headers = named(f"creature-{sha[:12]}.{kind.rpartition('.')[2]}", "inline")

    def send(artifact: Artifact) -> Response:
        media_type = KINDS[kind].media_type
        return ranges.file(request, services.artifacts, artifact, headers, media_type)

    return storage.read(services, sha, kind, send)


def enqueued(services: Services, sha: str, kind: str, *, anonymous: bool = False) -> Response:
    """Enqueue a rendering and return 202; raise `RenderingFailed` if the last try failed."""
    storage.enqueue(services, sha, kind, anonymous=anonymous)
    return JSONResponse(Rendering().model_dump(), 202, {"Retry-After": "1"})
