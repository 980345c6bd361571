"""The controller: what a CPPN sees, what its outputs mean and how its genome varies."""

from typing import Literal, Self

from pydantic import Field, model_validator

from .base import Part, unit
from .sources import CPPN, NEAT, PAPER, after, source

INPUTS = {"sine-cosine": ("position", "sine", "cosine"), "linear": ("position", "time")}
OUTPUTS = ("rest_angle", "rest_length")


class Actuation(Part):
    """How far, how fast and with which clock rest angles and rest lengths change."""

    timer: Literal["sine-cosine", "linear"] = Field(
        default="sine-cosine", json_schema_extra=source(f"linear: {PAPER}")
    )
    """Time as sine and cosine of the phase, or rising linearly from 0 to 1."""
    period: float = Field(default=100.0, ge=4.0, le=1e6, json_schema_extra=unit("steps"))
    """Period of the sine and cosine."""
    ramp: float = Field(default=1.0, ge=0.0, le=100.0, json_schema_extra=unit("periods"))
    """Over how many periods the actuation grows from nothing to its full size."""
    angle_scale: float = Field(default=0.1, gt=0.0, le=1.5, json_schema_extra=unit("rad"))
    """Rest angles are the body's own plus this times what the controller says, −1 to 1."""
    length_scale: float = Field(default=0.1, ge=0.0, le=0.8)
    """Rest lengths are the body's own times 1 + this times what the controller says."""


class Sight(Actuation):
    """What a network is told at every node of the body."""

    position: Literal["signed", "unit"] = Field(
        default="signed", json_schema_extra=source(f"unit: {PAPER}")
    )
    """Position along the filament from −1 to 1, or from 0 to 1."""
    sense_energy: bool = Field(default=False, json_schema_extra=source(PAPER))
    """Whether the network also sees the energy at its node, which closes the loop."""

    @property
    def inputs(self) -> tuple[str, ...]:
        return INPUTS[self.timer] + (("energy",) if self.sense_energy else ())


class Control(Sight):
    """One CPPN, evaluated at every joint and edge, sets rest angles and rest lengths."""

    model_config = after(CPPN)

    encoding: Literal["cppn"] = "cppn"
    recurrent: bool = False
    """Whether the network may have cycles: its nodes are updated together, once a step, and
    keep their values from step to step."""

    @property
    def outputs(self) -> tuple[str, ...]:
        return OUTPUTS


class Genome(Part):
    """Room for a CPPN, and how often each kind of mutation happens to a child."""

    model_config = after(f"{NEAT}, section 3.1", seldom=True)

    max_nodes: int = Field(default=24, ge=8, le=1024, json_schema_extra=unit("nodes"))
    """Room for nodes, inputs and outputs among them."""
    max_connections: int = Field(
        default=64, ge=8, le=8192, json_schema_extra=unit("connections")
    )
    """Room for connections, disabled ones among them."""
    weight_rate: float = Field(default=0.6, ge=0.0, le=1.0)
    """Probability, for each weight and bias, to be perturbed."""
    weight_step: float = Field(default=1.0, gt=0.0, le=10.0)
    """Standard deviation of a perturbation."""
    replace_rate: float = Field(default=0.05, ge=0.0, le=1.0)
    """Probability, for each weight and bias, to be drawn anew."""
    activation_rate: float = Field(default=0.1, ge=0.0, le=1.0)
    """Probability, for each node, to get another activation."""
    toggle_rate: float = Field(default=0.02, ge=0.0, le=1.0)
    """Probability, for each connection, to be switched on or off."""
    add_node_rate: float = Field(default=0.15, ge=0.0, le=1.0)
    """Probability that a connection is split by a new node."""
    add_connection_rate: float = Field(default=0.25, ge=0.0, le=1.0)
    """Probability that two nodes are newly connected."""

    @model_validator(mode="after")
    def refuse_cramped(self) -> Self:
        if self.max_connections < self.max_nodes:
            raise ValueError(
                f"`max_connections` must be at least `max_nodes` ({self.max_nodes}), "
                f"got {self.max_connections}"
            )
        return self
