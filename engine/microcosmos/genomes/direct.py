"""Direct encoding: genes are the control of every joint and edge, and measures of the body."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, PRNGKeyArray

from ..world import State, World
from .development import Controls, actuated
from .encoding import Drive, Scalar, none, shifted
from .genotype import Vector
from .shaping import Plan, shaped, within
from .vectors import evenly, from_values, to_values
from .waves import Basis, phases, wave

CONTROL = ("angles", "lengths")
"""The parts that move the body."""


@dataclass(frozen=True)
class Direct:
    """Numbers from −1 to 1, part by part: the body's free measures, then its control."""

    controls: Controls
    parts: Mapping[str, int]
    """How many genes each part has, in order; the last are `CONTROL`."""
    bounds: Mapping[str, tuple[float, float]]
    """Of the body's free measures."""
    basis: Basis
    terms: int
    plan: Plan | None = None
    """Needed where rest angles or rest lengths are free."""
    spread: float = 1.0
    """Newcomers' genes lie within ± this."""
    faintest: float = 1.0
    """Newcomers' angles and lengths are multiplied by factors from this to 1."""

    @property
    def room(self) -> None:
        """There is no network."""
        return None

    def newcomer(self, *, key: PRNGKeyArray) -> Vector:
        """Every gene evenly drawn, then control made fainter."""
        genes_key, factor_key = jax.random.split(key)
        genes = evenly(sum(self.parts.values()), self.spread, key=genes_key)
        factors = self.faintest ** jax.random.uniform(factor_key, (2,))
        scale = jnp.concatenate(
            [
                jnp.full(count, factors[CONTROL.index(name)] if name in CONTROL else 1.0)
                for name, count in self.parts.items()
            ]
        )
        return Vector(genes.values * scale)

    def drive(
        self, world: World, start: State, genotype: Vector, phase: Scalar | None
    ) -> Drive:
        """Open loop."""
        dtype = start.positions.dtype
        genes = self.divided(genotype.values.astype(dtype))
        traits = {name: within(genes[name], bounds) for name, bounds in self.bounds.items()}
        body = shaped(world, start, self.controls, self.plan, traits)
        timer = shifted(self.controls.timer, phase)
        basis = self.basis(phases(timer, dtype), self.terms)
        angle = wave(basis, genes["angles"], len(self.controls.joint_nodes))
        length = wave(basis, genes["lengths"], len(self.controls.edges))
        rest = actuated(angle, length, self.controls.ramp, body.controls)
        return Drive(body.world, body.start, rest)

    def divided(self, values: Array) -> dict[str, Array]:
        """The genes of each part."""
        found, used = {}, 0
        for name, count in self.parts.items():
            found[name] = values[used : used + count]
            used += count
        return found

    def size(self, genotype: Vector) -> tuple[Array, Array]:
        """No network."""
        return none()

    def write(self, genotype: Vector) -> dict[str, Any]:
        """All genes."""
        return to_values(genotype)

    def read(self, genes: Mapping[str, Any]) -> Vector:
        """All genes."""
        return from_values(genes)
