"""pyribs' schedulers on our creatures: CMA-MAE, or MAP-Elites with iso+line.

Solutions are the genes of directly encoded swimmers, from −1 to 1. Needs `pip install ribs`.
"""

import sys
from typing import Any

import numpy as np
from ribs.archives import GridArchive
from ribs.emitters import EvolutionStrategyEmitter, IsoLineEmitter
from ribs.schedulers import Scheduler

import microcosmos
from microcosmos import build

SPEC = {
    "experiment": "quality-diversity",
    "world": {"width": 32, "height": 32},
    "body": {"nodes": 12},
    "control": {"encoding": "direct", "period": 50},
    "task": {"steps": 400},
    "search": {"emitters": [{"operator": "iso+line"}]},
}
RATES = {"cma-mae": 0.01, "iso+line": 1.0}
"""Rate at which an archive's thresholds follow fitness; 1: MAP-Elites."""


def main(
    emitter: str = "cma-mae", generations: int = 20, batch: int = 16, **changes: Any
) -> Any:
    """Return pyribs' archive of the fittest after `generations` of two emitters."""
    microcosmos.prepare()
    spec = microcosmos.parse(SPEC | changes)
    evaluate = microcosmos.ribs_function(spec)
    archive, fittest = (grid(spec, rate) for rate in (RATES[emitter], 1.0))
    emitters = [emitter_of(emitter, archive, batch, seed) for seed in range(2)]
    scheduler = Scheduler(archive, emitters, result_archive=fittest)
    for _ in range(generations):
        scheduler.tell(*evaluate(scheduler.ask()))
    stats = fittest.stats
    print(f"{stats.num_elites} elites in {fittest.cells} cells; fitness {stats.obj_max:.3f}")
    return fittest


def grid(spec: Any, rate: float) -> GridArchive:
    """Return an empty archive; its least threshold refuses infeasible creatures."""
    run = build.build(spec)
    plan = run.plan
    return GridArchive(
        solution_dim=plan.genotype.values.shape[0],
        dims=[axis.bins for axis in plan.axes],
        ranges=[(0.0, 1.0)] * len(plan.axes),
        learning_rate=rate,
        threshold_min=-1.0,
        seed=0,
    )


def emitter_of(name: str, archive: GridArchive, batch: int, seed: int) -> Any:
    ones = np.ones(archive.solution_dim)
    common = {"x0": 0 * ones, "lower_bounds": -ones, "upper_bounds": ones}
    common |= {"batch_size": batch, "seed": seed}
    if name == "iso+line":
        return IsoLineEmitter(archive, iso_sigma=0.02, line_sigma=0.2, **common)
    rules = {"ranker": "imp", "selection_rule": "mu", "restart_rule": "basic"}
    return EvolutionStrategyEmitter(archive, sigma0=0.2, **rules, **common)


if __name__ == "__main__":
    main(*sys.argv[1:2])
