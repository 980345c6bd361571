"""Estimate the time of a run from earlier runs of its kind on a device of a live worker."""

from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from math import log
from statistics import median
from typing import Any

from sqlalchemy import Row, and_, select
from sqlalchemy.orm import Session

from microcosmos.spec import Folding, QualityDiversity, Scaling, Spec, estimate

from ..core.schemas import Wire
from ..specs.parsing import parse_stored
from ..tables import Generation, Run, Worker

MAX_RECENT_RUNS = 40
"""Number of runs of an experiment to read, the newest."""
MAX_SIMILAR_RUNS = 5
"""Number of runs to average: those whose generations are most like the new one's."""


@dataclass(frozen=True)
class Measured:
    """The speed of one earlier run; its first generation, which compiled, stands apart."""

    device: str
    cell_steps: float
    """Cell steps of one generation."""
    rate: float
    """Cell steps per second."""
    startup_seconds: float
    """Seconds that its first generation took longer than the others."""


class MeasuredSpeed(Wire):
    """Speed of earlier runs of the same kind on a device of a live worker."""

    device: str
    runs: int
    cell_steps_per_second: float
    low: float
    """Seconds at the speed of the fastest of those runs."""
    high: float
    """Seconds at the speed of the slowest."""


@dataclass(frozen=True)
class Speed:
    device: str
    rates: tuple[float, ...]
    startup_seconds: float

    def seconds(self, cell_steps: int) -> float:
        return self.startup_seconds + cell_steps / median(self.rates)

    def read(self, cell_steps: int) -> MeasuredSpeed:
        return MeasuredSpeed(
            device=self.device,
            runs=len(self.rates),
            cell_steps_per_second=median(self.rates),
            low=self.startup_seconds + cell_steps / max(self.rates),
            high=self.startup_seconds + cell_steps / min(self.rates),
        )


def speeds_of(
    session: Session, specs: Sequence[Spec], live: Sequence[Worker]
) -> list[Speed | None]:
    """Return the speed of the runs most like each spec, if there are any.

    One query serves all specs, which share an experiment. Without live workers any device
    counts.
    """
    recent = _recent(session, specs[0].experiment)
    measured = {kind: _measured(recent, kind) for kind in {_kind(spec) for spec in specs}}
    return [_similar(measured[_kind(spec)], spec, live) for spec in specs]


def _similar(measured: Sequence[Measured], spec: Spec, live: Sequence[Worker]) -> Speed | None:
    found = [(one, model) for one in measured if (model := _model_of(one.device, live))]
    same = [one for one, _ in found if one.device == found[0][0].device]
    if not same:
        return None
    cell_steps = estimate(spec).cell_steps / spec.generations
    nearest = sorted(same, key=lambda one: abs(log(one.cell_steps / cell_steps)))[
        :MAX_SIMILAR_RUNS
    ]
    return Speed(
        device=found[0][1],
        rates=tuple(one.rate for one in nearest),
        startup_seconds=median(one.startup_seconds for one in nearest),
    )


def _model_of(device: str, live: Sequence[Worker]) -> str | None:
    """Return the model of a live worker's device that is of the kind of a run's `device`.

    The native kernel's kind names no model: its bits are the same on all. A kind of older
    software still tells the speed, if it names the model. Without live workers any kind does.
    """
    if not live:
        model = device.split(", ")[1]  # Without platform and software.
        return "a CPU" if model.startswith("microcosmos ") else model
    for worker in live:
        model = worker.device.partition(" (")[0]  # Without sizes.
        if device in worker.device_kinds or model in device:
            return model
    return None


def _recent(session: Session, experiment: str) -> Sequence[Row[Run, float]]:
    first = and_(Generation.run_id == Run.id, Generation.generation == 1)
    statement = (
        select(Run, Generation.seconds)
        .join(Generation, first)
        .where(Run.experiment == experiment, Run.generation > 1)
        .where(Run.seconds > Generation.seconds, Run.device.is_not(None))
        .order_by(Run.created_at.desc())
        .limit(MAX_RECENT_RUNS)
    )
    return session.execute(statement).all()


def _measured(recent: Sequence[Row[Run, float]], kind: Hashable) -> list[Measured]:
    found = []
    for run, first in recent:
        earlier = parse_stored(run.spec)
        if earlier and _kind(earlier.spec) == kind:
            cell_steps = earlier.estimate.cell_steps / earlier.spec.generations
            each = (run.seconds - first) / (run.generation - 1)
            rate, start = cell_steps / each, max(0.0, first - each)
            found.append(Measured(str(run.device), cell_steps, rate, start))
    return found


def _kind(spec: Any) -> Hashable:
    """Return a key that two specs share if their cell steps take about as long."""
    match spec:
        case QualityDiversity():  # Screening takes time beside the simulations.
            asked = spec.search.screening
            return asked and (asked.rounds, asked.candidates)
        case Folding():
            return spec.world.fluid
        case Scaling():  # Its time depends on nodes, which cell steps leave out.
            return spec.nodes, spec.width, spec.height
    return None
