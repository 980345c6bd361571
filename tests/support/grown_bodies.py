"""A creature whose plan grows a body with a mirrored pair of limbs and a ring."""

from typing import Any

import jax
import numpy as np

from microcosmos import spec
from microcosmos.archive import creature
from microcosmos.bodies.growth import TYPES, Plan
from microcosmos.build import build_encoding, identity_template
from microcosmos.genomes import BodyGraph
from microcosmos.search.parts.records import identity

ROOM = (16, 40)
PLAN = {
    "number": (0, 1, 2),
    "parent": (0, 0, 0),
    "place": (0.0, 0.5, 1.0),
    "angle": (0.0, 1.1, -0.6),
    "nodes": (8, 4, 9),
    "curl": (0.3, -0.4, 0.0),
    "stiffness": (0.5, 0.2, 1.0),
    "mirrored": (False, True, False),
    "copies": (1, 1, 1),
    "closed": (False, False, True),
}
"""26 nodes: 9 of the root, 2 limbs of 4 and a ring of 9 more."""


def plan(rows: int) -> Plan:
    """Return the plan, with room for a number of segments."""
    found = {name: np.zeros(rows, kind) for name, kind in TYPES.items()}
    found["used"][:3] = True
    for name, values in PLAN.items():
        found[name][:3] = values
    return Plan(**found)


def grown_scene(**parts: Any) -> spec.Scene:
    """Return a small scene of a body that grows; `softest` and `steric` are as in a spec."""
    softest = parts.pop("softest", 1.0)
    steric = spec.Steric(smoothing="binomial") if parts.pop("steric", True) else None
    return spec.Scene(
        world=spec.World(width=32, height=32, steric=steric),
        body=spec.GrownBody(builder="grown", nodes=28, length=24.0),
        control=spec.BodyGraph(period=30, softest=softest),
        task=spec.Task(**{"steps": 60, "fitness": "displacement"} | parts),
    )


def genotype_of(scene: spec.Scene) -> BodyGraph:
    """Return the plan with a network that moves all joints alike."""
    encoding = build_encoding(scene, ROOM)
    assert encoding.segments is not None
    drawn = encoding.newcomer(key=jax.random.key(2))
    network = jax.tree.map(np.asarray, drawn.network)
    return BodyGraph(plan(encoding.segments.rows), network)


def grown_file(scene: spec.Scene) -> dict[str, Any]:
    """Return the creature file of the plan in a scene, without a measurement."""
    return creature.document(identity(identity_template(scene), genotype_of(scene)), None, None)
