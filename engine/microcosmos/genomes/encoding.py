"""The interface of encodings, which turn genotypes into driven bodies."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol, runtime_checkable

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, PRNGKeyArray, PyTree

from ..bodies.growth import Segments
from ..filaments import Layout, Rest
from ..portable import cosine, sine
from ..world import Controller, State, World, follow, keep_memory

Scalar = Float[Array, ""]


@dataclass(frozen=True)
class Drive:
    """The simulation of a creature: a world, its start, and the control of its body.

    `inputs` have time as first axis; from them `control` makes the rest shape of a step and
    `remember` the controller's memory, as in `world.rollout`.
    """

    world: World
    start: State
    inputs: PyTree[Array]
    control: Callable[[World, State, Any], Rest] = follow
    remember: Callable[[World, State, Any], PyTree[Array]] = keep_memory
    length: Scalar | None = None
    """Extent of the body in cells; None: that of the task's body."""
    clock: Float[Array, "time"] | None = None
    """Time of the controller at the end of each step, in steps; None: that of the world."""
    controller: Controller | None = None
    """The same control for the native kernel; None: JAX has to carry it out."""
    layout: Layout | None = None
    """Layout of a body whose shape is inherited; None: that of the task's body."""
    form: Mapping[str, Array] | None = None
    """Measures of the form of a body whose shape is inherited; None: those of the task's."""


@runtime_checkable
class Encoding(Protocol):
    """The development of one kind of genotype into a body driven in a world."""

    @property
    def room(self) -> tuple[int, int] | None:
        """Nodes and connections of a genotype's arrays; None for vectors."""
        ...

    @property
    def segments(self) -> Segments | None:
        """Limits of the segments of a plan; None where the genome has none."""
        ...

    def newcomer(self, *, key: PRNGKeyArray) -> Any:
        """Draw a random genotype."""
        ...

    def drive(self, world: World, start: State, genotype: Any, phase: Scalar | None) -> Drive:
        """Build a creature; `phase` in rad advances a periodic timer."""
        ...

    def size(self, genotype: Any) -> tuple[Array, Array]:
        """Return the number of hidden nodes and enabled connections; 0 without a network."""
        ...


class Networkless:
    """Base of encodings whose genotypes are vectors and hold no network."""

    room = None
    segments = None

    def size(self, genotype: Any) -> tuple[Array, Array]:
        return jnp.zeros((), jnp.int32), jnp.zeros((), jnp.int32)


def shifted(timer: np.ndarray | Array, phase: Scalar | None) -> Array | np.ndarray:
    """Advance a sine and cosine (2, time) by a phase; a linear timer (1, time) has none."""
    if phase is None or len(timer) == 1:
        return timer
    s, c = jnp.asarray(timer, phase.dtype)
    ahead, across = cosine(phase), sine(phase)
    return jnp.stack([s * ahead + c * across, c * ahead - s * across])
