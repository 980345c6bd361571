"""Plug-ins that specs may name, as workers report them: the server never imports their code."""

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

from jsonschema import Draft202012Validator
from referencing import Registry
from referencing.exceptions import Unresolvable
from sqlalchemy import select
from sqlalchemy.orm import Session

from microcosmos.invalid import InvalidField
from microcosmos.plugins import Declaration

from ..services.services import Services
from ..tables import Plugin, Worker
from ..workers import registry
from ..workers.plugins import versions_of

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
                raise InvalidField("plugin.settings", f"must be empty for {declared.name}")
            return {}
        whole = {**declared.defaults, **given}
        # Without a registry the validator would fetch the documents that a schema refers to.
        validator = Draft202012Validator(declared.settings, registry=Registry())
        try:
            error = next(validator.iter_errors(whole), None)
        except Unresolvable as wrong:
            reason = f"of {declared.name} refer to {wrong}"
            raise InvalidField("plugin.settings", reason) from wrong
        if error:
            place = ".".join(map(str, ("plugin.settings", *error.absolute_path)))
            raise InvalidField(place, f"must be as {declared.name} has it: {error.message}")
        return whole

    def explain_unknown(self, kind: str, name: str) -> str:
        offered = [
            f"{one.name} on {', '.join(self.workers_with(one.source))}"
            for one in self.offered()
            if one.kind == kind
        ]
        have = f"; workers have {', '.join(offered)}" if offered else ""
        return f"no worker has {name!r} as a {kind}{have}; {INSTALL_HINT}"
