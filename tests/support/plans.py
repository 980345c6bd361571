"""Creatures with body plans."""

from typing import Any

import numpy as np
from reports import identity

from microcosmos.naming import encode
from microcosmos.spec import EXPERIMENTS, BodyGraph

ZOO = next(
    preset.spec
    for preset in EXPERIMENTS["quality-diversity"].presets
    if preset.name == "zoo-demo"
).model_dump(mode="json")
ROOT = {
    "number": 0,
    "parent": 0,
    "place": 0.0,
    "angle": 0.0,
    "nodes": 8,
    "curl": 0.0,
    "stiffness": 1.0,
    "mirrored": False,
    "copies": 1,
    "closed": False,
}
FINS = ROOT | {"number": 1, "nodes": 4, "place": 0.5, "angle": np.pi / 2, "mirrored": True}
"""Straight to both sides of the middle of the root."""


def plan(*segments: dict[str, Any]) -> dict[str, Any]:
    """Return the genes of segments as a creature file holds them."""
    columns = {name: [segment[name] for segment in segments] for name in ROOT}
    reals = [name for name, value in ROOT.items() if isinstance(value, float)]
    return columns | {name: encode(np.array(columns[name])) for name in reals}


def plan_identity(*segments: dict[str, Any]) -> dict[str, Any]:
    """Return a creature with a plan, whose network has no connections."""
    control = BodyGraph.model_validate(ZOO["control"])
    ends = [*control.inputs, *control.outputs]
    nodes = {
        "id": list(range(len(ends))),
        "activation": ["identity"] * len(ends),
        "bias": encode(np.zeros(len(ends))),
    }
    none = {"innovation": [], "source": [], "target": [], "enabled": [], "weight": ""}
    genome = {
        "encoding": "body-graph",
        "inputs": list(control.inputs),
        "outputs": list(control.outputs),
        "control": ZOO["control"],
        "plan": plan(*segments),
        "nodes": nodes,
        "connections": none,
    }
    world = ZOO["world"] | {"coupling": ZOO["coupling"]}
    return identity() | {"genome": genome, "world": world, "body": ZOO["body"]}
