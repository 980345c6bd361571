"""Plug-ins as workers report them: the server knows declarations and never imports code."""

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

from jsonschema import Draft202012Validator
from referencing import Registry
from referencing.exceptions import Unresolvable
from sqlalchemy import select
from sqlalchemy.orm import Session

from microcosmos.plugins import Declaration
from microcosmos.spec import plugins_in

from ..services.services import Services
from ..tables import Plugin, Worker
from . import registry

INSTALL_HINT = "install it on one: docs/plugins.md"


class KnownPlugins:
    """The plug-ins of live workers, and those that earlier workers had."""

    def __init__(self, services: Services, session: Session):
        self._session, self._lease = session, services.settings.lease

    @cached_property
    def alive(self) -> list[Worker]:
        return registry.live(self._session, self._lease)

    @cached_property
    def known(self) -> list[Declaration]:
        """Every known version: those of live workers first, then the newest first."""
        rows = self._session.scalars(select(Plugin).order_by(Plugin.seen_at.desc())).all()
        found = [Declaration.model_validate(row.declaration) for row in rows]
        return sorted(found, key=lambda one: not self.workers_with(one.source))

    def workers_with(self, source: str) -> list[str]:
        return [one.name for one in self.alive if source in versions_of(one)]

    def offered(self) -> list[Declaration]:
        """Return the default version of each plug-in, if a live worker offers it."""
        first = {(one.kind, one.name): one for one in reversed(self.known)}
        return sorted(
            (one for one in first.values() if self.workers_with(one.source)),
            key=lambda one: (one.kind, one.name),
        )

    def versions(self, kind: str, name: str) -> Sequence[Declaration]:
        return [one for one in self.known if (one.kind, one.name) == (kind, name)]

    def settings(self, declared: Declaration, given: Mapping[str, Any]) -> dict[str, Any]:
        """Return settings with defaults; raise `ValueError` if the schema refuses them."""
        if declared.settings is None:
            if given:
                raise ValueError(f"`plugin.settings` must be empty for {declared.name}")
            return {}
        whole = {**declared.defaults, **given}
        # Without a registry the validator would fetch the documents that a schema refers to.
        validator = Draft202012Validator(declared.settings, registry=Registry())
        try:
            error = next(validator.iter_errors(whole), None)
        except Unresolvable as wrong:
            needed = f"`plugin.settings` of {declared.name} refer to {wrong}"
            raise ValueError(needed) from wrong
        if error:
            place = ".".join(map(str, ("plugin.settings", *error.absolute_path)))
            raise ValueError(f"`{place}` must be as {declared.name} has it: {error.message}")
        return whole

    def explain_unknown(self, kind: str, name: str) -> str:
        offered = [
            f"{one.name} on {', '.join(self.workers_with(one.source))}"
            for one in self.offered()
            if one.kind == kind
        ]
        have = f"; workers have {', '.join(offered)}" if offered else ""
        return f"no worker has {name!r} as a {kind}{have}; {INSTALL_HINT}"


def needed_versions(document: Any) -> list[str] | None:
    """Return the versions that a worker must have for a spec; None if there are none."""
    return sorted({one.version.source for one in plugins_in(document)}) or None


def versions_of(worker: Worker) -> set[str]:
    return {one["source"] for one in worker.plugins}


def has_versions(worker: Worker | None, needed: Sequence[str] | None) -> bool:
    """Return whether a worker has all versions that a run needs."""
    return not needed or (worker is not None and set(needed) <= versions_of(worker))


def explain_missing(alive: Sequence[Worker], document: Any) -> str:
    """Return a sentence about a run that none of the live workers can compute."""
    absent = {
        one.name: one.version.source
        for one in plugins_in(document)
        if not any(one.version.source in versions_of(worker) for worker in alive)
    }
    if not absent:
        return "Waits for a worker that has all of its plug-ins; none has them together."
    names = ", ".join(f"{name} (version {source[:12]})" for name, source in absent.items())
    others = sorted(
        {
            worker.name
            for worker in alive
            for one in worker.plugins
            if one["name"] in absent and one["source"] != absent[one["name"]]
        }
    )
    have = f"; {', '.join(others)} has another version" if others else ""
    return f"Waits for a worker that has {names}: no live worker does{have}."
