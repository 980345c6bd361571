"""Statistics of finished runs by their specs, compared as `microcosmos compare` does."""

import csv
from collections.abc import Awaitable, Callable, Sequence
from dataclasses import dataclass
from io import StringIO
from math import prod
from typing import TYPE_CHECKING, Annotated, Any
from uuid import UUID

import numpy as np
from fastapi import APIRouter, Depends, Query, Request
from fastapi.responses import Response
from sqlalchemy import Row, or_, select
from sqlalchemy.orm import Session

from microcosmos.archive.curves import CORRECTED
from microcosmos.version import VERSION

from ..auth.authorize import MAY_READ
from ..core.answers import respond, tag_of
from ..core.api import named, sends
from ..core.errors import Conflict, NotFound, invalid_field
from ..runs.lifecycle import NOT_IN_BIN
from ..services.services import ServicesDep
from ..specs.parsing import SEARCHES
from ..tables import FINISHED, TERMINAL, Generation, Run, Sweep, find
from .schemas import Statistics

if TYPE_CHECKING:
    from microcosmos.statistics import Comparison, RunRecord

COLUMNS = ("generation", "evaluations", "qd_score", "coverage", "best", "mean", "infeasible")
COMPARED = (Run.id, Run.experiment, Run.status, Run.generation, Run.rewinds, Run.sweep_index)
Found = Row[UUID, str, str, int, int, int | None]
MAX_MEASURES = 12
FORMS = {"csv": "text/csv", "tex": "application/x-tex"}
"""Media types of tables to download."""


@dataclass(frozen=True)
class Question:
    """The compared runs and measures, and the state on which the answer depends."""

    runs: tuple[UUID, ...]
    left_out: tuple[UUID, ...]
    """Runs that failed or were cancelled."""
    state: tuple[Any, ...]
    measures: tuple[str, ...]


def of_sweep(session: Session, sweep_id: UUID, measures: str) -> Question:
    """Return the question about all runs of a sweep, in the order of its cases.

    Raise `DomainError` where it cannot be compared.
    """
    cases = prod(map(len, find(session, Sweep, sweep_id).grid.values()))
    mine = select(*COMPARED).where(Run.sweep == sweep_id, NOT_IN_BIN).order_by(Run.sweep_index)
    runs = session.execute(mine).all()
    return _question(sorted(runs, key=lambda run: run.sweep_index % cases), measures)


def of_runs(session: Session, ids: Sequence[UUID], measures: str) -> Question:
    """Return the question about some runs, in their order.

    Raise `DomainError` where they cannot be compared.
    """
    found = session.execute(select(*COMPARED).where(Run.id.in_(ids), NOT_IN_BIN))
    runs = {run.id: run for run in found}
    for missing in (one for one in ids if one not in runs):
        raise NotFound(f"No run has the id {missing}.")
    return _question([runs[one] for one in dict.fromkeys(ids)], measures)


def _question(runs: Sequence[Found], measures: str) -> Question:
    for table in (run.experiment for run in runs if run.experiment not in SEARCHES):
        detail = f"Statistics need archives; runs of `{table}` have tables."
        raise NotFound(detail, title="No statistics")
    finished = [run for run in runs if run.status == FINISHED]
    active = sum(run.status not in TERMINAL for run in runs)
    if active or not finished:
        detail = f"Statistics need finished runs; {len(finished)} of {len(runs)} are finished."
        raise Conflict(detail, title="Runs are not finished")
    named = tuple(one.strip() for one in measures.split(",") if one.strip())
    if len(named) > MAX_MEASURES:
        raise invalid_field("measures", f"at most {MAX_MEASURES} measures", len(named))
    state = tuple((run.id, run.generation, run.rewinds) for run in finished)
    ids = tuple(run.id for run in finished)
    left_out = tuple(run.id for run in runs if run.status != FINISHED)
    return Question(ids, left_out, state, named)


def compared(session: Session, question: Question) -> "Comparison":
    """Compare the cases. Raise `DomainError` where they cannot be compared."""
    from microcosmos.statistics import by_spec, compare  # Loads SciPy.
    from microcosmos.statistics.measures import DEFAULT, Measure

    try:
        measures = [Measure.parse(text) for text in question.measures or DEFAULT]
    except ValueError as error:
        raise invalid_field("measures", f"{error}", ", ".join(question.measures)) from error
    last = all(one.at is None and one.reaches is None for one in measures)
    try:
        return compare(by_spec(records(session, question.runs, last)), measures)
    except ValueError as error:
        raise Conflict(f"{error}.", title="Cannot be compared") from error


def document(session: Session, question: Question) -> Statistics:
    """Return the comparison for the page."""
    from microcosmos.statistics import tables

    found = tables.document(compared(session, question))
    fields = {name: found[name] for name in Statistics.model_fields}
    if caution := _left_out(question):
        fields["cautions"] = [caution, *fields["cautions"]]
    return Statistics.model_validate(fields)


def table(session: Session, question: Question, form: str) -> str:
    """Return the comparison as CSV or LaTeX, with the runs that are left out."""
    from microcosmos.statistics import tables

    found = compared(session, question)
    if form == "csv":
        rows = StringIO()
        writer = csv.DictWriter(rows, tables.COLUMNS, restval="", lineterminator="\n")
        writer.writerows({"table": "left out", "run": run} for run in question.left_out)
        return tables.csv(found) + rows.getvalue()
    text, caution = tables.latex(found), _left_out(question)
    return text.replace("\\caption{", f"\\caption{{{caution} ", 1) if caution else text


def _left_out(question: Question) -> str:
    """Return a sentence on runs that are left out, empty without any."""
    count = len(question.left_out)
    if not count:
        return ""
    if count == 1:
        return "1 run is left out, since it failed or was cancelled."
    return f"{count} runs are left out, since they failed or were cancelled."


def records(session: Session, runs: Sequence[UUID], last: bool) -> list["RunRecord"]:
    """Return runs with their curves, or with the `last` generation of each, which comes after
    those with negative fitness."""
    from microcosmos.statistics import RunRecord

    names = (Run.id, Run.spec, Run.version, Run.device)
    rows = session.execute(select(*names).where(Run.id.in_(runs)))
    found = {row.id: row for row in rows}
    curves = _curves(session, runs, last)
    return [
        RunRecord(
            name=str(run.id),
            document=run.spec,
            curves=curves[run.id],
            version=run.version,
            devices=(run.device or "an unknown device",),
            state="finished",
        )
        for run in (found[run_id] for run_id in runs if run_id in found)
        if run.id in curves
    ]


def _curves(
    session: Session, runs: Sequence[UUID], last: bool
) -> dict[UUID, dict[str, np.ndarray]]:
    columns = [getattr(Generation, name) for name in COLUMNS]
    wanted = (
        select(Generation.run_id, *columns, Generation.summary)
        .join(Run, Run.id == Generation.run_id)
        .where(Run.id.in_(runs), Generation.generation <= Run.generation)
        .order_by(Generation.run_id, Generation.generation)
    )
    if last:
        # A caution must not depend on the measures: it is on negative fitness at any time.
        negative = [getattr(Generation, name) < 0 for name in ("best", "mean", "qd_score")]
        # What the first generation searched, and where elites were evaluated again.
        reevaluated = Generation.summary[CORRECTED[0]].as_float().is_not(None)
        ends = Generation.generation.in_((1, Run.generation))
        wanted = wanted.where(or_(ends, reevaluated, *negative))
    rows: dict[UUID, list[list[float | None]]] = {}
    for run_id, *values, summary in session.execute(wanted):
        corrected = [(summary or {}).get(name) for name in CORRECTED]
        rows.setdefault(run_id, []).append([*values, *corrected])
    return {
        run_id: dict(zip((*COLUMNS, *CORRECTED), np.array(each, float).T, strict=True))
        for run_id, each in rows.items()
    }


router = APIRouter(prefix="/statistics", tags=["runs"])
JSON = "application/json"
MAX_RUNS = 100
UUID_PATTERN = "[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}"
RUNS = rf"^{UUID_PATTERN}(,{UUID_PATTERN}){{0,{MAX_RUNS - 1}}}$"


def _selected(
    services: ServicesDep,
    runs: Annotated[str | None, Query(pattern=RUNS)] = None,
    sweep: UUID | None = None,
    measures: Annotated[str, Query(max_length=400)] = "",
) -> Question:
    """Read the state of the runs over a connection that is closed again."""
    if (runs is None) == (sweep is None):
        raise invalid_field("runs", "either `runs` or a `sweep`", runs)
    with services.sessions.read() as session:
        if sweep is not None:
            return of_sweep(session, sweep, measures)
        return of_runs(session, [UUID(one) for one in (runs or "").split(",")], measures)


QuestionDep = Annotated[Question, Depends(_selected)]


@router.get(
    "",
    responses={
        200: {"model": Statistics},
        304: {"description": "Unchanged"},
        404: {},
        409: {},
    },
    dependencies=[MAY_READ],
)
async def read_statistics(
    request: Request, question: QuestionDep, services: ServicesDep
) -> Response:
    """Compare finished runs, grouped by what differs in their specs beside the seed: quartiles,
    rank tests with Holm's correction, and effect sizes with bootstrap intervals.

    `runs` are ids separated by commas; or give the id of a `sweep`. `measures` are curves
    (`qd_score`), curves after evaluations (`qd_score@6400`) or the evaluations to a value
    (`best>=0.5`), separated by commas.
    """

    def make() -> bytes:
        with services.sessions.read() as session:
            return document(session, question).model_dump_json().encode()

    return await _answer(request, question, JSON, make, {})


def _table_reader(form: str, media_type: str) -> Callable[..., Awaitable[Response]]:
    async def read(request: Request, question: QuestionDep, services: ServicesDep) -> Response:
        def make() -> bytes:
            with services.sessions.read() as session:
                return table(session, question, form).encode()

        return await _answer(request, question, media_type, make, named(f"statistics.{form}"))

    return read


for form, media_type in FORMS.items():
    router.get(
        f".{form}",
        **sends(media_type, {404: {}, 409: {}}),
        name=f"read_statistics_{form}",
        description=f"Return the same comparison as {'CSV' if form == 'csv' else 'LaTeX'}.",
        dependencies=[MAY_READ],
    )(_table_reader(form, media_type))


async def _answer(
    request: Request,
    question: Question,
    media_type: str,
    make: Callable[[], bytes],
    headers: dict[str, str],
) -> Response:
    """Make the answer once for each state of the runs, in a thread."""
    tag = tag_of(VERSION, request.scope["route"].path, question)
    return await respond(request, tag, make, media_type, headers)
