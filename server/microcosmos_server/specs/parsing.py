"""Parse specs: of requests, whose plug-ins must be known, and of stored runs."""

import json
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from functools import lru_cache
from typing import Annotated, Any

from fastapi import Body, Depends
from sqlalchemy.orm import Session

from microcosmos import spec as specs
from microcosmos.spec import (
    EXPERIMENTS,
    Estimate,
    Evolution,
    PluginUse,
    Spec,
    estimate,
    plugins_in,
)

from ..core.errors import FieldError, Invalid
from ..services.services import Services, ServicesDep
from .known_plugins import INSTALL_HINT, KnownPlugins
from .schemas import SpecDocument

SEARCHES = tuple(name for name, one in EXPERIMENTS.items() if issubclass(one.spec, Evolution))
"""Experiments whose result is an archive, and that can start from creatures."""
Parse = Callable[[Mapping[str, Any]], Spec]


def parse(services: Services, document: Mapping[str, Any]) -> Spec:
    """Return the spec of a document; raise `ValidationError` or `DomainError`."""
    with parsing(services) as parse_one:
        return parse_one(document)


@contextmanager
def parsing(services: Services, session: Session | None = None) -> Iterator[Parse]:
    """Yield a parser for any number of documents, which reads the plug-ins once.

    Give it the session of the caller, if that has one: a request holds one connection.
    """
    with nullcontext(session) if session else services.sessions.read() as reading:
        known = KnownPlugins(services, reading)
        yield lambda document: _parse(known, document)


def _parse(plugins: KnownPlugins, document: Mapping[str, Any]) -> Spec:
    spec = specs.parse(document, plugins)
    known = {(one.name, one.source) for one in plugins.known}
    used = plugins_in(spec.model_dump(mode="json"))
    if unknown := [one for one in used if (one.name, one.version.source) not in known]:
        errors = [_unknown(plugins, one) for one in unknown]
        detail = "; ".join(f"{error.field}: {error.reason}" for error in errors)
        raise Invalid(detail, errors, title="Unknown version")
    return spec


def _unknown(plugins: KnownPlugins, one: PluginUse) -> FieldError:
    versions = sorted({d.source[:12] for d in plugins.known if d.name == one.name})
    have = f"workers have {', '.join(versions)}" if versions else INSTALL_HINT
    reason = f"no worker has {one.name!r} in version {one.version.source[:12]}; {have}"
    return FieldError(field=one.path, reason=reason, got=one.version.source)


@dataclass(frozen=True)
class ParsedSpec:
    spec: Spec
    estimate: Estimate


def parse_stored(document: dict[str, Any]) -> ParsedSpec | None:
    """Return the spec and estimate of a stored run; None if this version cannot read it."""
    text = json.dumps(document, sort_keys=True)
    return _kept(text) if len(text) <= KEPT_LENGTH else _parsed(text)


KEPT_LENGTH = 20_000
"""Longest spec, as JSON, that is kept: a usual one has 5,000 characters."""


@lru_cache(maxsize=1024)
def _kept(text: str) -> ParsedSpec | None:
    return _parsed(text)


def _parsed(text: str) -> ParsedSpec | None:
    try:
        spec = specs.parse(json.loads(text))
        return ParsedSpec(spec, estimate(spec))
    except ValueError:
        return None


SPEC_BYTES = 1 << 20
"""The largest body of a request that contains a spec."""


def spec_sent(document: Annotated[SpecDocument, Body()], services: ServicesDep) -> Spec:
    return parse(services, document)


SpecDep = Annotated[Spec, Depends(spec_sent)]
