"""A body plan that grows the body, and a CPPN that drives all of its joints and edges."""

from dataclasses import dataclass, replace
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, PRNGKeyArray

from .. import filaments
from ..bodies.growth import (
    PLAN_DRAWS,
    Capacity,
    Grown,
    Segments,
    Skeleton,
    form,
    grow,
    random_plan,
    skeleton,
)
from ..groups import single
from ..world import State, World, with_bodies
from .commands import network_commands
from .control import drive_feed_forward, network_size
from .cppn import evaluate, minimal
from .development import OUTPUTS, Controls
from .encoding import Drive, Scalar, shifted
from .genotype import BodyGraph


@dataclass(frozen=True)
class BodyGraphEncoding:
    """The encoding of two-part genomes: a plan, and a network that knows each node's place."""

    controls: Controls
    """Clock and scales of the network; fields of the body are filled in as it grows."""
    room: tuple[int, int]
    capacity: Capacity
    segments: Segments
    inputs: int
    waves: float | None = None
    """Waves of the travelling inputs from the first node to the farthest."""
    unit: bool = False
    """True if positions along segments are from 0 to 1, false if from −1."""
    softest: float = 1.0
    """Share of a joint's error that a step removes at stiffness 0; 1: all joints are stiff."""

    def newcomer(self, *, key: PRNGKeyArray) -> BodyGraph:
        plan_key, network_key = jax.random.split(key)
        network = minimal(network_key, self.inputs, OUTPUTS, *self.room)
        uniform = jax.random.uniform(plan_key, (PLAN_DRAWS,))
        return BodyGraph(random_plan(uniform, self.segments, jnp), network)

    def drive(
        self, world: World, start: State, genotype: BodyGraph, phase: Scalar | None
    ) -> Drive:
        """Return the simulation, in closed loop if the network senses."""
        grown, bones = self.develop(genotype)
        world, start = self._place(world, start, grown, bones)
        controls = self._controls(grown, bones)
        driven = replace(controls, timer=shifted(self.controls.timer, phase))
        network = genotype.network

        def read(inputs):
            return evaluate(network, inputs, OUTPUTS)

        driven = drive_feed_forward(read, driven, world, start)
        return replace(
            driven,
            length=self.capacity.spacing * jnp.max(_among(grown, grown.distance)),
            layout=world.layout,
            form=_form(grown, bones),
            controller=network_commands(network, controls, phase),
        )

    def develop(self, genotype: BodyGraph) -> tuple[Grown, Skeleton]:
        """Return the body of a genotype and its kinematics."""
        grown = grow(genotype.plan, self.capacity, jnp, _loop)
        return grown, skeleton(grown, self.capacity, jnp, _loop)

    def size(self, genotype: BodyGraph) -> tuple[Array, Array]:
        return network_size(genotype.network, self.inputs + OUTPUTS)

    def _place(
        self, world: World, start: State, grown: Grown, bones: Skeleton
    ) -> tuple[World, State]:
        """Return the world and its start with the grown body, centred on the body before."""
        dtype = start.positions.dtype
        ones, stiff = bones.edge_present.astype(dtype), bones.bends.astype(dtype)
        rods = filaments.Rods(
            edges=bones.edges,
            edge_colours=(),  # Shapes are matched, and no constraint is swept.
            joint_colours=(),
            stretch=ones,
            shear=ones,
            bend=self._bend(bones).astype(dtype) * stiff,
            joints=bones.joints,
        )
        groups = single(self.capacity.nodes)
        layout = filaments.Layout(
            angle=bones.angle.astype(dtype),
            rest_angle=bones.rest_angle.astype(dtype),
            turned=bones.turned.astype(dtype),
            placed=bones.placed.astype(dtype),
            pieces=groups,
            bends=bones.bends,
            bend=rods.bend if self.softest < 1 else None,
        )
        world = replace(world, rods=rods, groups=groups, layout=layout, present=grown.present)
        positions = grown.positions.astype(dtype)
        count = jnp.sum(grown.present)
        inside = jnp.where(grown.present[:, None], positions, 0.0)
        centred = positions - (jnp.sum(inside, 0) / count)[None]
        # Absent nodes rest in the middle, where they are finite and within the box.
        centred = jnp.where(grown.present[:, None], centred, 0.0)
        placed = centred + jnp.mean(start.positions, 0)[None]
        return world, with_bodies(world, start, placed)

    def _bend(self, bones: Skeleton) -> Array:
        """Return the share of each joint's error that a step removes."""
        if self.softest == 1:
            return jnp.ones_like(bones.stiffness)
        # From `softest` to 1, by equal factors for equal changes of the gene.
        return jnp.exp(np.log(self.softest) * (1 - bones.stiffness))

    def _controls(self, grown: Grown, bones: Skeleton) -> Controls:
        """Return controls with the inputs at every node and the rest shape of the body."""
        dtype = grown.positions.dtype
        away = grown.distance[0]
        share = away / jnp.maximum(jnp.max(_among(grown, away)), 1.0)
        present = grown.present[:, None]
        low = jnp.min(jnp.where(present, grown.positions, jnp.inf), 0)
        high = jnp.max(jnp.where(present, grown.positions, -jnp.inf), 0)
        half = jnp.maximum(jnp.max(high - low) / 2, 1e-6)
        x, y = ((grown.positions - (low + high)[None] / 2) / half).T
        along = 0.5 * (1 + grown.along) if self.unit else grown.along
        sites = jnp.stack([along, share, grown.side, grown.limb, x, y])
        return replace(
            self.controls,
            sites=jnp.where(grown.present[None], sites, 0.0),
            edges=bones.edges,
            joint_nodes=bones.driver,
            gain=bones.hand,
            rest_angle=bones.rest_angle,
            rest_length=jnp.full(len(bones.edges), self.capacity.spacing, dtype),
            wave=None if self.waves is None else 2 * np.pi * self.waves * share,
        )


def _form(grown: Grown, bones: Skeleton) -> dict[str, Array]:
    """Return the measures of form by name, with the segments that found no room."""
    measures = form(grown.positions, bones.edges, grown.present, bones.edge_present, jnp)
    return measures | {"ungrown": grown.ungrown.astype(grown.positions.dtype)}


def _loop(count: int, step: Any, state: Any) -> Any:
    def kept(number, before):
        # JAX widens sums of whole numbers where it has 64 bits; a loop's state keeps its types.
        after = step(number, before)
        return jax.tree.map(lambda one, old: one.astype(old.dtype), after, before)

    return jax.lax.fori_loop(0, count, kept, state)


def _among(grown: Grown, values: Array) -> Array:
    """Return distances with 0 for absent nodes, on both axes if there are two."""
    for axis in range(values.ndim):
        shape = [1] * values.ndim
        shape[axis] = -1
        values = jnp.where(grown.present.reshape(shape), values, 0.0)
    return values
