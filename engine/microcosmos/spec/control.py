"""Controllers: actuation, the inputs of networks, the CPPN, and the mutation of its genome."""

from typing import Literal, Self

from pydantic import model_validator

from .base import CPPN, NEAT, OURS, PAPER, PERCEPTIBLE, PHASE_LAG, Part, field, refuse, sourced

ANATOMY = ("position", "distance", "side", "limb", "x", "y")
"""Inputs that say where a node is in the body; without anatomy only the first."""
SLOWEST = 1e-4
"""Least limit of a node's speed in cells per step: the spacing of places from 1,024 cells on is
1.2e-4 in single precision, so that slower nodes would stand still there."""
CLOCKS = {"sine-cosine": ("sine", "cosine"), "linear": ("time",)}
OUTPUTS = ("rest_angle", "rest_length")


class Actuation(Part):
    """Amplitude and timing of rest angles and rest lengths."""

    timer: Literal["sine-cosine", "linear"] = field("sine-cosine", source=f"linear: {PAPER}")
    """Time input: sine and cosine of the phase, or linear from 0 to 1."""
    period: float = field(200.0, ge=4.0, le=1e6, unit="steps")
    """Period of the sine and cosine."""
    ramp: float = field(1.0, ge=0.0, le=100.0, unit="periods")
    """Time in which the actuation grows from zero to its full amplitude."""
    angle_scale: float = field(0.5, ge=PERCEPTIBLE, le=1.5, unit="rad")
    """Amplitude of rest angles: the controller's output (−1 to 1) times this is added."""
    length_scale: float = field(0.1, ge=0.0, le=0.8)
    """Amplitude of rest lengths: factor 1 + this times the controller's output (−1 to 1)."""
    # Without the three bounds of actuators 91 % of the elites of `standard` were at a limit
    # (docs/physics.md, "Actuators").
    max_speed: float | None = field(0.06, ge=SLOWEST, le=0.5, unit="cells/step", source=OURS)
    """Largest speed at which actuators move a node, in the frame of the body: where the gait is
    faster, its clock slows; empty: unlimited."""
    lag: float = field(24.0, ge=0.0, le=10_000.0, unit="steps", source=OURS)
    """Time constant with which the body follows commands; it bounds the force."""
    max_bend: float | None = field(4.2, ge=PERCEPTIBLE, le=100.0, unit="rad", source=OURS)
    """Largest angle that actuators add between any two edges; empty: unlimited."""

    @property
    def bounded(self) -> bool:
        """Return whether actuators have finite means."""
        return self.max_speed is not None or self.max_bend is not None or self.lag > 0


class NetworkInputs(Actuation):
    """Inputs of a network at every node of the body."""

    position: Literal["signed", "unit"] = field("signed", source=f"unit: {PAPER}")
    """Position along the filament, or with `anatomy` along the limb: −1 to 1 (signed) or 0 to 1
    (unit)."""
    anatomy: bool = False
    """Add the place of the node in the body as inputs: distance from the first node along edges
    (0 to 1), side of the body's axis (−1, 0 or 1), limb (−1 to 1), and x and y in the body as
    drawn (−1 to 1). Networks can then command limbs apart."""
    # With these inputs the fittest of `standard` swim 0.56 to 0.64 lengths in 1,000 steps,
    # without them 0.50 (docs/evolution.md, "Encodings").
    wave_number: float | None = field(1.0, ge=-10.0, le=10.0, unit="waves", source=PHASE_LAG)
    """Waves along the body of a second sine and cosine, which travel from its first node to its
    last, or with `anatomy` outward along every limb; empty, or with a linear timer: none."""
    sense_energy: bool = field(False, source=PAPER)
    """Add the energy at the node as an input (closed loop)."""

    @property
    def waves(self) -> float | None:
        """Return the wave number of the travelling inputs, if there are any."""
        return None if self.timer == "linear" else self.wave_number

    @property
    def inputs(self) -> tuple[str, ...]:
        sites = ANATOMY if self.anatomy else ANATOMY[:1]
        travelling = () if self.waves is None else ("wave_sine", "wave_cosine")
        sensed = ("energy",) if self.sense_energy else ()
        return sites + CLOCKS[self.timer] + travelling + sensed


class Control(NetworkInputs):
    """One CPPN, evaluated at every joint and edge, sets rest angles and rest lengths."""

    model_config = sourced(CPPN)

    encoding: Literal["cppn"] = "cppn"
    recurrent: bool = False
    """Allow cycles: all nodes are updated once a step and keep their values between steps."""

    @property
    def outputs(self) -> tuple[str, ...]:
        return OUTPUTS


class Genome(Part):
    """Size limits of a CPPN's genome, and NEAT's mutation rates per child."""

    model_config = sourced(f"{NEAT}, section 3.1", seldom=True)

    max_nodes: int = field(24, ge=8, le=1024, unit="nodes")
    """Maximum number of nodes, inputs and outputs included."""
    max_connections: int = field(64, ge=8, le=8192, unit="connections")
    """Maximum number of connections, disabled ones included."""
    weight_rate: float = field(0.6, ge=0.0, le=1.0)
    """Probability that a weight or bias is perturbed."""
    weight_step: float = field(1.0, ge=PERCEPTIBLE, le=10.0)
    """Standard deviation of a perturbation."""
    replace_rate: float = field(0.05, ge=0.0, le=1.0)
    """Probability that a weight or bias is drawn anew."""
    activation_rate: float = field(0.1, ge=0.0, le=1.0)
    """Probability that a node gets another activation."""
    toggle_rate: float = field(0.02, ge=0.0, le=1.0)
    """Probability that a connection is enabled or disabled."""
    add_node_rate: float = field(0.15, ge=0.0, le=1.0)
    """Probability that a new node splits a connection."""
    add_connection_rate: float = field(0.25, ge=0.0, le=1.0)
    """Probability that a new connection joins two nodes."""
    # Then fitness tests the new body with a controller that is known (docs/bodies.md).
    body_rate: float = field(0.35, ge=0.0, le=1.0, source=OURS)
    """Probability that the structure of a body plan changes, by one segment; the network then
    stays."""
    shape_rate: float = field(0.35, ge=0.0, le=1.0, source=OURS)
    """Probability that numbers of a body plan vary, where its structure does not change."""
    segment_rate: float = field(0.25, ge=0.0, le=1.0, source=OURS)
    """Probability that one of them does: a segment's place, angle, nodes, curl, stiffness."""

    @model_validator(mode="after")
    def refuse_cramped(self) -> Self:
        refuse(
            self.max_connections < self.max_nodes,
            "max_connections",
            f"must be at least `max_nodes` ({self.max_nodes}), got {self.max_connections}",
            least=self.max_nodes,
        )
        return self
