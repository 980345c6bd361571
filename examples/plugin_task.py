"""A plug-in: a fitness (straight swimming), a descriptor (sway) and a body (a cross).

    microcosmos evolve spec.json --module examples/plugin_task.py

A name in a spec is the file's name, a dot and the name below: `plugin_task.straight`. On a
worker with `MICROCOSMOS_MODULES=examples/plugin_task.py` the page offers all three; see
docs/plugins.md.
"""

from pathlib import Path
from typing import Any

import jax.numpy as jnp
import numpy as np
from pydantic import Field

import microcosmos
from microcosmos import bodies, plugins
from microcosmos.search import Motion
from microcosmos.spec import Part


class Straight(Part):
    """Settings are fields with a default; forms show them with their range and docstring."""

    strictness: float = Field(default=1.0, ge=0.0, le=10.0)
    """Power of the share of the way that led on; 0: any way is as good."""


@plugins.fitness("straight", title="Straight way", unit="cells", settings=Straight)
def straight(motion: Motion, settings: Straight):
    """Displacement, times the share of the way that led straight on.

    Functions are pure JAX on one creature, so that they compile with its simulation and have
    derivatives.
    """
    share = jnp.clip(motion.measures["straightness"], 1e-6, 1.0)
    return motion.measures["displacement"] * share**settings.strictness


@plugins.descriptor("sway", title="Sway", unit="cells", low=1e-3, high=1.0, scale="log10")
def sway(motion: Motion):
    """Mean distance of the body from the line between its first and last positions."""
    way = motion.path - motion.path[0][None]
    end = way[-1]
    length = jnp.sqrt(jnp.sum(end * end) + 1e-12)
    aside = (way[:, 0] * end[1] - way[:, 1] * end[0]) / length
    return jnp.sqrt(jnp.mean(aside * aside) + 1e-12)


class Cross(Part):
    """The size of the cross."""

    long: int = Field(default=4, ge=1, le=32, json_schema_extra={"unit": "nodes"})
    """Nodes of each of the two arms along x, the middle one not among them."""
    short: int = Field(default=2, ge=1, le=32, json_schema_extra={"unit": "nodes"})
    """Nodes of each of the two arms along y."""


@plugins.body("cross", title="A cross", nodes=129, settings=Cross)
def cross(settings: Cross) -> bodies.Body:
    """Two long arms and two short ones from a middle node."""
    nodes, edges = [(0.0, 0.0)], []
    arms = ((1, 0, settings.long), (0, 1, settings.short))
    for x, y, count in (*arms, *((-x, -y, count) for x, y, count in arms)):
        before = 0
        for step in range(1, count + 1):
            nodes.append((x * step, y * step))
            edges.append((before, len(nodes) - 1))
            before = len(nodes) - 1
    return bodies.from_edges(np.array(nodes, float), np.array(edges))


SPEC: dict[str, Any] = {
    "experiment": "quality-diversity",
    "world": {"width": 32, "height": 32},
    "body": {"builder": "plugin_task.cross"},
    "control": {"period": 50, "angle_scale": 0.3, "length_scale": 0.2},
    "task": {"steps": 200, "fitness": "plugin_task.straight"},
    "archive": {
        "descriptors": [
            {"name": "plugin_task.sway", "bins": 10},
            {"name": "bending_effort", "bins": 10},
        ]
    },
    "search": {"generations": 20, "batch": 16},
}


def main(archive: Path = Path("plugin_task.h5"), **changes: Any) -> Path:
    """Evolve crosses that swim straight; the archive file."""
    microcosmos.prepare()
    plugins.load(__file__)
    changed = {name: {**SPEC[name], **part} for name, part in changes.items()}
    microcosmos.evolve(
        microcosmos.parse({**SPEC, **changed}),
        archive,
        tell=lambda report: print(f"{report.generation}: best {report.best:.3f}"),
    )
    return archive


if __name__ == "__main__":
    main()
