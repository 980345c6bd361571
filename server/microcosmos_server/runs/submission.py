"""Create runs from specs: one, a fork, the demonstration, or all runs of a sweep."""

import json
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import timedelta
from hashlib import sha256
from typing import Annotated, Any
from uuid import UUID

from fastapi import Header, Response
from sqlalchemy import exists, select
from sqlalchemy.exc import IntegrityError
from sqlalchemy.orm import Session

from microcosmos.spec import Spec, estimate
from microcosmos.version import VERSION

from ..auth.principal import ADMIN, Principal
from ..core.database import now
from ..core.errors import FieldError, Forbidden, Gone, Invalid, TooMany
from ..creatures import initial
from ..schedule.take import refuse_too_many
from ..services.services import Services
from ..tables import URGENT, Idempotency, LogEntry, Run, Sweep
from ..workers import plugins, registry
from .announce import announced, current
from .schemas import RunRead, Scheduling

IdempotencyKey = Annotated[
    str | None, Header(alias="Idempotency-Key", min_length=1, max_length=255)
]

SEARCH_FIELDS = ("search.block", "search.batch", "archive")
MEMORY_FIELDS = {
    "quality-diversity": SEARCH_FIELDS,
    "neuroevolution": SEARCH_FIELDS,
    "folding": ("memory",),
    "refinement": ("segment",),
    "gaits": ("block",),
    "scaling": ("nodes",),
}
"""The fields of each experiment that may decide most about its memory."""
TOO_LARGE = "Not enough memory"


@dataclass(frozen=True)
class OneCellArchive:
    """The smallest archive, with the fields that an estimate reads."""

    places: int = 1
    plugins: dict[str, Any] = field(default_factory=dict)
    named: tuple[str, ...] = ()
    container: None = None


def memory_limit(services: Services, session: Session) -> int:
    """Return the bytes of the largest worker, else of this machine, or the setting if less."""
    live = registry.live(session, services.settings.lease)
    cap = services.settings.max_bytes
    if not live:
        return cap or os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    largest = max(worker.memory_bytes for worker in live)
    return min(largest, cap) if cap else largest


def refuse_urgent(principal: Principal, scheduling: Scheduling) -> None:
    """Raise `DomainError` unless the principal may put a run before those of others."""
    if scheduling.priority == URGENT and not principal.may(ADMIN):
        detail = "`priority` urgent needs a token of scope `admin`; others may set high."
        raise Forbidden(detail)


def refuse_too_large(services: Services, spec: Spec) -> None:
    """Raise `DomainError` if no worker has the memory."""
    with services.sessions.read() as session:
        limit = memory_limit(services, session)
    if error := too_large(spec, limit):
        raise Invalid(error.reason, [error], title=TOO_LARGE)


def too_large(spec: Spec, limit: int) -> FieldError | None:
    """Return the error of a spec that needs more than `limit` bytes."""
    needed = estimate(spec).memory_bytes
    if needed <= limit:
        return None
    detail = f"The run needs {needed:,} bytes of memory; {limit:,} bytes are available."
    return FieldError(
        field=largest_field(spec), reason=detail, needed=f"at most {limit} bytes", got=needed
    )


def largest_field(spec: Spec) -> str:
    """Return the field that would save the most memory at its least value."""
    fields = MEMORY_FIELDS[spec.experiment]
    if len(fields) == 1:
        return fields[0]
    return min(fields, key=lambda field: estimate(_least(spec, field)).memory_bytes)


def _least(spec: Any, field: str) -> Spec:
    part, _, name = field.partition(".")
    if not name:
        return spec.model_copy(update={part: OneCellArchive()})
    changed = getattr(spec, part).model_copy(update={name: 1})
    return spec.model_copy(update={part: changed})


@dataclass(frozen=True)
class IdempotentRequest:
    """A request that creates runs. With a key, the same one again creates nothing."""

    body: Any
    """All that makes the runs: what was sent in the body and in the query."""
    key: str | None = None
    owner: UUID | None = None

    @property
    def stored_key(self) -> str | None:
        """The key with its owner, since two owners may choose the same key."""
        if self.key is None or self.owner is None:
            return self.key
        return sha256(f"{self.owner} {self.key}".encode()).hexdigest()

    @property
    def digest(self) -> str:
        """The hash of the body as plain JSON; canonical JSON lacks large integers."""
        return sha256(json.dumps(self.body, sort_keys=True).encode()).hexdigest()

    def earlier(self, services: Services) -> Idempotency | None:
        """Return the record of the key.

        Raise `DomainError` if another request made it, or if its run was deleted.
        """
        with services.sessions.read() as session:
            known = session.get(Idempotency, self.stored_key) if self.key is not None else None
            if known is None:
                return None
            run = session.get(Run, known.run_id) if known.run_id else None
            mine = (Run.sweep == known.sweep, Run.deleted_at.is_(None))
            left = known.sweep and session.scalar(select(exists().where(*mine)))
        used = f"Idempotency-Key {self.key!r} was used"
        made = f"sweep {known.sweep}" if known.sweep else f"run {run.id}" if run else "a run"
        if known.body_sha256 != self.digest:
            detail = f"{used} with another request, for {made}."
            raise Invalid(detail, title="Idempotency key reused")
        if (run and run.deleted_at) or (known.sweep and not left):
            raise Gone(
                f"{used} for {made}, which is in the bin: restore it, or use another key."
            )
        if not (run or known.sweep):
            raise Gone(
                f"{used} for {made} that was deleted: use another key to submit it again."
            )
        return known


@dataclass(frozen=True)
class Draft:
    """A run to create. The document is the spec as stored, which may have another seed."""

    spec: Spec
    document: dict[str, Any]
    columns: dict[str, Any]


def create_runs(
    services: Services,
    drafts: Sequence[Draft],
    request: IdempotentRequest,
    sweep: Sweep | None = None,
) -> Sequence[Run] | Idempotency:
    """Create all runs or none; or return what the request's key created earlier."""
    memory = _memory(drafts)
    try:
        with services.sessions.write.begin() as session:
            refuse_too_many(session, request.owner, len(drafts))
            if sweep is not None:
                session.add(sweep)
                session.flush()
            runs = _insert(session, drafts, memory, request.owner, sweep)
            if request.key is not None:
                created = {"sweep": sweep.id} if sweep is not None else {"run_id": runs[0].id}
                key, digest = request.stored_key, request.digest
                session.add(Idempotency(key=key, body_sha256=digest, **created))
    except (IntegrityError, TooMany):
        # A request with the same key was faster (tests/server/runs/test_runs.py), and has
        # perhaps filled the quota.
        known = request.earlier(services)
        if known is None:
            raise
        return known
    # After the commit: a worker that wakes must find the rows.
    services.wake.send()
    return runs


def _memory(drafts: Sequence[Draft]) -> dict[int, int]:
    """Return the needed bytes by the `id` of a spec, which the seeds of a sweep share."""
    specs = {id(draft.spec): draft.spec for draft in drafts}
    return {key: estimate(spec).memory_bytes for key, spec in specs.items()}


def _insert(
    session: Session,
    drafts: Sequence[Draft],
    memory: Mapping[int, int],
    owner: UUID | None,
    sweep: Sweep | None,
) -> list[Run]:
    """Insert rows a microsecond apart, so that lists and the queue keep their order."""
    created = now(session)
    runs = [
        Run(
            experiment=draft.spec.experiment,
            spec=draft.document,
            plugin_versions=plugins.needed_versions(draft.document),
            memory_bytes=memory[id(draft.spec)],
            generations=draft.spec.generations,
            version=VERSION,
            owner=owner,
            sweep=sweep.id if sweep is not None else None,
            sweep_index=place if sweep is not None else None,
            created_at=created + timedelta(microseconds=place),
            queued_at=created + timedelta(microseconds=place),
            **draft.columns,
        )
        for place, draft in enumerate(drafts)
    ]
    session.add_all(runs)
    session.flush()
    by_spec: dict[int, tuple[Spec, list[UUID]]] = {}
    for place, (draft, run) in enumerate(zip(drafts, runs, strict=True), 1):
        text = f"Submitted: {run.experiment}, {run.generations} generations"
        if sweep is not None:
            text += f"; run {place} of a sweep of {len(runs)}"
        session.add(LogEntry(run_id=run.id, attempt=0, level="info", text=f"{text}."))
        by_spec.setdefault(id(draft.spec), (draft.spec, []))[1].append(run.id)
    initial.record(session, list(by_spec.values()))
    return runs


def submit(
    services: Services, spec: Spec, request: IdempotentRequest | None = None, **columns: Any
) -> tuple[RunRead, bool]:
    """Queue a run; return it and whether it is new."""
    document = spec.model_dump(mode="json")
    with services.sessions.read() as session:
        initial.check(session, spec)
    drafts = [Draft(spec, document, columns)]
    created = create_runs(services, drafts, request or IdempotentRequest(document))
    if isinstance(created, Idempotency):
        return current(services, created.run_id), False
    return announced(services, created[0].id), True


def answer(
    services: Services,
    response: Response,
    request: IdempotentRequest,
    draft: Callable[[], tuple[Spec, dict[str, Any]]],
) -> RunRead:
    """Answer a request: 200 with the run that its key created, else 202 with a new one."""
    if known := request.earlier(services):
        run, new = current(services, known.run_id), False
    else:
        spec, columns = draft()
        refuse_too_large(services, spec)
        run, new = submit(services, spec, request, **columns)
    response.status_code = 202 if new else 200
    response.headers["Location"] = f"/api/v1/runs/{run.id}"
    return run
