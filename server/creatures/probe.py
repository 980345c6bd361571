"""An example creature: a filament at rest, for warming up the sandbox."""

from typing import Any

import numpy as np

from microcosmos.naming import FORMAT, encode
from microcosmos.spec import EXPERIMENTS


def example() -> dict[str, Any]:
    """Return the identity of a swimmer without hidden nodes, in the demonstration's world."""
    spec: Any = EXPERIMENTS["quality-diversity"].presets[0].spec
    whole, control = spec.model_dump(mode="json"), spec.control
    ends = [*control.inputs, *control.outputs]
    return {
        "format": FORMAT,
        "genome": {
            "encoding": "cppn",
            "inputs": list(control.inputs),
            "outputs": list(control.outputs),
            "control": whole["control"],
            "nodes": {
                "id": list(range(len(ends))),
                "activation": ["identity"] * len(ends),
                "bias": encode(np.zeros(len(ends))),
            },
            "connections": {
                "innovation": [],
                "source": [],
                "target": [],
                "enabled": [],
                "weight": "",
            },
        },
        "world": {
            **spec.world.model_dump(mode="json"),
            "coupling": spec.coupling.model_dump(mode="json"),
        },
        "body": whole["body"],
        "task": whole["task"],
    }
