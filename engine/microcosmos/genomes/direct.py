"""Direct encoding: genes are the control of every joint and edge, and traits of the body."""

from collections.abc import Mapping
from dataclasses import dataclass

import jax
import jax.numpy as jnp
from jaxtyping import Array, PRNGKeyArray

from ..bodies import Layout
from ..portable import power
from ..world import State, World
from .commands import series_commands
from .development import Controls, actuated
from .encoding import Drive, Networkless, Scalar, shifted
from .genotype import Vector, uniform_vector
from .traits import shaped, within
from .waves import Basis, phases, wave

CONTROL = ("angles", "lengths")
"""The parts of the genome that move the body."""


@dataclass(frozen=True)
class Direct(Networkless):
    """Genes within ±1, part by part: inherited traits of the body, then its control."""

    controls: Controls
    parts: Mapping[str, int]
    """Number of genes of each part, in order; `CONTROL` comes last."""
    bounds: Mapping[str, tuple[float, float]]
    """Bounds of the inherited traits."""
    basis: Basis
    terms: int
    layout: Layout | None = None
    """Needed where rest angles or rest lengths are inherited."""
    spread: float = 1.0
    """Genes of new genotypes lie within ± this."""
    faintest: float = 1.0
    """Lowest factor on the angles and on the lengths of new genotypes; the highest is 1."""

    def newcomer(self, *, key: PRNGKeyArray) -> Vector:
        """Draw every gene uniformly, then reduce the control by random factors."""
        genes_key, factor_key = jax.random.split(key)
        genes = uniform_vector(sum(self.parts.values()), self.spread, key=genes_key)
        factors = power(self.faintest, jax.random.uniform(factor_key, (2,)))
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
        dtype = start.positions.dtype
        genes = self.divided(genotype.values.astype(dtype))
        traits = {name: within(genes[name], bounds) for name, bounds in self.bounds.items()}
        body = shaped(world, start, self.controls, self.layout, traits)
        timer = shifted(self.controls.timer, phase)
        basis = self.basis(phases(timer, dtype), self.terms)
        angle = wave(basis, genes["angles"], len(self.controls.joint_nodes))
        length = wave(basis, genes["lengths"], len(self.controls.edges))
        rest = actuated(angle, length, self.controls.ramp, body.controls)
        given = series_commands(basis, genes["angles"], genes["lengths"], body.controls)
        return Drive(body.world, body.start, rest, controller=given)

    def divided(self, values: Array) -> dict[str, Array]:
        found, used = {}, 0
        for name, count in self.parts.items():
            found[name] = values[used : used + count]
            used += count
        return found
