"""Requirements of a run on its worker, and the reasons why no live worker meets them."""

import json
from collections import Counter
from collections.abc import Callable, Sequence
from datetime import datetime, timedelta
from typing import Any, NamedTuple

from sqlalchemy import Text, case, cast, func, select
from sqlalchemy.orm import Session

from microcosmos.sizes import size

from ..tables import QUEUED, Run, Worker
from ..workers import plugins

NEEDS = (
    *(Run.id, Run.owner, Run.avoided_worker, Run.plugin_versions, Run.labels),
    *(Run.memory_bytes, Run.device, Run.device_patience, Run.checkpoint_generation),
    *(Run.queued_at, Run.released_at),
)
"""The columns that decide which worker may take a run."""


class Requirement(NamedTuple):
    """A requirement of a run on its worker."""

    name: str
    met: Callable[[Any, Worker, datetime], bool]
    """Takes a run, or its columns `NEEDS`, a worker, and the time."""
    explain: Callable[[Run, Sequence[Worker]], str]
    """Returns a sentence about a run whose requirement none of these workers meets."""


def fits(run: Any, worker: Worker, moment: datetime) -> bool:
    """Return whether a worker can carry out a run now."""
    return all(one.met(run, worker, moment) for one in REQUIREMENTS)


def fitting(
    run: Run, workers: Sequence[Worker], moment: datetime
) -> tuple[Sequence[Worker], str | None]:
    """Return the workers that can carry out a run; if there are none, why."""
    left, unmet = _narrowed(run, workers, moment)
    return ([], unmet.explain(run, left)) if unmet else (left, None)


def _narrowed(
    run: Any, workers: Sequence[Worker], moment: datetime
) -> tuple[Sequence[Worker], Requirement | None]:
    """Return the workers that meet all requirements, or those before the first unmet one."""
    for one in REQUIREMENTS:
        left = [worker for worker in workers if one.met(run, worker, moment)]
        if not left:
            return workers, one
        workers = left
    return workers, None


class Needs(NamedTuple):
    """The columns of a run that its requirements read."""

    plugin_versions: list[str] | None
    labels: list[str]
    memory_bytes: int | None
    device: str | None
    device_patience: float | None
    checkpoint_generation: int
    queued_at: datetime | None
    released_at: datetime | None


def count_unfit(session: Session, alive: Sequence[Worker], moment: datetime) -> Counter[str]:
    """Count the queued runs that no live worker can carry out, by the first unmet requirement.

    Without a live worker all count as `worker`. The database groups the runs: ten thousand of
    them have few different needs.
    """
    # Without patience the moments do not matter; left in, they would make a group of each run.
    patient = Run.device_patience.is_not(None)
    columns = (
        *(cast(Run.plugin_versions, Text), cast(Run.labels, Text), Run.memory_bytes),
        *(Run.device, Run.device_patience, case((Run.checkpoint_generation > 0, 1), else_=0)),
        *(case((patient, Run.queued_at)), case((patient, Run.released_at))),
    )
    numbered = [column.label(name) for column, name in zip(columns, Needs._fields, strict=True)]
    groups = select(*numbered, func.count()).group_by(*numbered)
    found = Counter[str]()
    waiting = groups.where(Run.status == QUEUED, Run.worker.is_(None))
    rows: Sequence[Any] = session.execute(waiting).all()
    for versions, labels, *others, number in rows:
        needs = Needs(json.loads(versions or "null"), json.loads(labels), *others)
        _, unmet = _narrowed(needs, alive, moment)
        if unmet:
            found[unmet.name if alive else "worker"] += number
    return found


def patience_ends(run: Any) -> datetime | None:
    """Return when another kind of device may go on with a run; None: never by itself."""
    if run.device_patience is None:
        return None
    waits_since = max(filter(None, (run.queued_at, run.released_at)))
    return waits_since + timedelta(seconds=run.device_patience)


def any_device(run: Any, moment: datetime) -> bool:
    """Return whether a run may continue on another kind of device than so far."""
    end = patience_ends(run)
    return end is not None and moment >= end


def _has_plugins(run: Any, worker: Worker, _: datetime) -> bool:
    return plugins.has_versions(worker, run.plugin_versions)


def _has_labels(run: Any, worker: Worker, _: datetime) -> bool:
    return set(run.labels) <= set(worker.labels)


def _has_memory(run: Any, worker: Worker, _: datetime) -> bool:
    return run.memory_bytes is None or run.memory_bytes <= worker.memory_bytes


def _repeats_bits(run: Any, worker: Worker, moment: datetime) -> bool:
    begun = run.checkpoint_generation > 0 and run.device is not None
    return not begun or run.device in worker.device_kinds or any_device(run, moment)


def _explain_plugins(run: Run, workers: Sequence[Worker]) -> str:
    return plugins.explain_missing(workers, run.spec)


def _explain_labels(run: Run, workers: Sequence[Worker]) -> str:
    offered = sorted({label for worker in workers for label in worker.labels})
    have = ", ".join(offered) or "none"
    return f"Waits for a worker with {_labels(run.labels)}; labels of live workers: {have}."


def _labels(labels: Sequence[str]) -> str:
    return f"the label{'s' if len(labels) > 1 else ''} {', '.join(sorted(labels))}"


def _explain_memory(run: Run, workers: Sequence[Worker]) -> str:
    largest = max(worker.memory_bytes for worker in workers)
    which = f"the largest worker with {_labels(run.labels)}" if run.labels else ""
    which = which or "the largest live worker"
    return f"Needs {size(run.memory_bytes or 0)}; {which} has {size(largest)}."


def _explain_device(run: Run, _: Sequence[Worker]) -> str:
    end = patience_ends(run)
    after = f"after {end:%Y-%m-%d %H:%M} UTC" if end else "once its owner allows it"
    return (
        "Waits for a worker whose device repeats its bits, of the kind "
        f"{run.device}: none is alive. Another kind continues it {after}."
    )


REQUIREMENTS = (
    Requirement("plugins", _has_plugins, _explain_plugins),
    Requirement("labels", _has_labels, _explain_labels),
    Requirement("memory", _has_memory, _explain_memory),
    Requirement("device", _repeats_bits, _explain_device),
)
"""All requirements, in the order in which they are explained."""
