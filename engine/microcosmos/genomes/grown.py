"""A CPPN that grows a chain, then sets its rest angles and rest lengths."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, PRNGKeyArray

from ..bodies import Layout
from ..bodies.growth import form
from ..world import State, World, edges_there, grown_nodes
from .commands import network_commands
from .control import drive_feed_forward, network_size
from .cppn import CPPN, evaluate, minimal
from .development import OUTPUTS, Controls, network_inputs
from .encoding import Drive, Scalar, shifted
from .traits import Shaped, cut, shaped, within

JOINT_TRAITS = ("rest_angle", "bend")
"""Traits of joints; the others are traits of edges."""


@dataclass(frozen=True)
class Grown:
    """Body and controller by one network; the body's outputs are read at time 0."""

    controls: Controls
    room: tuple[int, int]
    bounds: Mapping[str, tuple[float, float]]
    """Bounds of the inherited traits, in the order of the outputs after the control's two."""
    min_nodes: int
    layout: Layout

    segments = None

    @property
    def outputs(self) -> int:
        """Outputs of the network: control, inherited traits, growth."""
        return OUTPUTS + len(self.bounds) + 1

    def newcomer(self, *, key: PRNGKeyArray) -> CPPN:
        return minimal(key, self.controls.inputs, self.outputs, *self.room)

    def drive(self, world: World, start: State, genotype: CPPN, phase: Scalar | None) -> Drive:
        """Open loop, or closed loop where the network senses."""
        body = self.grow(world, start, genotype)
        timer = shifted(self.controls.timer, phase)
        controls = replace(body.controls, timer=timer)

        def read(inputs):
            return evaluate(genotype, inputs, OUTPUTS)

        driven = drive_feed_forward(read, controls, body.world, body.start)
        given = network_commands(genotype, body.controls, phase)
        there = edges_there(body.world)
        shape = form(
            body.start.positions, body.world.rods.edges, grown_nodes(body.world), there, jnp
        )
        return replace(driven, length=body.length, controller=given, form=shape)

    def grow(self, world: World, start: State, genotype: CPPN) -> Shaped:
        """Return the body that a network grows."""
        dtype = start.positions.dtype
        zero = jnp.zeros(self.controls.nodes, dtype) if self.controls.senses else None
        timer = jnp.zeros((len(self.controls.timer), 1), dtype)
        inputs = network_inputs(self.controls, timer, zero)
        outputs = evaluate(genotype, inputs, self.outputs)[OUTPUTS:]
        traits = {
            name: within(jnp.tanh(self._trait(name, values)), bounds)
            for (name, bounds), values in zip(self.bounds.items(), outputs[:-1], strict=True)
        }
        whole = shaped(world, start, self.controls, self.layout, traits)
        return cut(whole, self.present(outputs[-1]))

    def present(self, growth: Float[Array, "node"]) -> Bool[Array, "node"]:
        """Select the nodes before the first with growth ≤ 0, and at least `min_nodes`."""
        return (jnp.cumsum(growth <= 0) == 0) | (jnp.arange(len(growth)) < self.min_nodes)

    def size(self, genotype: CPPN) -> tuple[Array, Array]:
        return network_size(genotype, self.controls.inputs + self.outputs)

    def _trait(self, name: str, values: Float[Array, "node"]) -> Float[Array, "item"]:
        """Read a joint's value at its node and an edge's as the mean of its ends."""
        if name in JOINT_TRAITS:
            return values[self.controls.joint_nodes]
        ends = self.controls.edges
        return 0.5 * (values[ends[:, 0]] + values[ends[:, 1]])
