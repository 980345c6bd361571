"""Specs that people send: what is of users' own in them has to be known."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

from microcosmos import spec as words
from microcosmos.spec import PluginUse, Spec, plugins_in

from ..core.errors import ProblemError
from ..core.schemas import FieldError
from ..services.services import Services
from ..workers.plugins import HELP, Reported, reported

Parse = Callable[[Mapping[str, Any]], Spec]


def parse(services: Services, document: Mapping[str, Any]) -> Spec:
    """The spec in a document; what is of users' own in it has to be known.

    Raises `ValidationError` or `ProblemError`.
    """
    with parsing(services) as parse_one:
        return parse_one(document)


@contextmanager
def parsing(services: Services) -> Iterator[Parse]:
    """The same for any number of documents, workers being asked once."""
    with services.sessions.read() as session:
        known = reported(services, session)
        yield lambda document: _parse(known, document)


def _parse(known: Reported, document: Mapping[str, Any]) -> Spec:
    spec = words.parse(document, known)
    complete = spec.model_dump(mode="json")
    unknown = [one for one in plugins_in(complete) if not _knows(known, one)]
    if unknown:
        errors = [_unknown(known, one) for one in unknown]
        detail = "; ".join(f"{error.field}: {error.message}" for error in errors)
        raise ProblemError(422, "Unknown version", detail, errors)
    return spec


def _knows(known: Reported, one: PluginUse) -> bool:
    return any((one.name, one.version.source) == (d.name, d.source) for d in known.known)


def _unknown(known: Reported, one: PluginUse) -> FieldError:
    there = sorted({d.source[:12] for d in known.known if d.name == one.name})
    have = f"workers have {', '.join(there)}" if there else HELP
    message = f"no worker has {one.name!r} in version {one.version.source[:12]}; {have}"
    return FieldError(field=one.path, message=message, got=one.version.source)
