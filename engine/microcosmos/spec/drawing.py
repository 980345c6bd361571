"""Drawings of a spec before it runs: bodies in their worlds, and target pictures."""

from dataclasses import dataclass, replace
from functools import singledispatch

import numpy as np

from .. import bodies
from ..bodies import growth
from . import targets
from .body import Body, GrownBody, is_unavailable, shape
from .creature import Identity
from .evolution import Evolution
from .experiments import Spec
from .folding import Folding
from .gaits import Gaits, swimmer_body
from .refinement import Refinement, parsed
from .scaling import SPACING, Scaling
from .world import World

MOST_NODES = 1024
"""Approximate number of drawn nodes of a body."""
MOST_FILAMENTS = 600
"""Most drawn filaments."""
ALONE = np.zeros((1, 2))
"""The place of a creature without copies."""
RANDOM_PLANS = 12
"""Drawn plans where bodies grow."""
MOST_PICTURES = 16
"""Most drawn pictures."""
PIXELS = 32
"""Pixels of a drawn picture's longer side."""


@dataclass(frozen=True)
class Drawn:
    """A body at rest in its world, with its copies, thinned if it has many nodes."""

    name: str
    nodes: int
    """Number of nodes before thinning."""
    positions: np.ndarray
    """(node, 2) in cells."""
    edges: np.ndarray
    """(edge, 2) numbers of drawn nodes."""
    whole: bool = True
    """True if every filament is drawn."""


@dataclass(frozen=True)
class Drawing:
    """Bodies, each in its own periodic world of the same size."""

    width: int
    height: int
    bodies: tuple[Drawn, ...]
    pictures: tuple[tuple[str, np.ndarray], ...] = ()
    """Names, and ink (row, column) from the top."""
    picture_size: int = 0
    """The longer side of a picture, in cells."""
    solid: np.ndarray | None = None
    """Mask (x, y) of the cells of obstacles; None: there are none."""


@singledispatch
def drawing(spec: Spec) -> Drawing:
    """Return the drawing of a spec."""
    raise TypeError(f"`spec` must be an experiment's, got {type(spec).__name__}")


@drawing.register
def _(spec: Evolution) -> Drawing:
    if isinstance(spec.body, GrownBody):
        return _random(spec.world, spec.body, spec.seed)
    return _alone(spec.world, spec.body)


@drawing.register
def _(spec: Refinement) -> Drawing:
    found = Identity.model_validate(parsed(spec.creature)["identity"])
    return _in_world(found.world, {found.body.builder: found.shape})


@drawing.register
def _(spec: Folding) -> Drawing:
    alone = _alone(spec.world, spec.body)
    shown = spec.targets[:MOST_PICTURES]
    found = tuple((target.name, targets.fitted(target.ink, PIXELS)) for target in shown)
    return replace(alone, pictures=found, picture_size=spec.size)


@drawing.register
def _(spec: Gaits) -> Drawing:
    size = spec.width, spec.height
    found = {name: swimmer_body(name, spec.plugins.get(name)) for name in spec.swimmers}
    drawn = [
        _placed(name, *size, shape(body))
        for name, body in found.items()
        if not is_unavailable(body)
    ]
    return Drawing(*size, tuple(drawn))


@drawing.register
def _(spec: Scaling) -> Drawing:
    crowds = tuple(_crowd(spec, nodes) for nodes in (spec.nodes[0], spec.nodes[-1]))
    return Drawing(spec.width, spec.height, crowds)


def _alone(world: World, body: Body) -> Drawing:
    if is_unavailable(body):
        return _in_world(world, {})
    return _in_world(world, {body.builder: shape(body)})


def _in_world(world: World, by_name: dict[str, bodies.Body]) -> Drawing:
    """Draw bodies by name, each where it starts."""
    places = ALONE if world.copies is None else world.copies.places
    size = world.width, world.height
    drawn = tuple(_placed(name, *size, body, places) for name, body in by_name.items())
    return Drawing(*size, drawn, solid=world.solid)


def _random(world: World, body: GrownBody, seed: int) -> Drawing:
    """Draw bodies of random plans, the kind that a search begins with."""
    rng, plans = np.random.default_rng(seed), {}
    for number in range(1, RANDOM_PLANS + 1):
        uniform = rng.random(growth.PLAN_DRAWS, np.float32)
        plan = growth.random_plan(uniform, body.genes)
        plans[f"random plan {number}"] = growth.grown_body(plan, body.capacity)
    return _in_world(world, plans)


def _placed(
    name: str, width: int, height: int, body: bodies.Body, places: np.ndarray = ALONE
) -> Drawn:
    """Draw copies of a body at places (copy, 2) about the middle of the world."""
    whole = bodies.placed(body, (width / 2, height / 2))
    positions, edges = bodies.thinned(whole, MOST_NODES // len(places))
    first = len(positions) * np.arange(len(places))
    return Drawn(
        name,
        len(places) * len(whole.positions),
        (places[:, None] + positions).reshape(-1, 2),
        (first[:, None, None] + edges).reshape(-1, 2),
    )


def _crowd(spec: Scaling, nodes: int) -> Drawn:
    """Draw straight filaments by their ends; the first ones already spread over the box."""
    every = spec.centres(nodes)
    centres = every[:MOST_FILAMENTS]
    half = (spec.filament - 1) * SPACING / 2
    ends = centres[:, None] + np.array([[-half, 0.0], [half, 0.0]])
    edges = np.arange(2 * len(centres)).reshape(-1, 2)
    whole = len(centres) == len(every)
    return Drawn(f"{len(every):,} filaments", nodes, ends.reshape(-1, 2), edges, whole)
