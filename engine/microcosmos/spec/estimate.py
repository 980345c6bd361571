"""What a run will need, before it is accepted."""

from dataclasses import dataclass

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
    archive with its offspring. It leaves out what JAX itself occupies.
    """
    world, body, task, search = spec.world, spec.body, spec.task, spec.search
    cells = world.width * world.height
    fluid = 4 * PLANES * cells * FLOAT
    coupling = 8 * 16 * body.nodes * FLOAT
    controls = 4 * task.steps * body.nodes * (spec.genome.max_nodes + 2) * FLOAT
    genome = FLOAT * (3 * spec.genome.max_nodes + 5 * spec.genome.max_connections)
    archive = 4 * (spec.archive.cells + 2 * search.batch) * (genome + 128)
    evaluations = search.batch * search.generations
    return Estimate(
        memory_bytes=search.block * (fluid + coupling + controls) + archive,
        evaluations=evaluations,
        cell_steps=evaluations * cells * task.steps,
    )
