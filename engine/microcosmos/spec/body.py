"""Bodies in a spec: builders with their sizes, and the graphs that they stand for."""

from functools import lru_cache
from typing import Annotated, Literal, Self, get_args

import numpy as np
from pydantic import Field, Tag, model_validator
from pydantic.json_schema import SkipJsonSchema

from .. import bodies, plugins
from ..bodies import growth, swimmers
from .base import (
    BUILDERS,
    PAPER,
    RODS,
    Numeric,
    Part,
    field,
    name_in,
    one_of,
    refuse,
    sourced,
)
from .plugins import PluginName, PluginVersion, complete_plugin


class GrownBody(Part):
    """A body that grows from a plan of segments in the genome: its largest sizes."""

    builder: Literal["grown"]
    nodes: int = field(48, ge=8, le=256, unit="nodes")
    """Most nodes of a body."""
    length: float = field(40.0, ge=4.0, le=1000.0, unit="cells")
    """Largest distance between two nodes along a body."""
    segments: int = field(8, ge=1, le=32)
    """Most segments of a plan."""
    # Smaller roots and limbs won by coarse resolution: on half the grid spacing they went 0.43
    # to 0.75 times as far (docs/bodies.md, "Least sizes").
    segment_nodes: int = field(24, ge=growth.LEAST_ROOT, le=128, unit="nodes")
    """Most nodes of a segment."""
    copies: int = field(6, ge=1, le=32)
    """Most copies of a segment along the one that it is attached to."""
    limbs: int = field(12, ge=1, le=64)
    """Most copies of a segment in a body, with those of its parents and mirror images."""
    rings: int = field(3, ge=1, le=8)
    """Most rings of a body."""
    spacing: float = field(1.0, ge=0.5, le=2.0, unit="cells")
    """Rest length of an edge; above 2 cells, fluid leaks between the nodes."""

    @property
    def capacity(self) -> growth.Capacity:
        """Return the fixed sizes of all bodies; the last row of nodes stays empty."""
        return growth.Capacity(
            nodes=self.nodes + 1,
            segments=self.segments,
            rings=self.rings,
            limbs=self.limbs,
            length=self.length,
            spacing=self.spacing,
        )

    @property
    def genes(self) -> growth.Segments:
        """Return the limits of the genes of segments."""
        return growth.Segments(self.segments, self.segment_nodes, self.copies)


SUPPORT = 4.0
"""Width of the four-point delta in cells: room that a world needs beyond a body's extent."""

MAX_NODES = 4096
"""Most nodes of a body."""


class Elastic(Part):
    """Stiffness and node spacing, the same everywhere."""

    model_config = sourced(RODS)

    stretch: float = field(1.0, ge=0.0, le=1.0)
    """Stretching stiffness: share of the error that one projection removes."""
    shear: float = field(1.0, ge=0.0, le=1.0)
    """Shearing stiffness: share of the error that one projection removes."""
    bend: float = field(1.0, ge=0.0, le=1.0)
    """Bending stiffness: share of the error that one projection removes."""

    @model_validator(mode="after")
    def refuse_malformed(self) -> Self:
        if (count := _node_count(self)) > MAX_NODES:
            raise ValueError(f"a body must have at most {MAX_NODES} nodes, got {count:.6g}")
        shape(self)  # pyright: ignore[reportArgumentType]
        return self


class Spaced(Elastic):
    """A body of edges of one length."""

    spacing: float = field(1.0, ge=0.5, le=2.0, unit="cells")
    """Rest length of an edge; above 2 cells, fluid leaks between the nodes."""


class Chain(Spaced):
    """A straight filament."""

    builder: Literal["chain"] = "chain"
    nodes: int = field(24, ge=3, le=MAX_NODES, unit="nodes")
    """Number of nodes."""


class Ring(Spaced):
    """A closed filament, round at rest."""

    builder: Literal["ring"]
    nodes: int = field(32, ge=4, le=MAX_NODES, unit="nodes")
    """Number of nodes."""


class Arc(Spaced):
    """An open circle, like a bell."""

    builder: Literal["arc"]
    nodes: int = field(32, ge=4, le=MAX_NODES, unit="nodes")
    """Number of nodes."""
    gap: float = field(0.25, gt=0.0, lt=1.0)
    """Missing share of the circle."""


class Walk(Elastic):
    """A filament along a random walk, which may cross itself."""

    builder: Literal["walk"]
    nodes: int = field(1000, ge=3, le=MAX_NODES, unit="nodes")
    """Number of nodes."""
    spacing: float = field(0.4, ge=0.25, le=2.0, unit="cells")
    """Rest length of an edge."""
    deviation: float = field(0.3, ge=0.0, le=3.0, unit="rad")
    """Standard deviation of the angle at each joint."""
    seed: int = field(3, ge=0, lt=2**32)
    """Random seed of the walk."""


class Star(Spaced):
    """Straight arms from one middle node."""

    builder: Literal["star"]
    arms: int = field(5, ge=3, le=64)
    """Number of arms, evenly spaced around the middle."""
    arm_nodes: int = field(8, ge=1, le=1024, unit="nodes")
    """Nodes per arm, without the middle node."""


class Tree(Spaced):
    """A stem that branches repeatedly."""

    builder: Literal["tree"]
    levels: int = field(3, ge=1, le=8)
    """Levels of branches, the stem included."""
    branches: int = field(2, ge=2, le=4)
    """Branches per fork."""
    segment_nodes: int = field(6, ge=1, le=256, unit="nodes")
    """Nodes per branch."""
    angle: float = field(0.9, gt=0.0, le=2.0, unit="rad")
    """Angle between the outermost branches of a fork."""


Cells = Annotated[float, Numeric]
Place = tuple[Cells, Cells]
Node = Annotated[int, Numeric]
Pair = tuple[Node, Node]


class Polyline(Spaced):
    """A filament along given points, its nodes evenly spaced at about `spacing`."""

    builder: Literal["polyline"]
    points: tuple[Place, ...] = Field(min_length=2, max_length=MAX_NODES)
    """Corners as [x, y] in cells. Only the shape counts; it is centred in the world."""
    closed: bool = False
    """Join the last point to the first."""


class Graph(Elastic):
    """Any filaments: nodes and edges, at rest as drawn."""

    builder: Literal["graph"]
    nodes: tuple[Place, ...] = Field(min_length=3, max_length=MAX_NODES)
    """Positions as [x, y] in cells."""
    edges: tuple[Pair, ...] = Field(min_length=2, max_length=4 * MAX_NODES)
    """Pairs of node numbers, from 0."""

    @model_validator(mode="after")
    def refuse_loose(self) -> Self:
        joined = {node for edge in self.edges for node in edge}
        loose = next((node for node in range(len(self.nodes)) if node not in joined), None)
        refuse(loose is not None, "edges", f"must join every node; node {loose} is in none")
        return self


Swimmer = Literal["worm", "tadpole", "ray", "cilia", "jellyfish"]
"""Names of the five swimmers of the paper."""


class SwimmerBody(Part):
    """The body of one of the five swimmers of the paper."""

    model_config = sourced(PAPER)

    builder: Swimmer
    """Name of the swimmer."""


WITH_BODY = ("body", "gait")
"""Kinds of plug-ins that have a body."""


class PluginBody(Part):
    """A body that a plug-in builds, or the body of a plug-in's gait."""

    builder: PluginName
    plugin: PluginVersion

    complete = complete_plugin(WITH_BODY, "builder")


Body = Annotated[
    Annotated[Chain, Tag("chain")]
    | Annotated[Ring, Tag("ring")]
    | Annotated[Arc, Tag("arc")]
    | Annotated[Walk, Tag("walk")]
    | Annotated[Star, Tag("star")]
    | Annotated[Tree, Tag("tree")]
    | Annotated[Polyline, Tag("polyline")]
    | Annotated[Graph, Tag("graph")]
    | Annotated[GrownBody, Tag("grown")]
    | Annotated[SwimmerBody, Tag("known")]
    | Annotated[SkipJsonSchema[PluginBody], Tag("plugin")],
    *one_of(
        "builder",
        (*BUILDERS, *get_args(Swimmer)),
        name_in("builder", "chain"),
        dict.fromkeys(get_args(Swimmer), "known"),
    ),
]


def shape(body: Body) -> bodies.Body:
    """Return the graph of a body at rest; the longest filament of bodies that grow.

    Raises `ValueError` where it is malformed, or `plugins.Missing` where its plug-in is not
    loaded.
    """
    return _shape(resolved(body))  # pyright: ignore[reportArgumentType]


def estimated_shape(body: Body) -> bodies.Body:
    """Return the graph of a body, or the longest chain if its plug-in is not loaded."""
    if is_unavailable(body):
        assert isinstance(body, PluginBody)
        most = body.plugin.sizes.get("nodes", MAX_NODES)
        return bodies.chain(min(MAX_NODES, max(3, most)), 1.0)
    return shape(body)


def is_unavailable(body: Body) -> bool:
    """Return whether a plug-in builds the body, in a version not loaded in this process."""
    if not isinstance(body, PluginBody):
        return False
    try:
        plugins.find(WITH_BODY, body.builder, body.plugin.source)
    except plugins.Missing:
        return True
    return False


def resolved(body: Body) -> Body:
    """Return a plug-in's body as a graph, which means the same everywhere."""
    if not isinstance(body, PluginBody):
        return body
    plugin = plugins.find(WITH_BODY, body.builder, body.plugin.source)
    made = plugin(settings=body.plugin.settings)
    made = getattr(made, "body", made)  # A gait returns a swimmer.
    if not isinstance(made, bodies.Body):
        raise plugins.Broken(f"{body.builder} must return a body, got {type(made).__name__}")
    return _graph(body, made)


def _graph(body: PluginBody, made: bodies.Body) -> Graph:
    most = body.plugin.sizes.get("nodes", MAX_NODES)
    if len(made.positions) > most:
        raise plugins.Broken(
            f"{body.builder} must return at most the {most} `nodes` that it declares, got "
            f"{len(made.positions)}"
        )
    uneven = [name for name in ("stretch", "shear", "bend") if np.ptp(getattr(made, name)) > 0]
    if uneven:
        raise plugins.Broken(f"{body.builder} must be equally stiff in {uneven[0]} everywhere")
    graph = Graph(
        builder="graph",
        nodes=tuple((float(x), float(y)) for x, y in made.positions),
        edges=tuple((int(a), int(b)) for a, b in made.edges),
        stretch=float(made.stretch[0]),
        shear=float(made.shear[0]),
        bend=float(made.bend[0]) if len(made.bend) else 1.0,
    )
    drawn = shape(graph)
    same = np.array_equal(drawn.joints, made.joints) and all(
        np.allclose(getattr(drawn, name), getattr(made, name), atol=1e-6)
        for name in ("rest_length", "rest_angle")
    )
    if not same:
        raise plugins.Broken(
            f"{body.builder} must be at rest as it is drawn: build it with `bodies.from_edges`"
        )
    return graph


def _node_count(body: Elastic) -> float:
    """Return the approximate number of nodes of builders whose fields alone do not bound it."""
    match body:
        case Star():
            return 1 + body.arms * body.arm_nodes
        case Tree():
            return body.segment_nodes * sum(body.branches**n for n in range(body.levels))
        case Polyline():
            corners = np.array(body.points)
            return float(np.sum(np.hypot(*np.diff(corners, axis=0).T)) / body.spacing)
    return 0


@lru_cache(maxsize=64)
def _shape(body: Body) -> bodies.Body:
    if isinstance(body, SwimmerBody):
        return swimmers.SWIMMERS[body.builder]().body
    if isinstance(body, GrownBody):
        longest = 1 + int(body.length / body.spacing)
        return bodies.chain(min(body.nodes, longest), body.spacing)
    sizes = {name: getattr(body, name) for name in type(body).model_fields}
    if sizes.pop("builder") == "graph":
        nodes, edges = (np.array(sizes.pop(name)) for name in ("nodes", "edges"))
        return bodies.from_edges(nodes, edges, **sizes)
    return getattr(bodies, body.builder)(**sizes)
