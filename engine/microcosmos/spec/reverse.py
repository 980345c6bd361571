"""What reverse mode keeps in memory: measured of compiled programs, rounded upwards."""

from math import ceil

from .coupling import Coupling
from .world import World

FLOAT = 4


def of_step(world: World, coupling: Coupling, nodes: int) -> int:
    """Bytes of what a step's derivative needs of it."""
    kept = 20 * nodes * coupling.constraint_iterations
    if world.fluid:
        windows = 80 * (1 + coupling.forcing_iterations) * coupling.layers
        kept += 22 * world.width * world.height + windows * nodes
    return FLOAT * kept


def of_state(world: World, nodes: int) -> int:
    """Bytes of a state from which steps are done again."""
    return FLOAT * (9 * world.width * world.height + 5 * nodes)


def shortest(steps: int, step: int, state: int) -> int:
    """The segment that takes the least memory, of steps and states of so many bytes."""
    return max(1, round((steps * state / step) ** 0.5))


def in_all(steps: int, segment: int | None, step: int, state: int) -> int:
    """Bytes of all steps, or of a state for each segment and one segment's steps."""
    if segment is None or segment >= steps:
        return steps * step
    return ceil(steps / segment) * state + segment * step
