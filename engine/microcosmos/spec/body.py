"""The body: one of several builders, each with its own measures."""

from functools import lru_cache
from typing import Annotated, Any, Literal, Self, get_args

import numpy as np
from pydantic import Discriminator, Field, Tag, model_validator
from pydantic.json_schema import SkipJsonSchema

from .. import bodies, plugins
from ..bodies import swimmers
from .base import Part, unit
from .plugins import PluginName, PluginVersion, complete_plugin
from .sources import PAPER, RODS, after

SUPPORT = 4.0
"""Cells that the four-point delta reaches across, beyond a body's own extent."""

MOST = 4096
"""Nodes of a body."""


class Elastic(Part):
    """Stiffness, the same everywhere."""

    model_config = after(RODS)

    stretch: float = Field(default=1.0, ge=0.0, le=1.0)
    """Share of the stretching error that one projection removes."""
    shear: float = Field(default=1.0, ge=0.0, le=1.0)
    """Share of the shearing error that one projection removes."""
    bend: float = Field(default=1.0, ge=0.0, le=1.0)
    """Share of the bending error that one projection removes."""

    @model_validator(mode="after")
    def refuse_malformed(self) -> Self:
        if (count := _nodes(self)) > MOST:
            raise ValueError(f"a body must have at most {MOST} nodes, got {count:.6g}")
        shape(self)  # pyright: ignore[reportArgumentType]
        return self


def spacing() -> Any:
    return Field(default=1.0, ge=0.5, le=2.0, json_schema_extra=unit("cells"))


class Chain(Elastic):
    """A straight filament."""

    builder: Literal["chain"] = "chain"
    nodes: int = Field(default=32, ge=3, le=MOST, json_schema_extra=unit("nodes"))
    """Nodes of the filament."""
    spacing: float = spacing()
    """Rest length of an edge; wider than 2 cells, fluid leaks between the nodes."""


class Ring(Elastic):
    """A closed filament, round at rest."""

    builder: Literal["ring"]
    nodes: int = Field(default=32, ge=4, le=MOST, json_schema_extra=unit("nodes"))
    """Nodes of the ring."""
    spacing: float = spacing()
    """Rest length of an edge."""


class Arc(Elastic):
    """An open circle, like a bell."""

    builder: Literal["arc"]
    nodes: int = Field(default=32, ge=4, le=MOST, json_schema_extra=unit("nodes"))
    """Nodes of the arc."""
    spacing: float = spacing()
    """Rest length of an edge."""
    gap: float = Field(default=0.25, gt=0.0, lt=1.0)
    """Share of the circle that is missing."""


class Walk(Elastic):
    """A filament along a random walk, which may cross itself."""

    builder: Literal["walk"]
    nodes: int = Field(default=1000, ge=3, le=MOST, json_schema_extra=unit("nodes"))
    """Nodes of the filament."""
    spacing: float = Field(default=0.4, ge=0.25, le=2.0, json_schema_extra=unit("cells"))
    """Rest length of an edge."""
    deviation: float = Field(default=0.3, ge=0.0, le=3.0, json_schema_extra=unit("rad"))
    """Standard deviation of the angle at each joint."""
    seed: int = Field(default=3, ge=0, lt=2**32)
    """Which of many walks it is."""


class Star(Elastic):
    """Straight arms from one middle node."""

    builder: Literal["star"]
    arms: int = Field(default=5, ge=3, le=64)
    """Arms, evenly around the middle."""
    arm_nodes: int = Field(default=8, ge=1, le=1024, json_schema_extra=unit("nodes"))
    """Nodes of an arm, the middle one not among them."""
    spacing: float = spacing()
    """Rest length of an edge."""


class Tree(Elastic):
    """A stem that branches again and again."""

    builder: Literal["tree"]
    levels: int = Field(default=3, ge=1, le=8)
    """How often a branch ends in branches, the stem among them."""
    branches: int = Field(default=2, ge=2, le=4)
    """Branches at the end of each."""
    segment_nodes: int = Field(default=6, ge=1, le=256, json_schema_extra=unit("nodes"))
    """Nodes of a branch."""
    spacing: float = spacing()
    """Rest length of an edge."""
    angle: float = Field(default=0.9, gt=0.0, le=2.0, json_schema_extra=unit("rad"))
    """Between the outermost branches of a fork."""


class Polyline(Elastic):
    """A filament along given points, with nodes evenly spaced."""

    builder: Literal["polyline"]
    points: Annotated[tuple[tuple[float, float], ...], Field(min_length=2, max_length=MOST)]
    """Corners as [x, y] in cells; only their shape counts, the middle is put in the world's."""
    spacing: float = spacing()
    """About the rest length of an edge."""
    closed: bool = False
    """Whether the last point is joined to the first."""


class Graph(Elastic):
    """Any filaments: nodes and the edges between them, at rest as they are drawn."""

    builder: Literal["graph"]
    nodes: Annotated[tuple[tuple[float, float], ...], Field(min_length=3, max_length=MOST)]
    """Places as [x, y] in cells."""
    edges: Annotated[tuple[tuple[int, int], ...], Field(min_length=2, max_length=4 * MOST)]
    """Pairs of node numbers, from 0."""


Swimmer = Literal["worm", "tadpole", "ray", "cilia", "jellyfish"]
"""The known swimmers, by name."""


class Known(Part):
    """The body of one of the five known swimmers."""

    model_config = after(PAPER)

    builder: Swimmer
    """Whose body."""


WITH_BODY = ("body", "gait")
"""Kinds of plug-ins that have a body."""


class PluginBody(Part):
    """A body that a plug-in builds, or the body of a plug-in's gait."""

    builder: PluginName
    plugin: PluginVersion

    complete = complete_plugin(WITH_BODY, "builder")


NAMES = (
    "chain",
    "ring",
    "arc",
    "walk",
    "star",
    "tree",
    "polyline",
    "graph",
    *get_args(Swimmer),
)


def _tag(value: Any) -> Any:
    """A body that names no builder is a chain."""
    if isinstance(value, dict):
        name = value.get("builder", "chain")
    else:
        name = getattr(value, "builder", None)
    if plugins.is_plugin(name):
        return "plugin"
    return "known" if name in get_args(Swimmer) else name


Body = Annotated[
    Annotated[Chain, Tag("chain")]
    | Annotated[Ring, Tag("ring")]
    | Annotated[Arc, Tag("arc")]
    | Annotated[Walk, Tag("walk")]
    | Annotated[Star, Tag("star")]
    | Annotated[Tree, Tag("tree")]
    | Annotated[Polyline, Tag("polyline")]
    | Annotated[Graph, Tag("graph")]
    | Annotated[Known, Tag("known")]
    | Annotated[SkipJsonSchema[PluginBody], Tag("plugin")],
    Discriminator(
        _tag,
        custom_error_type="unknown_builder",
        custom_error_message="`builder` must be one of " + ", ".join(NAMES),
    ),
]
"""A body, by the name of its builder."""


def shape(body: Body) -> bodies.Body:
    """The graph of a body at rest; `ValueError` where it is malformed or not to be had."""
    return _shape(resolved(body))  # pyright: ignore[reportArgumentType]


def about(body: Body) -> bodies.Body:
    """The graph of a body, or where it is made elsewhere a chain with as many nodes at most."""
    if made_elsewhere(body):
        assert isinstance(body, PluginBody)
        return bodies.chain(min(MOST, max(3, body.plugin.sizes.get("nodes", MOST))), 1.0)
    return shape(body)


def made_elsewhere(body: Body) -> bool:
    """Whether it is of one's own, in a version that is not loaded here."""
    if not isinstance(body, PluginBody):
        return False
    try:
        plugins.find(WITH_BODY, body.builder, body.plugin.source)
    except plugins.Missing:
        return True
    return False


def resolved(body: Body) -> Body:
    """A body of one's own as the graph that it is: that means the same to everybody."""
    if not isinstance(body, PluginBody):
        return body
    plugin = plugins.find(WITH_BODY, body.builder, body.plugin.source)
    made = plugin(settings=body.plugin.settings)
    made = getattr(made, "body", made)  # A swimmer has one.
    if not isinstance(made, bodies.Body):
        raise plugins.Broken(f"{body.builder} must give a body, got {type(made).__name__}")
    return _graph(body, made)


def _graph(body: PluginBody, made: bodies.Body) -> Graph:
    most = body.plugin.sizes.get("nodes", MOST)
    if len(made.positions) > most:
        raise plugins.Broken(
            f"{body.builder} must give at most the {most} `nodes` that it declares, got "
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


def _nodes(body: Elastic) -> float:
    """About how many nodes there will be, where fields alone do not bound it."""
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
    if isinstance(body, Known):
        return swimmers.SWIMMERS[body.builder]().body
    measures = {name: getattr(body, name) for name in type(body).model_fields}
    if measures.pop("builder") == "graph":
        nodes, edges = (np.array(measures.pop(name)) for name in ("nodes", "edges"))
        return bodies.from_edges(nodes, edges, **measures)
    return getattr(bodies, body.builder)(**measures)
