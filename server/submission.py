"""From a spec to a queued run."""

import os
from dataclasses import dataclass
from hashlib import sha256
from typing import Any

import rfc8785
from sqlalchemy.exc import IntegrityError
from sqlalchemy.orm import Session

from microcosmos.spec import Spec, estimate
from microcosmos.version import VERSION

from . import origins, workers
from .journal import note
from .lifecycle import announce
from .models import Idempotency, Run
from .problems import FieldError, Refused
from .reconcile import requeue
from .services import Services

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


@dataclass(frozen=True)
class OneCell:
    """The smallest archive, as far as an estimate looks at it."""

    cells: int = 1


def memory_limit(services: Services, session: Session) -> int:
    """Bytes that a run may need: the largest worker's, else this machine's; or less, if set."""
    live = workers.live(session, services.settings.lease)
    cap = services.settings.max_bytes
    if not live:
        return cap or os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    largest = max(worker.memory_bytes for worker in live)
    return min(largest, cap) if cap else largest


def refuse_too_large(services: Services, spec: Spec) -> None:
    """Raise `Refused` where no worker has the memory."""
    with services.sessions.read() as session:
        limit = memory_limit(services, session)
    needed = estimate(spec).memory_bytes
    if needed > limit:
        detail = f"The run needs {needed:,} bytes of memory; {limit:,} bytes are available."
        field = decisive(spec)
        error = FieldError(
            field=field, message=detail, needed=f"at most {limit} bytes", got=needed
        )
        raise Refused(422, "More memory than there is", detail, [error])


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
    services: Services, spec: Spec, key: str | None = None, **said: Any
) -> tuple[Run, bool]:
    """The run of a spec and whether it is new; the same key with the same spec is one run.

    What else is `said` of a new run are columns of its row.
    """
    run = Run(
        experiment=spec.experiment,
        spec=spec.model_dump(mode="json"),
        generations=spec.generations,
        version=VERSION,
        **said,
    )
    try:
        with services.sessions.write.begin() as session:
            session.add(run)
            session.flush()
            note(session, run, f"Submitted: {run.experiment}, {run.generations} generations.")
            origins.keep(session, run, spec)
            if key is not None:
                session.add(Idempotency(key=key, body_sha256=_digest(run), run_id=run.id))
    except IntegrityError:
        if key is None:
            raise
        return _earlier(services, key, run), False
    # Committed before it is enqueued: the worker must find the row.
    requeue(services, run.id)
    announce(services, run.id)
    return run, True


def _digest(run: Run) -> str:
    return sha256(rfc8785.dumps(run.spec)).hexdigest()


def _earlier(services: Services, key: str, run: Run) -> Run:
    """The run that a key stands for already; `Refused` where its spec was another."""
    with services.sessions.read() as session:
        known = session.get_one(Idempotency, key)
        if known.body_sha256 != _digest(run):
            detail = (
                f"Idempotency-Key {key!r} was used with another spec, for run {known.run_id}."
            )
            raise Refused(422, "Idempotency key reused", detail)
        return session.get_one(Run, known.run_id)
