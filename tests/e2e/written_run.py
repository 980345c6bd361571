"""A run whose generations a test writes, in place of a worker."""

from typing import Any
from uuid import UUID

import reports

from microcosmos.archive import creature
from microcosmos.spec import EXPERIMENTS, parse
from microcosmos_server.attempts.attempt import Attempt
from microcosmos_server.attempts.claim import claim
from microcosmos_server.runs.submission import submit
from microcosmos_server.services.services import Services

GENERATIONS = 12


def report(generation: int, seed: int) -> Any:
    """Two species, one of which dies out; three creatures of each generation diverge."""
    found = reports.report(
        generation,
        {generation: float(generation)},
        descriptors=(0.01, 0.01),
        summary={
            "infeasible.non-finite": 2,
            "infeasible.supersonic": 1,
            "emitter.population.inserted": generation % 3,
            "emitter.population.improved": 1,
            **(
                {"species.0": 10, "species.1": 6}
                if generation < GENERATIONS // 2
                else {"species.1": 16}
            ),
        },
    )
    (elite,) = found.elites
    identity = reports.identity(seed + generation)
    elite.creature, elite.identity = creature.name(identity), creature.canonical(identity)
    elite.measured = elite.provenance = None
    found.qd_score, found.coverage = float(generation**2), generation / 400
    found.mean, found.infeasible = 1.0, 3 * generation
    return found


class WrittenRun:
    """A run of neuroevolution, written generation by generation."""

    def __init__(self, services: Services, seed: int, viscosity: float | None = None):
        presets = EXPERIMENTS["neuroevolution"].presets
        document = presets[0].spec.model_dump(mode="json") | {"seed": seed}
        document["search"]["generations"] = GENERATIONS
        if viscosity:
            document["world"]["viscosity"] = viscosity
        self.spec, self.seed, self.services = parse(document), seed, services
        self.id: UUID = submit(services, self.spec)[0].id
        self.attempt: Attempt

    def claim(self, worker: str) -> None:
        held = claim(self.services, self.id, worker)
        assert held is not None
        self.attempt = held
        held.record_device("cpu, a processor")

    def write_generations(self, first: int, last: int) -> None:
        for generation in range(first, last + 1):
            self.attempt.record(report(generation, self.seed), 0.5)
        self.attempt.save(last, b"the archive of %d" % last)
