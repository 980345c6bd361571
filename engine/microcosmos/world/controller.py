"""Descriptions of controllers and actuators that the native kernel carries out."""

import equinox as eqx
from jaxtyping import Array, Float, Int

from .. import filaments

Scalar = Float[Array, ""]

SENSES = (
    "energy",
    "energy_across",
    "energy_along",
    "flow_along",
    "flow_across",
    "touch",
    "account",
)
"""What a node may sense, see `world.senses`; whole evaluations know the first alone."""


class Network(eqx.Module):
    """A network at every node of a body; rows are inputs, two outputs, then hidden nodes."""

    activation: Int[Array, "row"]
    """Number in `naming.ACTIVATIONS`; −1: an input, or no node."""
    bias: Float[Array, "row"]
    source: Int[Array, "link"]
    """Row from which a link comes; −1: there is no link."""
    target: Int[Array, "link"]
    weight: Float[Array, "link"]
    sites: Float[Array, "site node"]
    """Inputs that tell a node its place in the body."""
    lag: Float[Array, "node"] | None
    """Phase lag of a travelling sine and cosine, in rad; None: there are none."""
    timer: Float[Array, "time clock"]
    joint_node: Int[Array, "joint"]
    """The node whose outputs a joint takes."""
    gain: Float[Array, "joint"]
    """Factor on what the network commands for the angle of a joint."""
    recurrent: bool = eqx.field(static=True)
    senses: tuple[str, ...] = eqx.field(static=True)
    """What the node senses, of `SENSES` in their order, as its last inputs: they close the
    loop."""


class Series(eqx.Module):
    """Sums of functions of time, within ±1, for every joint and then every edge."""

    basis: Float[Array, "time term"]
    genes: Float[Array, "term item"]


class Actuators(eqx.Module):
    """Bounds on what a body does; None, or a lag of 0, switches one off."""

    layout: filaments.Layout
    max_speed: float | None = eqx.field(static=True, default=None)
    """Cells a step of the fastest node, in the frame that moves and turns with the body."""
    lag: float = eqx.field(static=True, default=0.0)
    """Time constant of the first-order response, in steps."""
    max_bend: float | None = eqx.field(static=True, default=None)
    """Largest angle that is added between any two edges, in rad."""

    def __check_init__(self):
        for name in ("max_speed", "max_bend"):
            bound = getattr(self, name)
            if bound is not None and not bound > 0:
                raise ValueError(
                    f"`{name}` must be above 0, or None for no bound; got {bound}."
                )


class Controller(eqx.Module):
    """The source of commands for rest angles and rest lengths, −1 to 1, and their scales."""

    commands: Network | Series
    ramp: Float[Array, "time"]
    rest_angle: Float[Array, "joint"]
    rest_length: Float[Array, "edge"]
    angle_scale: float = eqx.field(static=True)
    length_scale: float = eqx.field(static=True)
    phase: Scalar | None = None
    """Lead of a periodic timer, in rad."""
    actuators: Actuators | None = None

    @property
    def senses(self) -> bool:
        """True if rest shapes depend on the simulation."""
        return isinstance(self.commands, Network) and bool(self.commands.senses)
