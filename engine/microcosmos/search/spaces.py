"""Search spaces: the genotypes of a search of your own, vectors within bounds or networks."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, Protocol, runtime_checkable

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, PRNGKeyArray

from ..genomes import CPPN, Genotype, Vector, evaluate, minimal
from ..neat import Counters, first_counters

Numbers = float | int | Sequence[Any] | np.ndarray | Array
"""A number, or an array of numbers of any kind."""


@runtime_checkable
class Space(Protocol):
    """The genotypes of a search; emitters call it for a random one."""

    def __call__(self, *, key: PRNGKeyArray) -> Genotype:
        """Draw one genotype."""
        ...

    @property
    def counters(self) -> Counters:
        """The first numbers that no gene of a random genotype has."""
        ...

    def decode(self, genotypes: Any) -> Any:
        """Return what a function evaluates: scaled vectors, or the networks themselves."""
        ...


@dataclass(frozen=True)
class Vectors:
    """Vectors with a number of genes, each from `low` to `high`, drawn uniformly.

    Bounds are numbers, or a number for each gene. Emitters vary genes from −1 to 1, so their
    steps are relative to half of the range. Raises `ValueError` for other bounds.
    """

    genes: int
    low: Numbers = -1.0
    high: Numbers = 1.0

    def __post_init__(self) -> None:
        if self.genes < 1:
            raise ValueError(f"`genes` must be at least 1, got {self.genes}")
        for name in ("low", "high"):
            bound = np.asarray(getattr(self, name), float)
            if bound.shape not in ((), (self.genes,)) or not np.isfinite(bound).all():
                raise ValueError(
                    f"`{name}` must be a finite number, or {self.genes} of them, got {bound}"
                )
        if not np.all(np.less(self.low, self.high)):
            raise ValueError(f"`low` must be below `high`, got {self.low} and {self.high}")

    def __call__(self, *, key: PRNGKeyArray) -> Vector:
        return Vector(jax.random.uniform(key, (self.genes,), jnp.float32, -1.0, 1.0))

    @property
    def counters(self) -> Counters:
        return first_counters(1, 1)

    def decode(self, genotypes: Vector) -> Any:
        """Scale genes from ±1 to the bounds, on the host if they are NumPy arrays."""
        host = isinstance(genotypes.values, np.ndarray)
        wide = np.float64 if host else genotypes.values.dtype
        shape = genotypes.values.shape
        low, high = (np.broadcast_to(np.asarray(x, wide), shape) for x in (self.low, self.high))
        scaled = low + (high - low) * (genotypes.values.astype(wide) + 1) / 2
        if host:
            return np.clip(scaled, low, high).astype(np.float32)
        return jnp.clip(scaled, low, high)


@dataclass(frozen=True)
class Networks:
    """Networks (CPPNs) that NEAT grows from all inputs linked to all outputs.

    `nodes` and `connections` are the most that a network can have.
    """

    inputs: int
    outputs: int
    nodes: int = 32
    connections: int = 64

    def __post_init__(self) -> None:
        least = {"nodes": self.inputs + self.outputs, "connections": self.inputs * self.outputs}
        for name, count in {"inputs": 1, "outputs": 1, **least}.items():
            if getattr(self, name) < count:
                raise ValueError(
                    f"`{name}` must be at least {count}, got {getattr(self, name)}"
                )

    def __call__(self, *, key: PRNGKeyArray) -> CPPN:
        return minimal(key, self.inputs, self.outputs, self.nodes, self.connections)

    @property
    def counters(self) -> Counters:
        return first_counters(self.inputs, self.outputs)

    def decode(self, genotypes: CPPN) -> CPPN:
        return genotypes

    def outputs_of(
        self, networks: CPPN, points: Numbers
    ) -> Float[Array, "network point output"]:
        """Return the outputs of each network of a batch at each point (point, input).

        Raises `ValueError` for points of another shape.
        """
        points = jnp.asarray(points, jnp.float32)
        if points.ndim != 2 or points.shape[1] != self.inputs:
            raise ValueError(
                f"`points` must be rows of {self.inputs} inputs, got shape {points.shape}"
            )
        return _outputs(networks, points, self.outputs)


@partial(jax.jit, static_argnums=2)
def _outputs(networks: CPPN, points: Float[Array, "point input"], count: int) -> Array:
    one = partial(evaluate, inputs=points.T, outputs=count)
    return jnp.swapaxes(eqx.filter_vmap(one)(networks), 1, 2)
