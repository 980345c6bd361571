"""How a genotype becomes a body that is driven, and how it is written down."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol, runtime_checkable

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, PRNGKeyArray, PyTree

from ..filaments import Rest
from ..world import State, World, follow, keep

Scalar = Float[Array, ""]


@dataclass(frozen=True)
class Drive:
    """What is simulated of a creature: a world, its start, and what moves its body.

    `inputs` have the time first; `control` makes the rest shape of a step from them and
    `remember` the controller's memory, as `world.rollout` takes them.
    """

    world: World
    start: State
    inputs: PyTree[Array]
    control: Callable[[World, State, Any], Rest] = follow
    remember: Callable[[World, State, Any], PyTree[Array]] = keep
    length: Scalar | None = None
    """How far the body reaches, in cells; None: as far as everybody's."""


@runtime_checkable
class Encoding(Protocol):
    """A kind of genotype: what it means for a body in a world."""

    @property
    def room(self) -> tuple[int, int] | None:
        """Nodes and connections that a genotype's arrays have room for; None for vectors."""
        ...

    def newcomer(self, *, key: PRNGKeyArray) -> Any:
        """A random genotype."""
        ...

    def drive(self, world: World, start: State, genotype: Any, phase: Scalar | None) -> Drive:
        """Grow a creature; `phase` in rad moves a periodic timer ahead where there is one."""
        ...

    def size(self, genotype: Any) -> tuple[Array, Array]:
        """Hidden nodes and enabled connections; both 0 where there is no network."""
        ...

    def write(self, genotype: Any) -> dict[str, Any]:
        """The genes of one genotype of NumPy arrays, as they stand in a creature file."""
        ...

    def read(self, genes: Mapping[str, Any]) -> Any:
        """The genotype of a parsed creature file, as NumPy arrays."""
        ...


def none() -> tuple[Array, Array]:
    """The size of what is no network."""
    return jnp.zeros((), jnp.int32), jnp.zeros((), jnp.int32)


def shifted(timer: np.ndarray | Array, phase: Scalar | None) -> Array | np.ndarray:
    """A sine and cosine (2, time) so much ahead; a linear timer (1, time) has no phase."""
    if phase is None or len(timer) == 1:
        return timer
    sine, cosine = jnp.asarray(timer, phase.dtype)
    s, c = jnp.sin(phase), jnp.cos(phase)
    return jnp.stack([sine * c + cosine * s, cosine * c - sine * s])
