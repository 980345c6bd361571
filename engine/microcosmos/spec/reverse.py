"""Memory of reverse-mode gradients, measured on compiled programs and rounded up."""

from math import ceil

from .coupling import Coupling
from .world import World

FLOAT = 4


def step_bytes(world: World, coupling: Coupling, nodes: int) -> int:
    """Return the bytes that the derivative of a step keeps."""
    floats = 20 * nodes * coupling.constraint_iterations
    if world.fluid:
        windows = 80 * (1 + coupling.forcing_iterations) * coupling.layers
        floats += 22 * world.width * world.height + windows * nodes
    return FLOAT * floats


def state_bytes(world: World, nodes: int) -> int:
    """Return the bytes of a state from which steps are recomputed."""
    return FLOAT * (9 * world.width * world.height + 5 * nodes)


def total_bytes(steps: int, segment: int | None, step: int, state: int) -> int:
    """Return the bytes of all steps, or of each segment's state and one segment's steps."""
    if segment is None or segment >= steps:
        return steps * step
    return ceil(steps / segment) * state + segment * step
