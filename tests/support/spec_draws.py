"""Random scenes: every field of a world, a body, a coupling and a controller is drawn.

Choices (words, yes or no, parts, empty or not) follow from the fields' types, so that a new
one is drawn without a word here. A new number needs an entry in `NUMBERS`.
"""

from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError
from spec_cases import ANOTHER, alternatives, owner

from microcosmos import spec

MOVERS = Path(__file__).with_name("movers.py")
Random = np.random.Generator
Draw = Callable[[Random], Any]


def between(low: float, high: float) -> Draw:
    """Draw a number from a range, or a whole number if its ends are."""
    if isinstance(low, int) and isinstance(high, int):
        return lambda rng: int(rng.integers(low, high + 1))
    return lambda rng: float(rng.uniform(low, high))


def scaled(low: float, high: float) -> Draw:
    """Draw a number evenly in its logarithm."""
    return lambda rng: float(np.exp(rng.uniform(np.log(low), np.log(high))))


def or_none(draw: Draw, number: float) -> Draw:
    """Draw a number, or often the one that switches something off."""
    return lambda rng: number if rng.random() < 0.3 else draw(rng)


def one_of(*values: Any) -> Draw:
    return lambda rng: values[rng.integers(len(values))]


def points(rng: Random) -> list[list[float]]:
    """Draw corners that turn by less than a right angle."""
    angles = np.cumsum(rng.uniform(-1.2, 1.2, rng.integers(2, 5)))
    ways = rng.uniform(2, 4, len(angles))[:, None] * np.stack(
        [np.cos(angles), np.sin(angles)], 1
    )
    return np.cumsum([[0, 0], *ways], 0).round(3).tolist()


def branches(rng: Random) -> list[list[int]]:
    """Draw the edges of a tree of `PLACES`."""
    return [[int(rng.integers(max(0, end - 2), end)), end] for end in range(1, len(PLACES))]


PLACES = [[0, 0], [1, 0.2], [2, 0], [2.4, 1], [3.2, 0.3], [3, 1.9], [4.2, 0.8], [3.9, 2.6]]
SEED = between(0, 2**32 - 1)
NUMBERS: dict[str, Draw] = {
    "World.width": between(24, 52),
    "World.height": between(24, 52),
    "World.viscosity": scaled(2e-3, 1.5),
    "World.obstacles": one_of([], [{"kind": "post", "x": 2, "y": 3, "radius": 1.5}]),
    "Flow.speed": scaled(1e-3, 0.05),
    "Flow.vortices": one_of(2, 4),
    "Copies.count": between(2, 4),
    "Copies.spacing": between(4.0, 20.0),
    "Steric.strength": scaled(0.5, 12.0),
    "Steric.limit": scaled(0.02, 0.4),
    "Energy.packets": between(1, 8),
    "Energy.width": between(1.0, 6.0),
    "Energy.amplitude": scaled(0.1, 10.0),
    "Energy.seed": SEED,
    "Energy.placements": between(1, 3),
    "Energy.rate": scaled(0.01, 1.0),
    "Energy.diffusion": or_none(scaled(1e-3, 0.25), 0.0),
    "Elastic.stretch": or_none(between(0.2, 1.0), 1.0),
    "Elastic.shear": or_none(between(0.2, 1.0), 1.0),
    "Elastic.bend": or_none(between(0.2, 1.0), 1.0),
    "Spaced.spacing": between(0.7, 1.5),
    "Chain.nodes": between(3, 16),
    "Ring.nodes": between(5, 18),
    "Arc.nodes": between(5, 18),
    "Arc.gap": between(0.1, 0.6),
    "Walk.nodes": between(5, 18),
    "Walk.spacing": between(0.5, 1.2),
    "Walk.deviation": between(0.0, 0.5),
    "Walk.seed": SEED,
    "Star.arms": between(3, 5),
    "Star.arm_nodes": between(2, 5),
    "Tree.levels": between(1, 2),
    "Tree.branches": between(2, 3),
    "Tree.segment_nodes": between(3, 5),
    "Tree.angle": between(0.6, 1.6),
    "Polyline.points": points,
    "Graph.nodes": lambda rng: PLACES,
    "Graph.edges": branches,
    "GrownBody.nodes": between(8, 20),
    "GrownBody.length": between(6.0, 16.0),
    "GrownBody.segments": between(1, 6),
    "GrownBody.segment_nodes": between(15, 18),
    "GrownBody.copies": between(1, 4),
    "GrownBody.limbs": between(1, 8),
    "GrownBody.rings": between(1, 3),
    "GrownBody.spacing": between(0.7, 1.5),
    "PluginBody.builder": one_of("movers.stick"),
    "Coupling.forcing_iterations": between(1, 5),
    "Coupling.constraint_iterations": between(1, 12),
    "Coupling.max_displacement": scaled(0.005, 0.3),
    "Coupling.max_force": scaled(0.002, 0.2),
    "Coupling.nu_c": scaled(0.01, 1.0),
    "Actuation.period": scaled(8.0, 200.0),
    "Actuation.ramp": or_none(between(0.1, 3.0), 0.0),
    "Actuation.angle_scale": between(0.05, 0.8),
    "Actuation.length_scale": or_none(between(0.01, 0.25), 0.0),
    "Actuation.max_speed": scaled(0.02, 0.3),
    "Actuation.lag": or_none(scaled(0.5, 60.0), 0.0),
    "Actuation.max_bend": between(0.3, 5.0),
    "NetworkInputs.wave_number": between(-2.0, 2.0),
    "Direct.terms": between(2, 5),
    "Direct.spread": between(0.2, 1.0),
    "Direct.faintest": scaled(0.01, 1.0),
    "BodyGraph.softest": or_none(scaled(0.05, 1.0), 1.0),
    "PluginControl.encoding": one_of("movers.pulse"),
    "Gait.period": between(20, 300),
    "Gait.ramp": or_none(between(0.1, 3.0), 0.0),
    "Task.steps": between(100, 110),
    "Task.trials": between(1, 3),
    "Task.energy_weight": scaled(1e-3, 1.0),
}
"""How numbers are drawn, and other values that types do not say."""

TRAITS = {
    "rest_angle": between(-0.3, 0.3),
    "rest_length": between(0.75, 1.25),
    "stretch": between(0.2, 1.0),
    "shear": between(0.2, 1.0),
    "bend": between(0.2, 1.0),
}
"""How the ends of bounds are drawn."""

SELDOM: dict[tuple[str, Any], float] = {
    ("World.fluid", False): 0.2,
    ("World.copies", spec.Copies): 0.3,
    ("Coupling.limits", False): 0.2,
    ("Scene.control", spec.Fold): 0.3,
    ("Scene.control", spec.PluginControl): 0.3,
    ("Scene.control", spec.BodyGraph): 0.0,  # See `PLANNED`.
    ("Scene.control", spec.Gait): 0.9,
    ("Scene.body", spec.PluginBody): 0.3,
    ("Scene.body", spec.GrownBody): 0.0,  # It stands with its encoding alone.
}
"""Weights below 1 of choices."""

PLANNED = 12
"""One of so many scenes has a body that grows from a plan."""

OMITTED = ("plugin", "plugins", "measures", "emits")
"""Versions of plug-ins, which a scene completes, and what no kernel computes."""


@cache
def any_scene(seed: int) -> spec.Scene:
    """Return a random valid scene. The plug-ins are those of `movers.py`."""
    rng = np.random.default_rng(seed)
    control = choice(spec.Scene, "control", rng)
    if seed % PLANNED == PLANNED - 1:
        control = spec.BodyGraph
    while True:
        try:
            return spec.Scene.model_validate(document(control, rng))
        except ValidationError:
            continue


def document(control: type[spec.Part], rng: Random) -> dict[str, Any]:
    """Draw a scene with a controller of one kind, and a body that may fit it."""
    parts = drawn(spec.Scene, rng) | {"control": drawn(control, rng)}
    if control is spec.BodyGraph:
        parts["body"] = drawn(spec.GrownBody, rng)
        parts["coupling"]["limits"] = True  # Without them any motion is drawn, and may blow up.
    if control is spec.Gait:
        swimmer = parts["control"]["swimmer"]
        # Seldom, since scenes of the others are more often refused (too small) and drawn again.
        if rng.random() < 0.05:
            swimmer = "movers.wriggler"
        parts["control"]["swimmer"] = parts["body"]["builder"] = swimmer
        parts["body"] = {"builder": swimmer}
    return parts


def drawn(part: type[spec.Part], rng: Random) -> dict[str, Any]:
    """Draw every field of a part."""
    return {name: value(part, name, rng) for name in part.model_fields if name not in OMITTED}


def value(part: type[spec.Part], name: str, rng: Random) -> Any:
    """Draw a field of a part."""
    found = choice(part, name, rng)
    if found is spec.Bounds:
        return dict(
            zip(("low", "high"), sorted(TRAITS[name](rng) for _ in range(2)), strict=True)
        )
    if isinstance(found, type):
        return drawn(found, rng)
    return NUMBERS[f"{owner(part, name)}.{name}"](rng) if found is ANOTHER else found


def choice(part: type[spec.Part], name: str, rng: Random) -> Any:
    """Draw an alternative of a field, see `spec_cases.alternatives`."""
    path = f"{owner(part, name)}.{name}"
    known = list(alternatives(part.model_fields[name].annotation))
    weights = np.array([SELDOM.get((path, one), 1.0) for one in known])
    return known[rng.choice(len(known), p=weights / weights.sum())]
