"""From a spec to a queued run."""

import os
from dataclasses import dataclass, field
from hashlib import sha256
from typing import Any

import rfc8785
from sqlalchemy.exc import IntegrityError
from sqlalchemy.orm import Session

from microcosmos.spec import Spec, estimate
from microcosmos.version import VERSION

from . import origins, own, workers
from .caller import owner
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
TOO_LARGE = "More memory than there is"


@dataclass(frozen=True)
class OneCell:
    """The smallest archive, as far as an estimate looks at it."""

    cells: int = 1
    own: dict[str, Any] = field(default_factory=dict)


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
    if error := too_large(spec, limit):
        raise Refused(422, TOO_LARGE, error.message, [error])


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
    services: Services, spec: Spec, key: str | None = None, **said: Any
) -> tuple[Run, bool]:
    """The run of a spec and whether it is new; the same key with the same spec is one run.

    What else is `said` of a new run are columns of its row.
    """
    document = spec.model_dump(mode="json")
    run = Run(
        experiment=spec.experiment,
        spec=document,
        sources=own.needs(document),
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
                mine, body = own_key(key), digest(run.spec)
                session.add(Idempotency(key=mine, body_sha256=body, run_id=run.id))
    except IntegrityError:
        if key is None:
            raise
        return _earlier(services, key, run), False
    # Committed before it is enqueued: the worker must find the row.
    requeue(services, run.id)
    announce(services, run.id)
    return run, True


def own_key(key: str) -> str:
    """A key as it is kept: what others sent under the same one is theirs."""
    mine = owner()
    return sha256(f"{mine} {key}".encode()).hexdigest() if mine else key


def digest(document: dict[str, Any]) -> str:
    """What two requests under one key must have in common."""
    return sha256(rfc8785.dumps(document)).hexdigest()


def _earlier(services: Services, key: str, run: Run) -> Run:
    """The run that a key stands for already; `Refused` where its spec was another."""
    with services.sessions.read() as session:
        known = same_request(session, key, run.spec)
        return session.get_one(Run, known.run_id)


def same_request(session: Session, key: str, document: dict[str, Any]) -> Idempotency:
    """What a key stands for already; `Refused` where another request came under it."""
    known = session.get_one(Idempotency, own_key(key))
    if known.body_sha256 != digest(document):
        made = f"sweep {known.sweep}" if known.sweep else f"run {known.run_id}"
        detail = f"Idempotency-Key {key!r} was used with another spec, for {made}."
        raise Refused(422, "Idempotency key reused", detail)
    return known
