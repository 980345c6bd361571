"""Carry out the runs of a study on a server, and download their files."""

import hashlib
import time
from collections.abc import Callable

from ..client import Client, Sweep
from ..spec import parse
from .runs import SHORT, Plan, PlannedRun, identity

PAUSE = 2.0
"""Seconds between two looks at the sweeps."""

Tell = Callable[[dict[str, int]], None]
"""Called with the number of runs by status."""


def carry_out(plan: Plan, client: Client, tell: Tell = lambda counts: None) -> None:
    """Queue the sweeps of a study, wait for them, and download runs whose files are missing.

    The same study again is the same sweeps: their keys are the identities of their runs. Raises
    `ValueError` where runs have ended without finishing.
    """
    missing = {run.id: run for run in plan.unique() if not run.done()[1]}
    names = [name for name in plan.study.sweeps if _of(plan, name, missing)]
    sweeps = [_submitted(plan, name, client) for name in names]
    while not all(sweep.ended for sweep in sweeps):
        tell(_counted(sweeps))
        time.sleep(PAUSE)
        sweeps = [sweep.refresh() for sweep in sweeps]
    tell(_counted(sweeps))
    for sweep in sweeps:
        _fetch(sweep, missing)
    if missing:
        listed = ", ".join(missing)
        raise ValueError(f"all runs must finish; {client.url} has no finished run {listed}")


def _of(plan: Plan, name: str, missing: dict[str, PlannedRun]) -> bool:
    return any(run.sweep == name and run.id in missing for run in plan.runs)


def _submitted(plan: Plan, name: str, client: Client) -> Sweep:
    sweep, runs = plan.study.sweeps[name], [run for run in plan.runs if run.sweep == name]
    seeds = list(dict.fromkeys(run.spec.seed for run in runs))
    key = hashlib.sha256("\n".join(identity(run.spec) for run in runs).encode()).hexdigest()
    made = client.submit(
        plan.bases[name].model_dump(mode="json"),
        seeds=seeds,
        grid=sweep.grid,
        name=f"{plan.study.title}: {name}",
        key=f"study-{key}",
    )
    assert isinstance(made, Sweep)  # Seeds are given.
    return made


def _counted(sweeps: list[Sweep]) -> dict[str, int]:
    counts: dict[str, int] = {}
    for sweep in sweeps:
        for status, count in sweep.status_counts.items():
            counts[status] = counts.get(status, 0) + count
    return counts


def _fetch(sweep: Sweep, missing: dict[str, PlannedRun]) -> None:
    """Download the finished runs that are missing, and take them off the list."""
    for run in sweep.runs():
        planned = missing.get(identity(parse(run.spec))[:SHORT])
        if planned and run.status == "finished":
            planned.path.parent.mkdir(parents=True, exist_ok=True)
            run.pull(planned.path, quiet=True)
            del missing[planned.id]
