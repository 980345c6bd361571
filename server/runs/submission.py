"""From a spec to a queued run."""

import os
from dataclasses import dataclass, field
from typing import Any
from uuid import UUID

from sqlalchemy.exc import IntegrityError
from sqlalchemy.orm import Session

from microcosmos.spec import Spec, estimate
from microcosmos.version import VERSION

from ..core.errors import FieldError, ProblemError
from ..creatures import initial
from ..services.services import Services
from ..tables import Run
from ..workers import plugins, registry
from . import idempotency
from .commands import announced, current
from .log import note
from .schemas import RunRead

OF_SEARCHES = ("search.block", "search.batch", "archive")
DECISIVE = {
    "quality-diversity": OF_SEARCHES,
    "neuroevolution": OF_SEARCHES,
    "folding": ("memory",),
    "refinement": ("segment",),
    "gaits": ("block",),
    "scaling": ("nodes",),
}
"""The fields of each experiment that may decide most about its memory."""
TOO_LARGE = "More memory than there is"


@dataclass(frozen=True)
class OneCell:
    """The smallest archive, as far as an estimate looks at it."""

    cells: int = 1
    plugins: dict[str, Any] = field(default_factory=dict)


def memory_limit(services: Services, session: Session) -> int:
    """Bytes that a run may need: the largest worker's, else this machine's; or less, if set."""
    live = registry.live(session, services.settings.lease)
    cap = services.settings.max_bytes
    if not live:
        return cap or os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    largest = max(worker.memory_bytes for worker in live)
    return min(largest, cap) if cap else largest


def refuse_too_large(services: Services, spec: Spec) -> None:
    """Raise `ProblemError` where no worker has the memory."""
    with services.sessions.read() as session:
        limit = memory_limit(services, session)
    if error := too_large(spec, limit):
        raise ProblemError(422, TOO_LARGE, error.message, [error])


def too_large(spec: Spec, limit: int) -> FieldError | None:
    """What is wrong with a spec that needs more than so many bytes."""
    needed = estimate(spec).memory_bytes
    if needed <= limit:
        return None
    detail = f"The run needs {needed:,} bytes of memory; {limit:,} bytes are available."
    return FieldError(
        field=decisive(spec), message=detail, needed=f"at most {limit} bytes", got=needed
    )


def decisive(spec: Spec) -> str:
    """The field whose least value would save the most memory."""
    fields = DECISIVE[spec.experiment]
    if len(fields) == 1:
        return fields[0]
    return min(fields, key=lambda field: estimate(_least(spec, field)).memory_bytes)


def _least(spec: Any, field: str) -> Spec:
    """The spec with as little as possible in one of its fields."""
    part, _, name = field.partition(".")
    if not name:
        return spec.model_copy(update={part: OneCell()})
    changed = getattr(spec, part).model_copy(update={name: 1})
    return spec.model_copy(update={part: changed})


def submit(
    services: Services,
    spec: Spec,
    key: str | None = None,
    request: Any = None,
    *,
    owner: UUID | None = None,
    **columns: Any,
) -> tuple[RunRead, bool]:
    """Create and enqueue a run; return it and whether it is new.

    The same key with the same request gives the same run. Without a `request` it is the spec.
    """
    document = spec.model_dump(mode="json")
    request = document if request is None else request
    run = Run(
        experiment=spec.experiment,
        spec=document,
        plugin_versions=plugins.needed_versions(document),
        generations=spec.generations,
        version=VERSION,
        owner=owner,
        **columns,
    )
    with services.sessions.read() as session:
        initial.check(session, spec)
    try:
        with services.sessions.write.begin() as session:
            session.add(run)
            session.flush()
            note(session, run, f"Submitted: {run.experiment}, {run.generations} generations.")
            initial.keep(session, [(spec, [run.id])])
            idempotency.remember(session, key, owner, request, run_id=run.id)
    except IntegrityError:
        known = idempotency.earlier(services, key, owner, request)
        if known is None:
            raise
        return current(services, known.run_id), False
    # Committed before it is enqueued: the worker must find the row.
    services.jobs.enqueue([run])
    return announced(services, run.id), True
