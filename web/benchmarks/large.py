"""Write finished runs with large archives, made of the creatures of a small search.

A creature may be in many cells, and the fitness is a smooth hill with noise.
"""

from datetime import timedelta
from uuid import UUID

import numpy as np
from sqlalchemy import insert, select

from microcosmos_server.services.services import Services
from microcosmos_server.tables import FINISHED, Elite, Generation, Run

GENERATIONS = 200


def write_run(services: Services, of: str, side: int, filled: int, creatures: list[str]) -> str:
    """Write a run with an archive of side × side cells, some of them filled; return its id."""
    draw = np.random.default_rng(side)
    cells = np.sort(draw.choice(side * side, filled, replace=False))
    fitness = hill(cells, side) + draw.normal(0, 0.03, filled)
    entered = np.sort(draw.integers(1, GENERATIONS + 1, filled))
    with services.sessions.write.begin() as session:
        run = copied(session.get_one(Run, UUID(of)), side, fitness)
        session.add(run)
        session.flush()
        axes = run.spec["archive"]["descriptors"]
        rows = [
            {
                "run_id": run.id,
                "cell": int(cell),
                "generation": int(generation),
                "fitness": float(value),
                "descriptors": middle(int(cell), side, axes),
                "creature": creatures[i % len(creatures)],
            }
            for i, (cell, value, generation) in enumerate(
                zip(cells, fitness, entered, strict=True)
            )
        ]
        session.execute(insert(Elite), rows)
        session.execute(insert(Generation), curves(run, fitness, entered))
        return str(run.id)


def hill(cells: np.ndarray, side: int) -> np.ndarray:
    x, y = cells // side / side, cells % side / side
    return 2 + np.sin(3 * x) * np.cos(2 * y)


def middle(cell: int, side: int, axes: list[dict]) -> list[float]:
    """The descriptors in the middle of a cell."""
    parts = [(part + 0.5) / side for part in divmod(cell, side)]
    return [between(axis, part) for axis, part in zip(axes, parts, strict=True)]


def between(axis: dict, part: float) -> float:
    low, high = axis["low"], axis["high"]
    return low * (high / low) ** part if axis["scale"] == "log10" else low + (high - low) * part


def copied(run: Run, side: int, fitness: np.ndarray) -> Run:
    """A finished run with another archive."""
    axes = [{**axis, "bins": side} for axis in run.spec["archive"]["descriptors"]]
    archive = {**run.spec["archive"], "descriptors": axes}
    search = {**run.spec["search"], "generations": GENERATIONS}
    return Run(
        experiment=run.experiment,
        spec={**run.spec, "archive": archive, "search": search},
        version=run.version,
        status=FINISHED,
        started_at=run.started_at,
        finished_at=run.started_at and run.started_at + timedelta(hours=1),
        generations=GENERATIONS,
        generation=GENERATIONS,
        evaluations=GENERATIONS * 64,
        seconds=3600.0,
        qd_score=float(fitness.sum()),
        coverage=len(fitness) / side**2,
        best=float(fitness.max()),
    )


def curves(run: Run, fitness: np.ndarray, entered: np.ndarray) -> list[dict]:
    """The curves of a run from the generations of its elites."""
    side = run.spec["archive"]["descriptors"][0]["bins"]
    found = [fitness[entered <= generation] for generation in range(1, GENERATIONS + 1)]
    return [
        {
            "run_id": run.id,
            "generation": i + 1,
            "qd_score": float(values.sum()),
            "coverage": len(values) / side**2,
            "best": float(values.max(initial=0)),
            "mean": float(values.mean()) if len(values) else 0.0,
            "evaluations": 64 * (i + 1),
            "infeasible": 0,
            "seconds": 18.0 * (i + 1),
            "summary": None,
        }
        for i, values in enumerate(found)
    ]


def creatures_of(services: Services, run: str) -> list[str]:
    """All elites of a run, newest first."""
    mine = select(Elite.creature).where(Elite.run_id == UUID(run))
    with services.sessions.read() as session:
        found = session.scalars(mine.order_by(Elite.generation.desc(), Elite.cell))
        return list(dict.fromkeys(found))
