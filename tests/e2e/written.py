"""A run that no worker computes: what one would write of it is written here."""

import base64
import struct
from types import SimpleNamespace
from typing import Any
from uuid import UUID

from microcosmos.archive import creature
from microcosmos.spec import EXPERIMENTS, parse
from server.attempts.attempt import Attempt
from server.attempts.claim import claim
from server.runs.submission import submit
from server.services.services import Services

GENERATIONS = 12


def floats(*values: float) -> str:
    return base64.b64encode(struct.pack(f"<{len(values)}f", *values)).decode()


def swimmer(spec: Any, weight: float) -> dict[str, Any]:
    written = spec.model_dump(mode="json")
    nodes = {"id": [0, 1, 2, 3, 4], "activation": ["identity"] * 5, "bias": floats(*[0.0] * 5)}
    ends = {"innovation": [0], "source": [1], "target": [3], "enabled": [True]}
    return {
        "format": "microcosmos-creature/1",
        "genome": {
            "encoding": "cppn",
            "inputs": ["position", "sine", "cosine"],
            "outputs": ["rest_angle", "rest_length"],
            "control": written["control"],
            "nodes": nodes,
            "connections": {**ends, "weight": floats(weight)},
        },
        "world": {**written["world"], "coupling": written["coupling"]},
        "body": written["body"],
        "task": written["task"],
    }


def report(spec: Any, generation: int, seed: int) -> Any:
    """Two species, one of which dies out; three creatures of each generation diverge."""
    whole = swimmer(spec, seed + generation)
    elite = SimpleNamespace(
        cell=generation,
        fitness=float(generation),
        descriptors=[0.01, 0.01],
        creature=creature.name(whole),
        identity=creature.canonical(whole),
        generation=generation,
        measured=None,
        provenance=None,
    )
    species = "0:10 1:6" if generation < GENERATIONS // 2 else "1:16"
    return SimpleNamespace(
        generation=generation,
        qd_score=float(generation**2),
        coverage=generation / 400,
        best=float(generation),
        mean=1.0,
        evaluations=16 * generation,
        diverged=3 * generation,
        elites=(elite,),
        rows=(),
        summary={
            "diverged: non-finite": 2,
            "diverged: supersonic": 1,
            "population: inserted": generation % 3,
            "population: improved": 1,
            "species": species,
        },
    )


class Written:
    """A run of neuroevolution, written generation by generation."""

    def __init__(self, services: Services, seed: int):
        presets = EXPERIMENTS["neuroevolution"].presets
        document = presets[0].spec.model_dump(mode="json") | {"seed": seed}
        document["search"]["generations"] = GENERATIONS
        self.spec, self.seed, self.services = parse(document), seed, services
        self.id: UUID = submit(services, self.spec)[0].id
        self.attempt: Attempt

    def begin(self, worker: str) -> None:
        held = claim(self.services, self.id, worker)
        assert held is not None
        self.attempt = held
        held.use("cpu, a processor")

    def go_on(self, first: int, last: int) -> None:
        for generation in range(first, last + 1):
            self.attempt.record(report(self.spec, generation, self.seed), 0.5)
        self.attempt.save(last, b"the archive of %d" % last)
