"""What workers have of users' own, as they report it: looked up by name, never imported."""

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

HELP = "install it on one: docs/plugins.md"


class Reported:
    """What live workers have, and what those had that are away; asked when first needed."""

    def __init__(self, session: Session, lease: float):
        self._session, self._lease = session, lease

    @cached_property
    def alive(self) -> list[Worker]:
        return registry.live(self._session, self._lease)

    @cached_property
    def known(self) -> list[Declaration]:
        """Those that live first, then the newest first."""
        rows = self._session.scalars(select(Plugin).order_by(Plugin.seen_at.desc())).all()
        found = [Declaration.model_validate(row.declaration) for row in rows]
        return sorted(found, key=lambda one: not self.having(one.source))

    def having(self, source: str) -> list[str]:
        """Names of the live workers that have a version."""
        return [one.name for one in self.alive if source in versions_of(one)]

    def offered(self) -> list[Declaration]:
        """Of each name the version that is taken where nobody says otherwise, if one lives."""
        first = {(one.kind, one.name): one for one in reversed(self.known)}
        return sorted(
            (one for one in first.values() if self.having(one.source)),
            key=lambda one: (one.kind, one.name),
        )

    def versions(self, kind: str, name: str) -> Sequence[Declaration]:
        return [one for one in self.known if (one.kind, one.name) == (kind, name)]

    def settings(self, declared: Declaration, given: Mapping[str, Any]) -> dict[str, Any]:
        if declared.settings is None:
            if given:
                raise ValueError(f"`plugin.settings` must be empty for {declared.name}")
            return {}
        whole = {**declared.defaults, **given}
        # Without a registry it would fetch what a schema refers to.
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
        there = [f"{one.name} on {self._on(one)}" for one in self.offered() if one.kind == kind]
        have = f"; workers have {', '.join(there)}" if there else ""
        return f"no worker has {name!r} as a {kind}{have}; {HELP}"

    def _on(self, one: Declaration) -> str:
        return ", ".join(self.having(one.source))


def reported(services: Services, session: Session) -> Reported:
    return Reported(session, services.settings.lease)


def needed_versions(document: Any) -> list[str] | None:
    """Versions that a worker must have for a spec; None where there are none."""
    return sorted({one.version.source for one in plugins_in(document)}) or None


def versions_of(worker: Worker) -> set[str]:
    return {one["source"] for one in worker.plugins}


def fit(worker: Worker | None, needed: Sequence[str] | None) -> bool:
    """Whether a worker has all versions that a run needs."""
    return not needed or (worker is not None and set(needed) <= versions_of(worker))


def missing(alive: Sequence[Worker], document: Any) -> str:
    """A sentence about a run that none of the live workers can carry out."""
    gone = {
        one.name: one.version.source
        for one in plugins_in(document)
        if not any(one.version.source in versions_of(worker) for worker in alive)
    }
    if not gone:
        return "Waits for a worker that has all of its own modules; none has them together."
    told = ", ".join(f"{name} (version {source[:12]})" for name, source in gone.items())
    others = sorted(
        {
            worker.name
            for worker in alive
            for one in worker.plugins
            if one["name"] in gone and one["source"] != gone[one["name"]]
        }
    )
    have = f"; {', '.join(others)} has another version" if others else ""
    return f"Waits for a worker that has {told}: none that is alive does{have}."
