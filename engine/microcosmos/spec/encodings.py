"""Encodings beside the plain CPPN: what is inherited, and within which bounds."""

from itertools import pairwise
from typing import Annotated, Any, Literal, Self

from pydantic import Discriminator, Field, Tag, model_validator
from pydantic.json_schema import SkipJsonSchema

from .. import bodies, plugins
from .base import Part, unit
from .body import Body, made_elsewhere, shape
from .control import OUTPUTS, Actuation, Control, Genome, Sight
from .plugins import PluginName, PluginVersion, complete_plugin

TRAITS = {
    "rest_angle": (-3.0, 3.0),
    "rest_length": (0.2, 5.0),
    "stretch": (0.0, 1.0),
    "shear": (0.0, 1.0),
    "bend": (0.0, 1.0),
}
"""What of a body can be inherited, and how far its bounds may lie."""

OF_JOINTS = ("rest_angle", "bend")
"""Traits that joints have; the others are of edges."""


class Free(Part):
    """Bounds of a measure that is inherited."""

    low: float
    """Least value."""
    high: float
    """Greatest value."""

    @model_validator(mode="after")
    def refuse_empty(self) -> Self:
        if self.high <= self.low:
            raise ValueError(f"`high` must be above `low` ({self.low:g}), got {self.high:g}")
        return self


class Shaping(Part):
    """Which measures of the body are inherited too."""

    rest_angle: Free | None = Field(default=None, json_schema_extra=unit("rad"))
    """Bounds in rad of what is added to each of the body's rest angles; empty: nothing."""
    rest_length: Free | None = None
    """Bounds of a factor on each of the body's rest lengths; empty: 1."""
    stretch: Free | None = None
    """Bounds of each edge's stretching stiffness; empty: the body's own."""
    shear: Free | None = None
    """Bounds of each edge's shearing stiffness; empty: the body's own."""
    bend: Free | None = None
    """Bounds of each joint's bending stiffness; empty: the body's own."""

    @property
    def free(self) -> dict[str, tuple[float, float]]:
        """Bounds of what is inherited, by name."""
        found = {name: getattr(self, name) for name in TRAITS}
        return {name: (one.low, one.high) for name, one in found.items() if one is not None}

    @model_validator(mode="after")
    def refuse_impossible(self) -> Self:
        for name, (low, high) in self.free.items():
            least, most = TRAITS[name]
            if low < least or high > most:
                raise ValueError(
                    f"`{name}` must have bounds from {least:g} to {most:g}, got {low:g} to "
                    f"{high:g}"
                )
        return self


class Direct(Actuation, Shaping):
    """Genes are the control of every joint and edge and, where free, measures of the body."""

    encoding: Literal["direct"] = "direct"
    waveform: Literal["fourier", "table"] = "fourier"
    """A sum of sines and cosines of the phase, or a table with straight lines in between; its
    time is the period, or the whole simulation where the timer is linear."""
    terms: int = Field(default=2, ge=1, le=256)
    """Harmonics of the sum, or entries of the table, for every joint and edge."""
    spread: float = Field(default=1.0, gt=0.0, le=1.0)
    """Genes of newcomers lie evenly within ± this; all genes lie within ±1."""
    faintest: float = Field(default=0.01, gt=0.0, le=1.0)
    """Newcomers' angles, and lengths, are made fainter by a factor from this to 1, even on a
    log scale: many independent genes would else come to the same effort in everybody."""

    @property
    def inputs(self) -> tuple[str, ...]:
        """None: there is no network."""
        return ()

    @property
    def outputs(self) -> tuple[str, ...]:
        """None: there is no network."""
        return ()

    @property
    def weights(self) -> int:
        """Genes of one joint's, or one edge's, control."""
        return self.terms * (2 if self.waveform == "fourier" else 1)

    @model_validator(mode="after")
    def refuse_single(self) -> Self:
        if self.waveform == "table" and self.terms < 2:
            raise ValueError(f"`terms` of a table must be at least 2, got {self.terms}")
        return self

    def parts(self, body: bodies.Body) -> dict[str, int]:
        """How many genes each trait has, then the control of angles and of lengths."""
        joints, edges = len(body.joints), len(body.edges)
        sizes = {name: joints if name in OF_JOINTS else edges for name in self.free}
        if "rest_angle" in sizes:
            sizes["rest_angle"] = len(bodies.unfolded(body).joints)
        return sizes | {"angles": self.weights * joints, "lengths": self.weights * edges}


class Weights(Sight):
    """Genes are the weights and biases of a network whose layers are given."""

    encoding: Literal["weights"] = "weights"
    hidden: Annotated[
        tuple[Annotated[int, Field(ge=1, le=256, json_schema_extra=unit("nodes"))], ...],
        Field(min_length=1, max_length=8),
    ] = (8, 8)
    """Nodes of each layer between inputs and outputs."""
    activation: Literal["tanh", "sin", "sigmoid", "relu", "gaussian"] = "sin"
    """Of the hidden nodes; outputs go through tanh."""
    scale: float = Field(default=3.0, gt=0.0, le=100.0)
    """Weights and biases are this times their genes, which are from −1 to 1."""

    @property
    def outputs(self) -> tuple[str, ...]:
        return OUTPUTS

    @property
    def sizes(self) -> tuple[int, ...]:
        """Nodes of all layers."""
        return (len(self.inputs), *self.hidden, len(self.outputs))


class Grown(Sight, Shaping):
    """One CPPN sets rest angles and lengths, and before that grows the chain itself."""

    encoding: Literal["cppn-body"] = "cppn-body"
    min_nodes: int = Field(default=4, ge=3, le=4096, json_schema_extra=unit("nodes"))
    """So many nodes there are at least; at most those of the body."""
    rest_angle: Free | None = Field(
        default=Free(low=-0.15, high=0.15), json_schema_extra=unit("rad")
    )
    """Bounds in rad of what is added to each of the body's rest angles; empty: nothing."""
    rest_length: Free | None = Free(low=0.75, high=1.25)
    """Bounds of a factor on each of the body's rest lengths; empty: 1."""
    stretch: Free | None = Free(low=0.5, high=1.0)
    """Bounds of each edge's stretching stiffness; empty: the body's own."""
    shear: Free | None = Free(low=0.1, high=1.0)
    """Bounds of each edge's shearing stiffness; empty: the body's own."""
    bend: Free | None = Free(low=0.1, high=1.0)
    """Bounds of each joint's bending stiffness; empty: the body's own."""

    @property
    def outputs(self) -> tuple[str, ...]:
        """The control, the body's free measures, and where it ends."""
        return (*OUTPUTS, *(f"body_{name}" for name in self.free), "growth")


class PluginControl(Actuation):
    """Genes are numbers; a plug-in turns them into movements."""

    encoding: PluginName
    plugin: PluginVersion

    complete = complete_plugin(("encoding",), "encoding")

    @property
    def inputs(self) -> tuple[str, ...]:
        """None: there is no network."""
        return ()

    @property
    def outputs(self) -> tuple[str, ...]:
        """None: there is no network."""
        return ()

    def genes(self, body: bodies.Body) -> int:
        """Numbers of a creature with such a body."""
        sizes = self.plugin.sizes
        each = {"genes": 1, "per_joint": len(body.joints), "per_edge": len(body.edges)}
        return sum(count * sizes.get(name, 0) for name, count in each.items())


MOST_GENES = 65_536
"""Numbers of one creature."""

NAMES = ("cppn", "direct", "weights", "cppn-body")


def kind(value: Any) -> Any:
    """The tag of a controller; one that names no encoding is a CPPN."""
    if isinstance(value, dict):
        name = value.get("encoding", "cppn")
    else:
        name = getattr(value, "encoding", None)
    return "plugin" if plugins.is_plugin(name) else name


Controller = Annotated[
    Annotated[Control, Tag("cppn")]
    | Annotated[Direct, Tag("direct")]
    | Annotated[Weights, Tag("weights")]
    | Annotated[Grown, Tag("cppn-body")]
    | Annotated[SkipJsonSchema[PluginControl], Tag("plugin")],
    Discriminator(
        kind,
        custom_error_type="unknown_encoding",
        custom_error_message="`encoding` must be one of " + ", ".join(NAMES),
    ),
]
"""What sets rest angles and rest lengths, and is inherited."""


def lengthening(control: Controller) -> float:
    """By how much of its own length a controller may stretch a body."""
    if isinstance(control, Shaping) and control.rest_length is not None:
        return control.rest_length.high * (1 + control.length_scale) - 1
    return control.length_scale


def refuse_unfit(control: Controller, body: Body) -> None:
    """The body must be one that the encoding can change as it is asked to."""
    if made_elsewhere(body):  # Whoever can make it looks.
        return
    whole = shape(body)
    if isinstance(control, Grown) and body.builder != "chain":
        raise ValueError(
            f"`body.builder` must be 'chain' where a CPPN grows the body, got {body.builder!r}"
        )
    if isinstance(control, Grown) and control.min_nodes > len(whole.positions):
        raise ValueError(
            f"`control.min_nodes` must be at most the body's {len(whole.positions)} nodes, got "
            f"{control.min_nodes}"
        )
    if isinstance(control, Shaping) and {"rest_angle", "rest_length"} & set(control.free):
        try:
            bodies.unfolded(whole)
        except ValueError as error:
            raise ValueError(
                f"`control.rest_angle` and `rest_length` must be empty for this `body`: {error}"
            ) from error
    if (count := genes(control, whole)) > MOST_GENES:
        raise ValueError(f"a creature must have at most {MOST_GENES} numbers, got {count}")


def refuse_cramped(control: Controller, genome: Genome) -> None:
    """There must be room for networks in which every input leads to every output."""
    if not isinstance(control, Control | Grown):
        return
    inputs, outputs = len(control.inputs), len(control.outputs)
    for name, needed in (
        ("max_nodes", inputs + outputs),
        ("max_connections", inputs * outputs),
    ):
        if (found := getattr(genome, name)) < needed:
            raise ValueError(
                f"`genome.{name}` must be at least {needed} for {inputs} inputs and {outputs} "
                f"outputs, got {found}"
            )


def genes(control: Controller, body: bodies.Body) -> int:
    """Length of a vector of genes; 0 where they are a network's."""
    if isinstance(control, Direct):
        return sum(control.parts(body).values())
    if isinstance(control, PluginControl):
        return control.genes(body)
    if isinstance(control, Weights):
        return sum((a + 1) * b for a, b in pairwise(control.sizes))
    return 0
