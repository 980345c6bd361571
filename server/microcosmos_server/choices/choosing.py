"""Choose creatures of a run, take choices back, and count them from a generation on.

A choice waits until a worker begins a generation that no attempt has begun before. There the
worker's transaction gives it the number of that generation, for good: an attempt that repeats
the generation reads the same choices.
"""

from collections.abc import Collection, Sequence

from sqlalchemy import delete, select, update
from sqlalchemy.orm import Session

from microcosmos.spec import breeding_refusal

from ..core.database import insert_missing
from ..core.errors import Conflict, FieldError, invalid_field
from ..runs.lifecycle import change, refuse
from ..runs.log import note
from ..tables import CANCELLED, PAUSED, PENDING, QUEUED, RUNNING, Choice, Elite, Run

MAX_PENDING = 64
"""Most creatures that are chosen for one generation."""


def choose(session: Session, run: Run, creatures: Sequence[str]) -> Run:
    """Choose creatures that have entered the run's archive, each once.

    Raise `DomainError` if the run cannot descend from them.
    """
    if refusal := breeding_refusal(run.spec):
        raise Conflict(
            str(refusal),
            [FieldError.of(refusal)],
            title="No descent from chosen creatures",
        )
    names = set(creatures)
    entered = select(Elite.creature).where(Elite.run_id == run.id, Elite.creature.in_(names))
    if missing := sorted(names - set(session.scalars(entered))):
        needed = "creatures that have entered the archive of this run"
        raise invalid_field("creatures", needed, missing[0])
    # The lock orders this after the beginning of a generation, or before it.
    locked = _continuing(session, run) or refuse(
        session, "breed from creatures of", run, "queued, running or paused before its end"
    )
    waiting = set(session.scalars(_pending(run)))
    if len(names | waiting) > MAX_PENDING:
        needed = f"at most {MAX_PENDING} chosen creatures for one generation"
        raise invalid_field("creatures", needed, len(names | waiting))
    new = sorted(names - waiting)
    insert_missing(
        session,
        Choice,
        [{"run_id": run.id, "generation": PENDING, "creature": name} for name in new],
    )
    if new:
        note(session, locked, f"Chosen to breed from the next generation on: {_named(new)}.")
    return locked


def _continuing(session: Session, run: Run) -> Run | None:
    """Return the locked row of a run that has another generation to begin."""
    status = Run.status.in_((QUEUED, RUNNING, PAUSED))
    asked = Run.requested_state.is_distinct_from(CANCELLED)
    more = Run.begun_generation < Run.generations
    return change(session, run.id, status, asked, more, attempt=Run.attempt)


def take_back(session: Session, run: Run, creatures: Collection[str]) -> Run:
    """Delete choices that wait for a generation: those of some creatures, or all."""
    mine = [Choice.run_id == run.id, Choice.generation == PENDING]
    mine += [Choice.creature.in_(creatures)] if creatures else []
    gone = sorted(session.scalars(delete(Choice).where(*mine).returning(Choice.creature)))
    if gone:
        note(session, run, f"No longer chosen: {_named(gone)}.")
    return run


def begin(session: Session, run: Run, generation: int) -> Sequence[str]:
    """Return the creatures that count from a generation on.

    A generation that begins for the first time takes all choices that wait.
    """
    mine = (Choice.run_id == run.id, Choice.generation == generation)
    counted = select(Choice.creature).where(*mine).order_by(Choice.creature)
    if generation <= run.begun_generation:
        return session.scalars(counted).all()
    run.begun_generation = generation
    waiting = (Choice.run_id == run.id, Choice.generation == PENDING)
    # For good: an attempt that repeats the generation must read the same choices
    # (tests/server/choices/test_choices.py).
    session.execute(update(Choice).where(*waiting).values(generation=generation))
    names = session.scalars(counted).all()
    if names:
        text = f"From generation {generation} on, offspring descend from chosen creatures: "
        note(session, run, f"{text}{_named(names)}.")
    return names


def forget(session: Session, run: Run, generation: int, creatures: Collection[str]) -> None:
    """Delete choices of creatures that the run, continued on another kind of device, lacks."""
    mine = (Choice.run_id == run.id, Choice.generation == generation)
    session.execute(delete(Choice).where(*mine, Choice.creature.in_(creatures)))
    text = "Not bred from, because the repeated generations did not produce them again: "
    note(session, run, f"{text}{_named(sorted(creatures))}.", "warning")


def counted(session: Session, run: Run) -> list[Choice]:
    """Return choices by generation and name; those that wait come last."""
    mine = select(Choice).where(Choice.run_id == run.id)
    order = (Choice.generation == PENDING, Choice.generation, Choice.creature)
    return list(session.scalars(mine.order_by(*order)))


def _pending(run: Run):
    return select(Choice.creature).where(Choice.run_id == run.id, Choice.generation == PENDING)


def _named(names: Sequence[str]) -> str:
    return ", ".join(name[:8] for name in names)
