"""Short form of a run, for lists of workers and queues."""

from ..tables import FINISHED, Run
from .schemas import RunBrief


def brief(run: Run) -> RunBrief:
    names = (name for name in RunBrief.model_fields if name != "progress")
    return RunBrief(**{name: getattr(run, name) for name in names}, progress=progress(run))


def progress(run: Run) -> float:
    """Return the completed share of a run's generations.

    A finished run counts as complete, even if it stopped early.
    """
    return 1.0 if run.status == FINISHED else min(1.0, run.generation / run.generations)
