"""Parse specs: of requests, whose plug-ins must be known, and of stored runs."""

import json
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from microcosmos import spec as specs
from microcosmos.spec import Estimate, PluginUse, Spec, estimate, plugins_in

from ..core.errors import FieldError, ProblemError
from ..services.services import Services
from ..workers.plugins import INSTALL_HINT, KnownPlugins

Parse = Callable[[Mapping[str, Any]], Spec]


def parse(services: Services, document: Mapping[str, Any]) -> Spec:
    """Return the spec of a document; raise `ValidationError` or `ProblemError`."""
    with parsing(services) as parse_one:
        return parse_one(document)


@contextmanager
def parsing(services: Services) -> Iterator[Parse]:
    """Yield a parser for any number of documents, which reads the plug-ins once."""
    with services.sessions.read() as session:
        known = KnownPlugins(services, session)
        yield lambda document: _parse(known, document)


def _parse(plugins: KnownPlugins, document: Mapping[str, Any]) -> Spec:
    spec = specs.parse(document, plugins)
    known = {(one.name, one.source) for one in plugins.known}
    used = plugins_in(spec.model_dump(mode="json"))
    if unknown := [one for one in used if (one.name, one.version.source) not in known]:
        errors = [_unknown(plugins, one) for one in unknown]
        detail = "; ".join(f"{error.field}: {error.message}" for error in errors)
        raise ProblemError(422, "Unknown version", detail, errors)
    return spec


def _unknown(plugins: KnownPlugins, one: PluginUse) -> FieldError:
    versions = sorted({d.source[:12] for d in plugins.known if d.name == one.name})
    have = f"workers have {', '.join(versions)}" if versions else INSTALL_HINT
    message = f"no worker has {one.name!r} in version {one.version.source[:12]}; {have}"
    return FieldError(field=one.path, message=message, got=one.version.source)


@dataclass(frozen=True)
class ParsedSpec:
    spec: Spec
    estimate: Estimate


def parse_stored(document: dict[str, Any]) -> ParsedSpec | None:
    """Return the spec and estimate of a stored run; None if this version cannot read it."""
    return _parsed(json.dumps(document, sort_keys=True))


@lru_cache(maxsize=1024)
def _parsed(text: str) -> ParsedSpec | None:
    try:
        spec = specs.parse(json.loads(text))
        return ParsedSpec(spec, estimate(spec))
    except ValueError:
        return None
