"""The paths that a rollout can take: JAX, the reference, and the native kernel."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import jax

from microcosmos import device, filaments, world

Rollout = Callable[
    [world.World, world.State, filaments.Rest], tuple[world.State, world.Measures]
]


@dataclass(frozen=True)
class Path:
    name: str
    choice: str
    """The value of `device.KERNEL_VARIABLE` with which evaluations take this path."""
    rollout: Rollout


def _in_jax(box: world.World, start: world.State, rest: filaments.Rest):
    return world.rollout(box, start, rest, lambda _, measures: measures)


JAX = Path("JAX", "jax", _in_jax)
KERNEL = Path("kernel", "native", world.native.rollout)


def paths() -> tuple[Path, ...]:
    """Return the paths that this machine has."""
    return (JAX,) if device.kernel_version() is None else (JAX, KERNEL)


def nothing(measures: world.Measures) -> None:
    return None


@partial(jax.jit, static_argnames=("path", "observe"))
def roll(
    path: Path,
    box: world.World,
    start: world.State,
    rest: filaments.Rest,
    observe: Callable[[world.Measures], Any] = nothing,
) -> tuple[world.State, Any]:
    """Return the state after all steps of a rollout, and the observation of its measures."""
    end, measures = path.rollout(box, start, rest)
    return end, observe(measures)
