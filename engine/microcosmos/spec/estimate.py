"""What a run will need, before it is accepted."""

from dataclasses import dataclass
from math import ceil

from .experiments import Spec

FLOAT = 4
PLANES = 9


@dataclass(frozen=True)
class Estimate:
    memory_bytes: int
    evaluations: int
    cell_steps: int
    """Fluid cells times steps of the whole run: the work that dominates."""


def estimate(spec: Spec) -> Estimate:
    """An upper estimate of a worker's memory, and the work of the whole run.

    Memory counts one block in flight with the populations before, during and after a
    step, the coupling's windows of 16 cells a node, the controls of all steps, and the
    archive with its offspring and what varying them takes. It leaves out what JAX itself
    occupies.
    """
    world, body, task, search = spec.world, spec.body, spec.task, spec.search
    cells = world.width * world.height
    fluid = 4 * PLANES * cells * FLOAT
    coupling = 8 * 16 * body.nodes * FLOAT
    # A batched choice among activations computes all of them.
    controls = 10 * task.steps * body.nodes * (spec.genome.max_nodes + 2) * FLOAT
    genome = FLOAT * (3 * spec.genome.max_nodes + 5 * spec.genome.max_connections)
    archive = 4 * (spec.archive.cells + 2 * search.batch) * (genome + 128)
    vary = 4 * search.batch * spec.genome.max_nodes**2 * FLOAT
    evaluations = search.batch * search.generations
    record = 2 * (48 * search.generations + 96 * min(evaluations, 4 * spec.archive.cells))
    computed = ceil(search.batch / search.block) * search.block * search.generations
    return Estimate(
        memory_bytes=search.block * (fluid + coupling + controls) + archive + vary + record,
        evaluations=evaluations,
        cell_steps=computed * cells * task.steps,
    )
