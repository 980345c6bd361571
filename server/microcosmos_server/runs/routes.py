"""Routes of runs: estimate, submit, list, read, edit, control and delete; their details."""

import re
from collections.abc import Sequence
from typing import Annotated, Any, Literal
from uuid import UUID

from fastapi import APIRouter, Query, Request, Response
from pydantic import Field
from sqlalchemy import ColumnElement, Row, Select, func, or_, select, true
from sqlalchemy.ext.compiler import compiles
from sqlalchemy.orm import Session
from sqlalchemy.sql.functions import GenericFunction

from microcosmos.spec import EXPERIMENTS, Folding, drawing, estimate, parse, targets

from ..auth.authorize import MAY_READ, MAY_READ_SHARED, Reader, Writer
from ..core.errors import NotFound, invalid_field
from ..core.json_body import json_route
from ..core.paging import COUNT, MOMENT, NUMBER, TEXT, Order, length
from ..core.schemas import MAX_INTEGER, Wire
from ..estimates import position
from ..estimates.eta import MeasuredSpeed, speeds_of
from ..estimates.position import QueueAhead
from ..services.services import ServicesDep, SessionDep
from ..specs.parsing import SPEC_BYTES, SpecDep
from ..specs.schemas import DrawingRead, pictures
from ..tables import PROGRESS, STATUS_PLACE, STATUSES, Generation, Run, Status
from ..workers import registry
from . import curves, lifecycle, log
from .announce import changed
from .curves import thinned
from .deps import AnyRunDep, OwnRunId, RunDep
from .lifecycle import NOT_IN_BIN
from .overview import read_run, read_runs
from .schemas import (
    Curves,
    Log,
    LogEntryRead,
    RunChange,
    RunPage,
    RunRead,
    Species,
    Submission,
    TagRead,
    Target,
)
from .submission import IdempotencyKey, IdempotentRequest, answer, memory_limit, refuse_urgent

Sort = Literal[
    "created", "-created", "started", "-started", "finished", "-finished",
    "name", "-name", "experiment", "-experiment", "status", "-status",
    "progress", "-progress", "evaluations", "-evaluations",
    "qd_score", "-qd_score", "coverage", "-coverage", "best", "-best",
]  # fmt: skip

KEYS: dict[str, tuple[ColumnElement[Any], Any]] = {
    "created": (Run.created_at.expression, MOMENT),
    "started": (Run.started_at.expression, MOMENT),
    "finished": (Run.finished_at.expression, MOMENT),
    "name": (func.lower(Run.name), TEXT),
    "experiment": (Run.experiment.expression, TEXT),
    "status": (STATUS_PLACE, Annotated[int, Field(ge=0, lt=len(STATUSES))]),
    "progress": (PROGRESS, NUMBER),
    "evaluations": (Run.evaluations.expression, COUNT),
    "qd_score": (Run.qd_score.expression, NUMBER),
    "coverage": (Run.coverage.expression, NUMBER),
    "best": (Run.best.expression, NUMBER),
}


def order(sort: str) -> Order:
    return Order(sort, *KEYS[sort.removeprefix("-")], Run.id, UUID, length(Run.spec))


# Both databases make a table of the members of an array, under different names.
class members(GenericFunction[str]):
    """The texts in a JSON array, a row each, in the column `value`."""

    inherit_cache = True


@compiles(members, "sqlite")
def _sqlite_members(element: members, compiler: Any, **options: Any) -> str:
    return f"json_each({compiler.process(element.clauses, **options)})"


@compiles(members, "postgresql")
def _postgresql_members(element: members, compiler: Any, **options: Any) -> str:
    return f"json_array_elements_text({compiler.process(element.clauses, **options)})"


def matching(
    statuses: Sequence[str],
    experiments: Sequence[str],
    tag: str | None,
    text: str | None,
    sweep: UUID | Literal["none"] | None = None,
    deleted: bool = False,
) -> Select[Run]:
    """Select runs by any of the states and experiments, a tag, a text and a sweep.

    Select either runs in the bin, or all others.
    """
    statement = select(Run).where(~NOT_IN_BIN if deleted else NOT_IN_BIN)
    if statuses:
        statement = statement.where(Run.status.in_(statuses))
    if experiments:
        statement = statement.where(Run.experiment.in_(experiments))
    if tag is not None:
        statement = statement.where(_tagged(lambda value: value == tag))
    if sweep is not None:
        statement = statement.where(Run.sweep == (None if sweep == "none" else sweep))
    wanted = (text or "").strip()
    return statement.where(_contains(wanted)) if wanted else statement


def _tagged(condition: Any) -> ColumnElement[bool]:
    value = members(Run.tags).table_valued("value")
    return select(value.c.value).where(condition(value.c.value)).exists()


def _contains(text: str) -> ColumnElement[bool]:
    """Return the condition that a run contains a text; wildcards are ordinary characters."""
    inside = [column.icontains(text, autoescape=True) for column in (Run.name, Run.note)]
    tagged = _tagged(lambda value: value.icontains(text, autoescape=True))
    return or_(*inside, tagged, *_id_starts_with(text))


def _id_starts_with(text: str) -> list[ColumnElement[bool]]:
    """Compare ids with a range, which works on every database."""
    digits = text.replace("-", "").lower()
    if not re.fullmatch("[0-9a-f]{1,32}", digits):
        return []
    low, high = (UUID(digits.ljust(32, end)) for end in "0f")
    return [Run.id.between(low, high)]


def tags(session: Session) -> Sequence[Row[str, int]]:
    """Return all tags and their numbers of runs, by name."""
    value = members(Run.tags).table_valued("value").c.value
    counted = select(value, func.count()).select_from(Run).join(value.table, true())
    counted = counted.where(NOT_IN_BIN)
    return session.execute(counted.group_by(value).order_by(value)).all()


class EstimateRead(Wire):
    memory_bytes: int
    memory_limit_bytes: int
    evaluations: int
    cell_steps: int
    seconds: float | None
    """The estimate; None if no such run was measured on a device of a live worker."""
    speed: MeasuredSpeed | None
    """The measured speed behind `seconds`."""
    queue: QueueAhead
    drawing: DrawingRead


router = APIRouter(tags=["runs"], route_class=json_route(SPEC_BYTES))


@router.post("/runs", status_code=202, responses={200: {"model": RunRead}})
def create_run(
    principal: Writer,
    spec: SpecDep,
    services: ServicesDep,
    response: Response,
    asked: Annotated[Submission, Query()],
    idempotency_key: IdempotencyKey = None,
) -> RunRead:
    """Queue a run. The same key with the same request gives the same run, with 200."""
    refuse_urgent(principal, asked)
    columns = {**asked.model_dump(), "name": asked.name or None}
    body = {"spec": spec.model_dump(mode="json"), **columns}
    request = IdempotentRequest(body, idempotency_key, principal.token)
    return answer(services, response, request, lambda: (spec, columns))


@router.post("/runs/estimate")
def estimate_run(
    principal: Reader, spec: SpecDep, services: ServicesDep, session: SessionDep
) -> EstimateRead:
    """Return the needs of a run and a drawing, without queueing it."""
    needed = estimate(spec)
    alive = registry.live(session, services.settings.lease)
    (speed,) = speeds_of(session, [spec], alive)
    return EstimateRead(
        memory_bytes=needed.memory_bytes,
        memory_limit_bytes=memory_limit(services, session),
        evaluations=needed.evaluations,
        cell_steps=needed.cell_steps,
        seconds=speed.seconds(needed.cell_steps) if speed else None,
        speed=speed.read(needed.cell_steps) if speed else None,
        queue=position.ahead(services, session, principal.token),
        drawing=DrawingRead.model_validate(drawing(spec)),
    )


Text = Annotated[str, Query(min_length=1, max_length=200, pattern=r"^[^\x00]*$")]


@router.get("/runs", dependencies=[MAY_READ])
def list_runs(
    services: ServicesDep,
    session: SessionDep,
    cursor: str | None = None,
    limit: Annotated[int, Query(ge=1, le=200)] = 50,
    status: Annotated[list[Status], Query()] = [],  # noqa: B006
    experiment: Annotated[list[str], Query()] = [],  # noqa: B006
    tag: Text | None = None,
    q: Text | None = None,
    sweep: UUID | Literal["none"] | None = None,
    sort: Sort = "-created",
    deleted: bool = False,
) -> RunPage:
    """Return runs with any of these states and experiments, this tag and this text.

    A page has fewer runs than `limit` where specs are long: `next` tells whether more follow.
    `q` searches names, tags, notes and the start of ids. `sweep` is an id, or `none`. With `-`
    the sort is descending; runs without a value come last. `deleted` selects the bin.
    """
    for name in experiment:
        if name not in EXPERIMENTS:
            raise invalid_field("experiment", f"one of {', '.join(EXPERIMENTS)}", name)
    statement = matching(status, experiment, tag, q, sweep, deleted)
    runs, following = order(sort).page(session, statement, cursor, limit)
    return RunPage(items=read_runs(services, session, runs), next=following)


@router.get("/runs/{run_id}", dependencies=[MAY_READ_SHARED])
def read(run: AnyRunDep, services: ServicesDep, session: SessionDep) -> RunRead:
    return read_run(services, session, run)


@router.patch("/runs/{run_id}")
def change_run(
    request: Request, run_id: OwnRunId, services: ServicesDep, sent: RunChange
) -> RunRead:
    """Change a run's name, tags, note or scheduling."""
    refuse_urgent(request.state.principal, sent)
    values = sent.values()

    def edit(session: Session, run: Run) -> Run:
        return lifecycle.change(session, run.id, **values) or run if values else run

    run = changed(services, run_id, edit)
    services.wake.send()
    return run


@router.post("/runs/{run_id}/pause", status_code=202)
def pause_run(run_id: OwnRunId, services: ServicesDep) -> RunRead:
    return changed(services, run_id, lifecycle.pause)


@router.post("/runs/{run_id}/resume", status_code=202)
def resume_run(run_id: OwnRunId, services: ServicesDep) -> RunRead:
    run = changed(services, run_id, lifecycle.resume)
    services.wake.send()
    return run


@router.post("/runs/{run_id}/cancel", status_code=202)
def cancel_run(run_id: OwnRunId, services: ServicesDep) -> RunRead:
    return changed(services, run_id, lifecycle.cancel)


@router.post("/runs/{run_id}/uncancel", status_code=202)
def uncancel_run(run_id: OwnRunId, services: ServicesDep) -> RunRead:
    """Take a cancellation back. The run continues from its last checkpoint."""
    run = changed(services, run_id, lifecycle.uncancel)
    services.wake.send()
    return run


@router.delete("/runs/{run_id}")
def delete_run(run_id: OwnRunId, services: ServicesDep) -> RunRead:
    """Move a run to the bin, from which it can be restored until `purge_at`."""
    keep = services.settings.bin_seconds
    return changed(services, run_id, lambda session, run: lifecycle.delete(session, run, keep))


@router.post("/runs/{run_id}/restore")
def restore_run(run_id: OwnRunId, services: ServicesDep) -> RunRead:
    """Restore a run from the bin."""
    return changed(services, run_id, lifecycle.restore, deleted=True)


@router.get("/runs/{run_id}/generations", dependencies=[MAY_READ_SHARED])
def read_generations(
    run: RunDep,
    session: SessionDep,
    points: Annotated[int | None, Query(ge=2, le=10_000)] = None,
) -> Curves:
    """Return all generations, or about `points` of them, evenly spaced.

    `summary` has the newest values since the previous point.
    """
    names = [name for name in Curves.model_fields if name != "summary"]
    statement = select(*(getattr(Generation, name) for name in names)).where(
        Generation.run_id == run.id, Generation.generation <= run.generation
    )
    if points:
        statement = statement.where(Generation.generation.in_(thinned(run.generation, points)))
    rows = session.execute(statement.order_by(Generation.generation)).all()
    values = [list(column) for column in zip(*rows, strict=True)] or [[] for _ in names]
    columns = dict(zip(names, values, strict=True))
    return Curves(**columns, summary=curves.summaries(session, run.id, columns["generation"]))


@router.get("/runs/{run_id}/species", dependencies=[MAY_READ])
def read_species(
    run: RunDep,
    session: SessionDep,
    points: Annotated[int, Query(ge=2, le=10_000)] = 400,
) -> Species:
    """Return the sizes of the species in about `points` generations, evenly spaced.

    The columns are empty if the search has no species.
    """
    return Species(**curves.species(session, run.id, thinned(run.generation, points)))


@router.get("/runs/{run_id}/log", dependencies=[MAY_READ])
def read_log(
    run: RunDep,
    session: SessionDep,
    after: Annotated[int | None, Query(ge=0, le=MAX_INTEGER)] = None,
    limit: Annotated[int, Query(ge=1, le=1000)] = 500,
) -> Log:
    """Return the newest entries, oldest first; or those that follow the entry `after`.

    An attempt keeps the first and the last entry about checkpoints.
    """
    found = log.read(session, run.id, after, limit)
    return Log(entries=[LogEntryRead.model_validate(entry) for entry in found])


@router.get("/runs/{run_id}/targets", dependencies=[MAY_READ])
def read_targets(run: RunDep) -> list[Target]:
    """Return the pictures in the order of the spec, at most 256 pixels along a side."""
    if run.experiment != "folding":
        raise NotFound(f"A run of `{run.experiment}` has no pictures.", title="No pictures")
    spec = parse(run.spec)
    assert isinstance(spec, Folding)
    longest = min(spec.size, targets.MAX_PIXELS)
    fitted = [(one.name, targets.fitted(one.ink, longest)) for one in spec.targets]
    return [Target(**dict(one), size=spec.size) for one in pictures(fitted)]


@router.get("/tags", dependencies=[MAY_READ])
def list_tags(session: SessionDep) -> list[TagRead]:
    """Return all tags by name."""
    return [TagRead(tag=tag, runs=runs) for tag, runs in tags(session)]
