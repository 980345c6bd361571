"""Memory of reverse-mode gradients, measured on compiled programs and rounded up."""

from math import ceil

from .coupling import Coupling
from .world import World

FLOAT = 4


def of_step(world: World, coupling: Coupling, nodes: int) -> int:
    """Bytes that the derivative of a step keeps."""
    kept = 20 * nodes * coupling.constraint_iterations
    if world.fluid:
        windows = 80 * (1 + coupling.forcing_iterations) * coupling.layers
        kept += 22 * world.width * world.height + windows * nodes
    return FLOAT * kept


def of_state(world: World, nodes: int) -> int:
    """Bytes of a state from which steps are recomputed."""
    return FLOAT * (9 * world.width * world.height + 5 * nodes)


def shortest(steps: int, step: int, state: int) -> int:
    """Return the segment that takes the least memory, given the bytes of a step and a state."""
    return max(1, round((steps * state / step) ** 0.5))


def in_all(steps: int, segment: int | None, step: int, state: int) -> int:
    """Bytes of all steps, or of one state per segment and the steps of one segment."""
    if segment is None or segment >= steps:
        return steps * step
    return ceil(steps / segment) * state + segment * step
