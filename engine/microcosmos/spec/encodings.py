"""Encodings beside the plain CPPN: their genes and the bounds of inherited traits."""

from typing import Annotated, ClassVar, Literal, Self

from pydantic import Tag, model_validator
from pydantic.json_schema import SkipJsonSchema

from .. import bodies
from ..bodies.layout import MAX_NODES
from ..invalid import InvalidField
from ..measures import refuse_empty_axis
from .base import ENCODINGS, PERCEPTIBLE, Part, field, name_in, one_of, refuse
from .body import Body, GrownBody, is_unavailable, shape
from .control import OUTPUTS, Actuation, Control, Genome, NetworkInputs
from .plugins import PluginName, PluginVersion, complete_plugin

TRAITS = {
    "rest_angle": (-3.0, 3.0),
    "rest_length": (0.2, 5.0),
    "stretch": (0.0, 1.0),
    "shear": (0.0, 1.0),
    "bend": (0.0, 1.0),
}
"""Traits of a body that can be inherited, and the limits of their bounds."""

JOINT_TRAITS = ("rest_angle", "bend")
"""Traits of joints; the others are traits of edges."""


class Bounds(Part):
    """Bounds of an inherited trait."""

    low: float
    """Lowest value."""
    high: float
    """Highest value."""

    @model_validator(mode="after")
    def refuse_empty(self) -> Self:
        refuse_empty_axis(self.low, self.high)
        return self


class Direct(Actuation):
    """Genes are the control of every joint and edge, and the inherited traits of the body."""

    encoding: Literal["direct"] = "direct"
    waveform: Literal["fourier", "table"] = "fourier"
    """Sum of sines and cosines of the phase, or a table with linear interpolation. Its time is
    the period, or the whole simulation with a linear timer."""
    terms: int = field(2, ge=1, le=256)
    """Harmonics of the sum, or entries of the table, per joint and edge."""
    spread: float = field(1.0, ge=PERCEPTIBLE, le=1.0)
    """Initial genes are drawn uniformly within ± this; all genes lie within ±1."""
    faintest: float = field(0.01, ge=PERCEPTIBLE, le=1.0)
    """Smallest factor on a new genome's angles and on its lengths, drawn log-uniformly up to
    1. Without it, many independent genes give all new genomes the same effort."""
    rest_angle: Bounds | None = field(None, unit="rad")
    """Bounds of the angle added to each rest angle; empty: none."""
    rest_length: Bounds | None = None
    """Bounds of the factor on each rest length; empty: 1."""
    stretch: Bounds | None = None
    """Bounds of each edge's stretching stiffness; empty: the body's."""
    shear: Bounds | None = None
    """Bounds of each edge's shearing stiffness; empty: the body's."""
    bend: Bounds | None = None
    """Bounds of each joint's bending stiffness; empty: the body's."""

    inputs: ClassVar[tuple[str, ...]] = ()
    outputs: ClassVar[tuple[str, ...]] = ()

    @property
    def weights(self) -> int:
        """Return the number of genes that control one joint or edge."""
        return self.terms * (2 if self.waveform == "fourier" else 1)

    @property
    def traits(self) -> dict[str, tuple[float, float]]:
        """Return the bounds of the inherited traits, by name."""
        bounds = {name: getattr(self, name) for name in TRAITS}
        return {name: (one.low, one.high) for name, one in bounds.items() if one is not None}

    @model_validator(mode="after")
    def refuse_impossible(self) -> Self:
        for name, (low, high) in self.traits.items():
            least, most = TRAITS[name]
            refuse(
                low < least or high > most,
                name,
                f"must have bounds from {least:g} to {most:g}, got {low:g} to {high:g}",
            )
        if self.waveform == "table" and self.terms < 2:
            reason = f"must be at least 2 for a table, got {self.terms}"
            raise InvalidField("terms", reason, least=2)
        return self

    def parts(self, body: bodies.Body) -> dict[str, int]:
        """Return the genes of each trait, then of the control of angles and of lengths."""
        joints, edges = len(body.joints), len(body.edges)
        sizes = {name: joints if name in JOINT_TRAITS else edges for name in self.traits}
        return sizes | {"angles": self.weights * joints, "lengths": self.weights * edges}


class BodyGraph(NetworkInputs):
    """A plan of segments grows the body; a CPPN that knows the place of each node drives it."""

    encoding: Literal["body-graph"] = "body-graph"
    anatomy: Literal[True] = True
    """The network knows the place of each node in the body."""
    # Repulsion buckles soft filaments: of 64 random creatures 48 are feasible with stiff
    # joints, 18 at 0.1 and 7 at 0.02 (docs/bodies.md).
    softest: float = field(1.0, ge=PERCEPTIBLE, le=1.0)
    """Bending stiffness of the softest segments: the share of a joint's error that a step
    removes. Each segment inherits its stiffness, from this to 1; 1: all are stiff."""

    @property
    def outputs(self) -> tuple[str, ...]:
        return OUTPUTS


class PluginControl(Actuation):
    """Genes are numbers; a plug-in turns them into movements."""

    encoding: PluginName
    plugin: PluginVersion

    inputs: ClassVar[tuple[str, ...]] = ()
    outputs: ClassVar[tuple[str, ...]] = ()
    complete = complete_plugin(("encoding",), "encoding")

    def genes(self, body: bodies.Body) -> int:
        """Return the number of genes of a creature with this body."""
        sizes = self.plugin.sizes
        each = {"genes": 1, "per_joint": len(body.joints), "per_edge": len(body.edges)}
        return sum(count * sizes.get(name, 0) for name, count in each.items())


MAX_GENES = 65_536
"""Most genes of a creature whose genome is a vector."""


Controller = Annotated[
    Annotated[Control, Tag("cppn")]
    | Annotated[Direct, Tag("direct")]
    | Annotated[BodyGraph, Tag("body-graph")]
    | Annotated[SkipJsonSchema[PluginControl], Tag("plugin")],
    *one_of("encoding", ENCODINGS[:3], name_in("encoding", "cppn")),
]
"""A controller whose genome is inherited."""


def max_stretch(control: Controller) -> float:
    """Return the largest share of its length by which a controller may stretch a body."""
    if isinstance(control, Direct) and control.rest_length is not None:
        return control.rest_length.high * (1 + control.length_scale) - 1
    return control.length_scale


def refuse_unfit(control: Controller, body: Body) -> None:
    """Raise `ValueError` where the encoding cannot control or shape the body."""
    if is_unavailable(body):  # A worker that can build it checks it.
        return
    graph = shape(body)
    if isinstance(control, BodyGraph) != isinstance(body, GrownBody):
        raise InvalidField(
            "body.builder",
            "must be 'grown' where `control.encoding` is 'body-graph', and only "
            f"there; got {body.builder!r} and {control.encoding!r}",
        )
    if isinstance(control, Direct) and (control.rest_angle or control.rest_length):
        try:
            bodies.layout(graph)
        except ValueError as error:
            raise InvalidField(
                "control.rest_angle",
                f"and `rest_length` must be empty for this `body`: {error}",
            ) from error
    if control.bounded and (nodes := len(graph.positions)) > MAX_NODES:
        raise InvalidField(
            "control.max_speed",
            "and `max_bend` must be empty and `lag` 0 for a body of more "
            f"than {MAX_NODES:,} nodes, got {nodes:,} nodes",
        )
    if (count := gene_count(control, graph)) > MAX_GENES:
        raise ValueError(f"a creature must have at most {MAX_GENES} genes, got {count}")


def refuse_cramped(control: Controller, genome: Genome) -> None:
    """Raise `ValueError` where networks cannot connect every input to every output."""
    if not isinstance(control, Control | BodyGraph):
        return
    inputs, outputs = len(control.inputs), len(control.outputs)
    least = {"max_nodes": inputs + outputs, "max_connections": inputs * outputs}
    for name, needed in least.items():
        if (found := getattr(genome, name)) < needed:
            raise InvalidField(
                f"genome.{name}",
                f"must be at least {needed} for {inputs} inputs and {outputs} "
                f"outputs, got {found}",
            )


def gene_count(control: Controller, body: bodies.Body) -> int:
    """Return the length of a vector genome; 0 where the genome is a network."""
    if isinstance(control, Direct):
        return sum(control.parts(body).values())
    if isinstance(control, PluginControl):
        return control.genes(body)
    return 0
