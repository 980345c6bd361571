"""Encodings whose genes are numbers: direct control, folds, and those of plug-ins.

Direct genes are the waves of every joint and edge, and inherited traits of the body. Genes of a
fold are constant rest angles and rest lengths. A plug-in turns its genes into movements.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, PRNGKeyArray

from .. import filaments
from ..bodies import Layout, growth
from ..filaments import Rest
from ..groups import Groups
from ..portable import arctangent, cosine, power, product, sine
from ..world import State, World, with_bodies
from .commands import series_commands
from .development import Controls, actuated
from .encoding import Drive, Networkless, Scalar, shifted
from .genotype import Vector, uniform_vector

Phases = Float[Array, "time"]
Basis = Callable[[Phases, int], Float[Array, "time weight"]]
"""A function from phases in rad and a number of terms to what the weights multiply."""


def fourier(phase: Phases, terms: int) -> Float[Array, "time weight"]:
    """Return sines of the first harmonics, then cosines, without a constant."""
    angle = phase[:, None] * jnp.arange(1, terms + 1, dtype=phase.dtype)[None]
    return jnp.concatenate([sine(angle), cosine(angle)], 1)


def table(phase: Phases, terms: int) -> Float[Array, "time weight"]:
    """Return hat functions at `terms` times of the period, for linear interpolation."""
    place = (phase / (2 * np.pi) * terms)[:, None] - jnp.arange(terms, dtype=phase.dtype)[None]
    away = place - terms * jnp.round(place / terms)
    return jnp.maximum(0.0, 1 - jnp.abs(away))


def phases(timer: Array | np.ndarray, dtype) -> Phases:
    """Return the phase in rad of a sine and cosine (2, time) or a linear timer (1, time)."""
    timer = jnp.asarray(timer, dtype)
    if len(timer) == 1:
        return 2 * np.pi * timer[0]
    return arctangent(timer[0], timer[1])


def wave(
    basis: Float[Array, "time weight"], weights: Float[Array, "gene"], items: int
) -> Float[Array, "time item"]:
    """Return the waveform of every item, clipped to ±1; weights of an item are adjacent."""
    rows = weights.reshape(items, basis.shape[1])
    # A written-out sum, see `portable.product`.
    return jnp.clip(jnp.sum(basis[:, None] * rows[None], 2), -1.0, 1.0)


Traits = Mapping[str, Array]
"""Values of each joint or edge, by trait."""

STIFFNESSES = ("stretch", "shear", "bend")


def within(values: Array, bounds: tuple[float, float]) -> Array:
    """Map values from −1 to 1 to the range between bounds."""
    low, high = bounds
    return low + (high - low) * 0.5 * (1 + values)


def shaped(
    world: World, start: State, controls: Controls, layout: Layout | None, traits: Traits
) -> tuple[World, State, Controls, filaments.Layout | None]:
    """Return world, start and controls with the inherited traits of the body, and its layout.

    The body is laid out anew if its shape is inherited; if not, the layout is None.

    The trait `rest_angle` is added to rest angles, in rad; `rest_length` multiplies rest
    lengths.
    """
    stiffness = {name: traits[name] for name in STIFFNESSES if name in traits}
    if stiffness:  # Shape matching is the limit of stiffness 1: a soft body is swept.
        world = replace(world, rods=replace(world.rods, **stiffness), layout=None)
    if layout is None:
        return world, start, controls, None
    dtype = start.positions.dtype
    factor = traits.get("rest_length", jnp.ones(len(layout.angle), dtype))
    turns = traits.get("rest_angle", jnp.zeros(len(layout.joints), dtype))
    turned = product(jnp.asarray(layout.turned, dtype), turns[:, None])[:, 0]
    length = jnp.asarray(controls.rest_length, dtype) * factor
    positions = _laid_out(layout, turned, length) + _middles(layout, start.positions)
    first, second = layout.joints.T
    rest_angle = jnp.asarray(controls.rest_angle, dtype) + turned[second] - turned[first]
    controls = replace(controls, rest_angle=rest_angle, rest_length=length)
    pieces = Groups(jnp.asarray(layout.piece, jnp.int32), _count(layout), ascending=False)
    inherited = filaments.Layout(
        angle=jnp.asarray(layout.angle, dtype) + turned,
        rest_angle=rest_angle,
        turned=jnp.asarray(layout.turned, dtype),
        placed=jnp.asarray(layout.placed, dtype),
        pieces=pieces,
    )
    if world.layout is not None:
        # The same kinematics, from the body that actuators bend.
        world = replace(world, layout=inherited)
    return world, with_bodies(world, start, positions), controls, inherited


def _count(layout: Layout) -> int:
    """Return the number of connected pieces."""
    return int(layout.piece.max()) + 1


def _middles(layout: Layout, positions: Float[Array, "node 2"]) -> Array:
    """Return the mean node of each node's piece, or of all if there is one piece."""
    if _count(layout) == 1:
        return jnp.mean(positions, 0, keepdims=True)
    together = layout.piece[:, None] == layout.piece[None]
    return product(jnp.asarray(together / together.sum(1), positions.dtype), positions)


def _longest(edges: np.ndarray, layout: Layout, length: Array) -> Scalar:
    """Return the longest path along edges of these lengths, as `bodies.extent` finds it."""
    nodes, far = len(layout.piece), jnp.full(len(layout.piece), jnp.inf, length.dtype)

    def walked(distance: Array) -> Array:
        def step(_: Any, distance: Array) -> Array:
            return distance.at[edges].min(distance[edges[:, ::-1]] + length[:, None])

        # No path has as many edges as there are nodes.
        return jax.lax.fori_loop(0, nodes - 1, step, distance)

    first = np.unique(layout.piece, return_index=True)[1]
    near = walked(far.at[first].set(0.0))
    of_pieces = {"segment_ids": layout.piece, "num_segments": _count(layout)}
    farthest = near == jax.ops.segment_max(near, **of_pieces)[layout.piece]
    ends = jax.ops.segment_min(jnp.where(farthest, jnp.arange(nodes), nodes), **of_pieces)
    return jnp.max(walked(far.at[ends].set(0.0)))


def _form(edges: np.ndarray, layout: Layout, positions: Array) -> dict[str, Array]:
    """Return the measures of the form of a body of inherited shape, by name."""
    every = jnp.ones(len(positions), bool), jnp.ones(len(edges), bool)
    return growth.form(positions, edges, *every, jnp, pieces=_count(layout))


def _laid_out(layout: Layout, turned: Array, length: Array) -> Float[Array, "node 2"]:
    """Return node positions relative to the mean of their piece."""
    angle = jnp.asarray(layout.angle, turned.dtype) + turned
    v = jnp.stack([cosine(angle), sine(angle)], 1) * length[:, None]
    return product(jnp.asarray(layout.placed, turned.dtype), v)


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
    """The body's layout, if rest angles or rest lengths are inherited; else None."""
    spread: float = 1.0
    """Genes of new genotypes lie within ± this."""
    faintest: float = 1.0
    """Lowest factor on the angles and on the lengths of new genotypes; the highest is 1."""

    def newcomer(self, *, key: PRNGKeyArray) -> Vector:
        """Draw every gene uniformly, then reduce the control by random factors."""
        genes_key, factor_key = jax.random.split(key)
        genes = uniform_vector(sum(self.parts.values()), self.spread, key=genes_key)
        # Factors are log-uniform: a gait is as likely between 1/4 and 1/2 as between 1/2 and 1.
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
        world, start, controls, inherited = shaped(
            world, start, self.controls, self.layout, traits
        )
        timer = shifted(self.controls.timer, phase)
        basis = self.basis(phases(timer, dtype), self.terms)
        angle = wave(basis, genes["angles"], len(self.controls.joint_nodes))
        length = wave(basis, genes["lengths"], len(self.controls.edges))
        rest = actuated(angle, length, self.controls.ramp, controls)
        given = series_commands(basis, genes["angles"], genes["lengths"], controls)
        driven = Drive(world, start, rest, controller=given, layout=inherited)
        if self.layout is None:
            return driven
        edges, lengths = np.asarray(self.controls.edges), jnp.asarray(controls.rest_length)
        if "rest_length" in self.bounds:
            driven = replace(driven, length=_longest(edges, self.layout, lengths))
        return replace(driven, form=_form(edges, self.layout, start.positions))

    def divided(self, values: Array) -> dict[str, Array]:
        """Return the genes of each part by name."""
        parts, used = {}, 0
        for name, count in self.parts.items():
            parts[name] = values[used : used + count]
            used += count
        return parts


Lengths = Callable[[Array, Array], Array]
"""A function from the body's rest lengths and genes to new rest lengths."""


def scaled(lengths: Array, genes: Array) -> Array:
    """Multiply by exponentials of genes; lengths stay positive."""
    return lengths * jnp.exp(genes)


def added(lengths: Array, genes: Array) -> Array:
    """Add genes in cells, as in the paper; lengths may become negative."""
    return lengths + genes


@dataclass(frozen=True)
class FoldEncoding(Networkless):
    """Genes of any size: changes of the body's rest angles, then of its rest lengths."""

    rest_angle: np.ndarray
    """(joint,) of the body, in rad."""
    rest_length: np.ndarray
    """(edge,) of the body, in cells."""
    steps: int
    lengths: Lengths = scaled

    def newcomer(self, *, key: PRNGKeyArray) -> Vector:
        """Return the unchanged body; nothing is drawn."""
        return Vector(jnp.zeros(len(self.rest_angle) + len(self.rest_length)))

    def drive(
        self, world: World, start: State, genotype: Vector, phase: Scalar | None
    ) -> Drive:
        dtype, joints = start.positions.dtype, len(self.rest_angle)
        genes = genotype.values.astype(dtype)
        rest = Rest(
            jnp.asarray(self.rest_angle, dtype) + genes[:joints],
            self.lengths(jnp.asarray(self.rest_length, dtype), genes[joints:]),
        )
        return Drive(world, start, jnp.zeros((self.steps, 0), dtype), lambda *_: rest)


class Clock(eqx.Module):
    """Phases over time and positions along the body, for plug-in encodings."""

    phase: Float[Array, "time"]
    """Phase of the stroke, in rad."""
    joints: Float[Array, "joint"]
    """Positions of joints along the body, from −1 to 1."""
    edges: Float[Array, "edge"]
    """Positions of the middles of edges, from −1 to 1."""


Act = Callable[[Array, Clock], tuple[Array, Array]]
"""A function from genes to control of joints (time, joint) and edges (time, edge), ±1."""


@dataclass(frozen=True)
class PluginEncoding(Networkless):
    """The encoding of a plug-in's controllers; all creatures have the same body."""

    controls: Controls
    genes: int
    act: Act

    def newcomer(self, *, key: PRNGKeyArray) -> Vector:
        return uniform_vector(self.genes, 1.0, key=key)

    def drive(
        self, world: World, start: State, genotype: Vector, phase: Scalar | None
    ) -> Drive:
        """Return the simulation, in open loop; values of the plug-in beyond ±1 are clipped."""
        dtype, controls = start.positions.dtype, self.controls
        timer = shifted(controls.timer, phase)
        place = np.asarray(controls.sites[0])
        clock = Clock(
            phase=phases(timer, dtype),
            joints=jnp.asarray(place[controls.joint_nodes], dtype),
            edges=jnp.asarray(place[controls.edges].mean(1), dtype),
        )
        outputs = self.act(genotype.values.astype(dtype), clock)
        angle, length = (jnp.clip(one.astype(dtype), -1.0, 1.0) for one in outputs)
        return Drive(world, start, actuated(angle, length, controls.ramp, controls))
