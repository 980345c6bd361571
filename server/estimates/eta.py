"""How long a run will take, judged by earlier runs of its kind on a device that there is."""

from collections.abc import Collection, Hashable, Sequence
from dataclasses import dataclass
from math import log
from statistics import median
from typing import Any

from sqlalchemy import Row, and_, select
from sqlalchemy.orm import Session

from microcosmos.spec import Folding, Scaling, Spec, estimate

from ..specs.stored import known
from ..tables import Generation, Run, Worker
from .schemas import MeasuredSpeed

RECENT = 40
"""Runs of an experiment that are looked at, the newest."""
JUDGES = 5
"""Runs that count: those whose generations are most like the new one's."""


@dataclass(frozen=True)
class Measured:
    """What one earlier run tells. Its first generation is told apart: it had to compile."""

    device: str
    cell_steps: float
    """Of one generation."""
    rate: float
    """Cell steps a second."""
    start: float
    """Seconds that its first generation took longer than the others."""


@dataclass(frozen=True)
class Speed:
    """How fast some earlier runs were."""

    device: str
    rates: tuple[float, ...]
    start: float

    def seconds(self, cell_steps: int) -> float:
        return self.start + cell_steps / median(self.rates)

    def read(self, cell_steps: int) -> MeasuredSpeed:
        return MeasuredSpeed(
            device=self.device,
            runs=len(self.rates),
            cell_steps_per_second=median(self.rates),
            low=self.start + cell_steps / max(self.rates),
            high=self.start + cell_steps / min(self.rates),
        )


def speed_of(session: Session, spec: Spec, live: Sequence[Worker]) -> Speed | None:
    """The speed of the runs most like a spec; None where there are none to judge by.

    Without live workers any device counts: one such may come back.
    """
    return speeds_of(session, [spec], live)[0]


def speeds_of(
    session: Session, specs: Sequence[Spec], live: Sequence[Worker]
) -> list[Speed | None]:
    """The same of several specs of one experiment, asked of the database once."""
    models = {model_of(worker.device) for worker in live}
    recent = _recent(session, specs[0].experiment)
    measured = {kind: _measured(recent, kind) for kind in {_kind(spec) for spec in specs}}
    return [_judged(measured[_kind(spec)], spec, models) for spec in specs]


def _judged(measured: Sequence[Measured], spec: Spec, models: Collection[str]) -> Speed | None:
    found = [
        one for one in measured if not models or any(model in one.device for model in models)
    ]
    same = [one for one in found if one.device == found[0].device]
    if not same:
        return None
    own = estimate(spec).cell_steps / spec.generations
    judges = sorted(same, key=lambda one: abs(log(one.cell_steps / own)))[:JUDGES]
    return Speed(
        device=_name(judges[0].device, models),
        rates=tuple(one.rate for one in judges),
        start=median(one.start for one in judges),
    )


def model_of(device: str) -> str:
    """A worker's device without how much of it there is."""
    return device.partition(" (")[0]


def _name(device: str, models: Collection[str]) -> str:
    """What people call the device of a run: its platform and software left out."""
    found = [model for model in models if model in device]
    return found[0] if found else device.split(", ")[1]


def _recent(session: Session, experiment: str) -> Sequence[Row[Run, float]]:
    """The newest runs of an experiment with the seconds of their first generation."""
    first = and_(Generation.run_id == Run.id, Generation.generation == 1)
    statement = (
        select(Run, Generation.seconds)
        .join(Generation, first)
        .where(Run.experiment == experiment, Run.generation > 1)
        .where(Run.seconds > Generation.seconds, Run.device.is_not(None))
        .order_by(Run.created_at.desc())
        .limit(RECENT)
    )
    return session.execute(statement).all()


def _measured(recent: Sequence[Row[Run, float]], kind: Hashable) -> list[Measured]:
    """What runs of a kind tell, the newest first."""
    return [
        _told(run, seconds, earlier.needs.cell_steps / earlier.spec.generations)
        for run, seconds in recent
        if (earlier := known(run.spec)) and _kind(earlier.spec) == kind
    ]


def _told(run: Run, first: float, cell_steps: float) -> Measured:
    each = (run.seconds - first) / (run.generation - 1)
    return Measured(
        device=str(run.device),
        cell_steps=cell_steps,
        rate=cell_steps / each,
        start=max(0.0, first - each),
    )


def _kind(spec: Any) -> Hashable:
    """What cell steps must have in common to take about as long."""
    match spec:
        case Folding():
            return spec.world.fluid
        case Scaling():  # Whose time depends on nodes, which cell steps leave out.
            return spec.nodes, spec.width, spec.height
    return None
