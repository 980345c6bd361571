"""Totals: count what happens, by host, in numbers that never fall.

Rows of runs are deleted and rewound, and processes start again; totals stay. Add to them last
in a transaction: two that add to the same total wait for each other.
"""

from collections.abc import Mapping
from datetime import timedelta
from typing import NamedTuple

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from ..core.database import ago, clock, insert_or_update
from ..tables import Run, Total

HOST_SECONDS = timedelta(days=30).total_seconds()
"""Time for which the totals of a host are shown after they last changed."""
MAX_HOSTS = 200
"""Largest number of hosts whose totals are shown, those that changed last."""


class Key(NamedTuple):
    """The name of a count, and the part of it that is counted."""

    name: str
    kind: str = ""


EVALUATIONS, INFEASIBLE = Key("evaluations"), Key("infeasible")
GENERATIONS, COMPUTING_SECONDS = Key("generations"), Key("computing_seconds")
ATTEMPTS = Key("attempts")
FAILURES = {
    reason: Key("attempt_failures", reason)
    for reason in ("error", "process", "self-test", "silence")
}
"""Attempts that failed: an exception, a process that died, one that died on a host whose
self-test fails then, or a worker that no longer reports."""
CHECKPOINT_FAILURES = Key("checkpoint_failures")
XID_ERRORS = Key("xid_errors")
RUNS_ENDED = "runs_ended"
WEBHOOK = "webhook"
BY_HOST = (ATTEMPTS, *FAILURES.values(), CHECKPOINT_FAILURES, XID_ERRORS)


def host_of(worker: str | None) -> str:
    """Return the host of a worker, whose name also has the number of its process."""
    return (worker or "").rpartition("-")[0] or worker or ""


def add(session: Session, host: str, amounts: Mapping[Key, float]) -> None:
    """Add to totals, in one order, so that no two transactions wait for each other."""
    for key in sorted(amounts):
        row = {"name": key.name, "host": host, "kind": key.kind, "value": amounts[key]}
        added = {"value": Total.value + amounts[key], "changed_at": clock()}
        insert_or_update(session, Total, [row], ("name", "host", "kind"), added)


def count(session: Session, worker: str | None, key: Key) -> None:
    """Count one more on the host of a worker."""
    add(session, host_of(worker), {key: 1.0})


def count_work(session: Session, run: Run, before: tuple[int, int], seconds: float) -> None:
    """Count a generation that took some seconds: it stays counted if it is rewound.

    `before` has the run's evaluations and infeasible evaluations before it.
    """
    evaluations, infeasible = before
    amounts = {EVALUATIONS: run.evaluations - evaluations, COMPUTING_SECONDS: seconds}
    amounts |= {INFEASIBLE: run.infeasible - infeasible, GENERATIONS: 1}
    add(session, host_of(run.worker), amounts)


def read(session: Session) -> dict[Key, float]:
    """Return the totals of the installation."""
    summed = select(Total.name, Total.kind, func.sum(Total.value))
    found = session.execute(summed.group_by(Total.name, Total.kind))
    return {Key(name, kind): float(value) for name, kind, value in found}


def read_by_host(session: Session, names: set[str]) -> dict[str, dict[Key, float]]:
    """Return the totals of the named hosts and of those where one changed lately."""
    newest = func.max(Total.changed_at)
    recent = select(Total.host).where(Total.host != "").group_by(Total.host)
    recent = recent.having(newest >= ago(session, HOST_SECONDS)).order_by(newest.desc())
    hosts = names | set(session.scalars(recent.limit(MAX_HOSTS)))
    found: dict[str, dict[Key, float]] = {host: {} for host in sorted(hosts)}
    for row in session.scalars(select(Total).where(Total.host.in_(hosts))):
        found[row.host][Key(row.name, row.kind)] = row.value
    return found
