"""Carry out the runs of a study on a server, and download their files."""

import hashlib
import json
import time
from collections.abc import Callable

from ..client import Client, Sweep
from ..spec import parse
from .runs import SHORT, Plan, PlannedRun, identity

PAUSE = 2.0
"""Seconds between two looks at the sweeps."""
NAME_LENGTH = 200
"""Longest name of a sweep on a server."""

Tell = Callable[[dict[str, int]], None]
"""Called with the number of runs by status."""


def carry_out(plan: Plan, client: Client, tell: Tell = lambda counts: None) -> None:
    """Queue the sweeps of a study, wait for them, and download runs whose files are missing.

    The same study again is the same sweeps, also with another title. Raises `ValueError` where
    runs have ended without finishing.
    """
    missing = {run.id: run for run in plan.unique() if not run.done()[1]}
    wanted = {run.sweep for run in plan.runs if run.id in missing}
    names = [name for name in plan.study.sweeps if name in wanted]
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


def _submitted(plan: Plan, name: str, client: Client) -> Sweep:
    seeds = list(dict.fromkeys(run.spec.seed for run in plan.runs if run.sweep == name))
    spec, grid = plan.bases[name].model_dump(mode="json"), plan.study.sweeps[name].grid
    # The server answers a repeated key with the sweep that it has, if all else is equal too
    # (test_a_repeated_study_asks_for_the_same_sweep_and_nothing_once_it_is_there).
    sent = json.dumps([name, spec, seeds, list(grid.items())], sort_keys=True)
    key = f"study-{hashlib.sha256(sent.encode()).hexdigest()}"
    made = client.submit(spec, seeds=seeds, grid=grid, name=name, key=key)
    assert isinstance(made, Sweep)  # Seeds are given.
    # The title later, since a corrected one must not make another request.
    title = f"{plan.study.title[: NAME_LENGTH - len(name) - 2]}: {name}"
    return made if made.name == title else made.change(name=title)


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
