"""Read sweeps for the API: their cases, and how far their runs are."""

from collections import Counter, defaultdict
from collections.abc import Sequence
from typing import Any
from uuid import UUID

from sqlalchemy import select
from sqlalchemy.orm import Session

from microcosmos.spec.paths import combinations

from ..auth import tokens
from ..tables import STATUSES, Run, Sweep
from ..workers.registry import progress
from .schemas import CaseRead, SweepRead


def read_sweeps(session: Session, sweeps: Sequence[Sweep]) -> list[SweepRead]:
    of_sweeps: dict[UUID, list[Any]] = defaultdict(list)
    names = ("id", "sweep", "sweep_index", "status", "generation", "generations", "deleted_at")
    columns = [getattr(Run, name) for name in names]
    mine = Run.sweep.in_([sweep.id for sweep in sweeps])
    for row in session.execute(
        select(*columns).where(mine).order_by(Run.sweep, Run.sweep_index)
    ):
        of_sweeps[row.sweep].append(row)
    owners = tokens.owner_names(session, (sweep.owner for sweep in sweeps))
    return [_read(one, of_sweeps[one.id], owners.get(one.owner)) for one in sweeps]


def read_sweep(session: Session, sweep: Sweep) -> SweepRead:
    return read_sweeps(session, [sweep])[0]


def _read(sweep: Sweep, all_runs: Sequence[Any], owner: str | None) -> SweepRead:
    runs = [run for run in all_runs if run.deleted_at is None]
    cases = [CaseRead(values=values, runs=[]) for values in combinations(sweep.grid)]
    for run in runs:
        cases[run.sweep_index % len(cases)].runs.append(run.id)
    counted = Counter(run.status for run in runs)
    shares = [progress(run) for run in runs]
    names = ("id", "name", "experiment", "spec", "seeds", "grid", "created_at")
    return SweepRead(
        **{name: getattr(sweep, name) for name in names},
        owner=owner,
        cases=cases,
        total=len(runs),
        deleted=len(all_runs) - len(runs),
        status_counts={status: counted[status] for status in STATUSES if counted[status]},
        progress=sum(shares) / len(shares) if shares else 1.0,
    )
