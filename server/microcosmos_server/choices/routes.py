"""Routes of choices: list, choose, take back, and export."""

from typing import Annotated
from uuid import UUID

from fastapi import APIRouter, Query
from fastapi.responses import JSONResponse
from pydantic import Field
from sqlalchemy.orm import Session

from microcosmos.archive import choices as file
from microcosmos.spec import breeding_refusal
from microcosmos.spec.base import Digest

from ..auth.authorize import MAY_READ
from ..core.api import named
from ..core.json_body import json_route
from ..core.schemas import Wire
from ..creatures import initial
from ..runs.announce import changed
from ..runs.deps import OwnRunId, RunDep, find_run
from ..services.services import Services, ServicesDep, SessionDep
from ..tables import PENDING, Run
from . import choosing
from .choosing import MAX_PENDING


class Chosen(Wire):
    """Creatures to choose, by name."""

    creatures: Annotated[list[Digest], Field(min_length=1, max_length=MAX_PENDING)]


class ChoiceRead(Wire):
    creature: str
    generation: int | None
    """The first generation that descends from it; None until that begins."""


class ChoicesRead(Wire):
    """The chosen creatures of a run."""

    items: list[ChoiceRead]
    """By generation and name; those that do not count yet come last."""
    refusal: str | None
    """The reason why the run accepts no chosen creatures; None if it does."""


router = APIRouter(prefix="/runs/{run_id}", tags=["runs"], route_class=json_route(64 << 10))


@router.get("/choices", dependencies=[MAY_READ])
def read_choices(run: RunDep, session: SessionDep) -> ChoicesRead:
    """Return the chosen creatures, and from which generation each counts."""
    return _read(session, run)


@router.post("/choices")
def choose_creatures(run_id: OwnRunId, services: ServicesDep, sent: Chosen) -> ChoicesRead:
    """Choose creatures of the run's archive for the next generations to descend from.

    A part of the next generation descends from them, and a smaller part of each later one
    (`search.breeding`).
    """
    names = sent.creatures
    changed(services, run_id, lambda session, run: choosing.choose(session, run, names))
    return _of(services, run_id)


@router.delete("/choices")
def take_back_choices(
    run_id: OwnRunId,
    services: ServicesDep,
    creature: Annotated[list[Digest], Query(max_length=choosing.MAX_PENDING)] = [],  # noqa: B006
) -> ChoicesRead:
    """Take back choices that do not count yet, of some creatures or all; return the others."""
    changed(services, run_id, lambda session, run: choosing.take_back(session, run, creature))
    return _of(services, run_id)


@router.get("/choices.json", dependencies=[MAY_READ])
def export_choices(run: RunDep, session: SessionDep) -> JSONResponse:
    """Return the choices that count, with the files of their creatures.

    `microcosmos evolve SPEC --choices FILE` repeats the run with them.
    """
    rows = [row for row in choosing.counted(session, run) if row.generation != PENDING]
    files = initial.files(session, sorted({row.creature for row in rows}))
    return JSONResponse(
        file.document([(row.generation, row.creature) for row in rows], files),
        headers=named(f"choices-{str(run.id)[:8]}.json"),
    )


def _of(services: Services, run_id: UUID) -> ChoicesRead:
    with services.sessions.read() as session:
        return _read(session, find_run(session, run_id))


def _read(session: Session, run: Run) -> ChoicesRead:
    rows = choosing.counted(session, run)
    items = [
        ChoiceRead(creature=row.creature, generation=row.generation or None) for row in rows
    ]
    refusal = breeding_refusal(run.spec)
    return ChoicesRead(items=items, refusal=str(refusal) if refusal else None)
