"""Statistics of finished runs by their specs, compared as `microcosmos compare` does."""

import csv
from collections.abc import Awaitable, Callable, Sequence
from dataclasses import dataclass
from io import StringIO
from itertools import combinations
from math import prod
from typing import TYPE_CHECKING, Annotated, Any
from uuid import UUID

import numpy as np
from fastapi import APIRouter, Depends, Query, Request
from fastapi.responses import Response
from sqlalchemy import Row, Select, func, or_, select
from sqlalchemy.orm import Session

from microcosmos.archive.curves import CORRECTED
from microcosmos.version import VERSION

from ..auth.authorize import MAY_READ
from ..core.answers import respond, tag_of
from ..core.api import named, sends
from ..core.errors import Conflict, FieldError, Invalid, NotFound, invalid_field
from ..runs.lifecycle import NOT_IN_BIN
from ..services.services import Services, ServicesDep
from ..specs.parsing import SEARCHES
from ..tables import FINISHED, TERMINAL, Generation, Run, Sweep, find
from .schemas import Statistics

if TYPE_CHECKING:
    from microcosmos.statistics import Comparison, Group, RunRecord

COLUMNS = ("generation", "evaluations", "qd_score", "coverage", "best", "mean", "infeasible")
COMPARED = (Run.id, Run.experiment, Run.status, Run.generation, Run.rewinds, Run.sweep_index)
Found = Row[UUID, str, str, int, int, int | None]
MAX_MEASURES = 12
# One interval of A12 takes 5.4 ms with 5 runs in each group on a slow machine, of which 4 ms do
# not depend on the runs; each pair of runs takes 0.06 ms more. Both limits together are 20 s.
MAX_PAIRS, MAX_RUN_PAIRS = 2000, 200_000
"""Limits on the pairs of groups, and of runs in two groups, over all measures."""
# About 150 MB and 3 s.
MAX_GENERATIONS = 200_000
"""Limit on the rows of curves that one answer reads."""
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
    sweep: UUID | None = None
    """The sweep of the runs, if it was asked for."""


def of_sweep(session: Session, sweep_id: UUID, measures: str) -> Question:
    """Return the question about all runs of a sweep, in the order of its cases.

    Raise `DomainError` where it cannot be compared.
    """
    cases = prod(map(len, find(session, Sweep, sweep_id).grid.values()))
    mine = select(*COMPARED).where(Run.sweep == sweep_id, NOT_IN_BIN).order_by(Run.sweep_index)
    runs = session.execute(mine).all()
    in_order = sorted(runs, key=lambda run: run.sweep_index % cases)
    return _question(in_order, measures, sweep_id)


def of_runs(session: Session, ids: Sequence[UUID], measures: str) -> Question:
    """Return the question about some runs, in their order.

    Raise `DomainError` where they cannot be compared.
    """
    found = session.execute(select(*COMPARED).where(Run.id.in_(ids), NOT_IN_BIN))
    runs = {run.id: run for run in found}
    for missing in (one for one in ids if one not in runs):
        raise NotFound(f"No run has the id {missing}.")
    return _question([runs[one] for one in dict.fromkeys(ids)], measures)


def _question(runs: Sequence[Found], measures: str, sweep: UUID | None = None) -> Question:
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
    return Question(ids, left_out, state, named, sweep)


def compared(services: Services, question: Question) -> "Comparison":
    """Compare the cases. Raise `DomainError` where they cannot be compared."""
    from microcosmos.statistics import by_spec, compare  # Loads SciPy.
    from microcosmos.statistics.measures import DEFAULT, Measure

    try:
        measures = [Measure.parse(text) for text in question.measures or DEFAULT]
    except ValueError as error:
        raise invalid_field("measures", f"{error}", ", ".join(question.measures)) from error
    last = all(one.at is None and one.reaches is None for one in measures)
    with services.sessions.read() as session:
        found = records(session, question, last)
    # Without the session: PostgreSQL ends a transaction that is idle while tests are made.
    try:
        groups = by_spec(found)
        _refuse_many(question, groups, len(set(measures)))
        return compare(groups, measures)
    except ValueError as error:
        raise Conflict(f"{error}.", title="Cannot be compared") from error


def _refuse_many(question: Question, groups: Sequence["Group"], measures: int) -> None:
    """Raise `DomainError` for more pairs than one answer compares."""
    from microcosmos.statistics.comparison import too_few

    if too_few(groups):  # There are no tests.
        return
    sizes = combinations([len(group.runs) for group in groups], 2)
    products = [ours * theirs for ours, theirs in sizes]
    pairs, of_runs = measures * len(products), measures * sum(products)
    if pairs > MAX_PAIRS or of_runs > MAX_RUN_PAIRS:
        needed = f"at most {MAX_PAIRS:,} pairs of groups and {MAX_RUN_PAIRS:,} pairs of runs"
        got = f"{pairs:,} pairs of groups and {of_runs:,} pairs of runs over all measures"
        raise _too_large(question, needed, got, "fewer groups, runs or measures")


def _too_large(question: Question, needed: str, got: str, instead: str) -> Invalid:
    """Return the error of a question that takes too long, with what would do."""
    field, named = ("sweep", question.sweep) if question.sweep else ("runs", "RUN...")
    reason = f"needs {needed}; got {got}"
    detail = (
        f"{field}: {reason}. Ask for {instead}, or compare on your machine: microcosmos "
        f"compare {named}"
    )
    error = FieldError(field=field, reason=reason, needed=needed, got=got)
    return Invalid(detail, [error], title="Too much to compare")


def document(services: Services, question: Question) -> Statistics:
    """Return the comparison for the page."""
    from microcosmos.statistics import tables

    found = tables.document(compared(services, question))
    fields = {name: found[name] for name in Statistics.model_fields}
    if caution := _left_out(question):
        fields["cautions"] = [caution, *fields["cautions"]]
    return Statistics.model_validate(fields)


def table(services: Services, question: Question, form: str) -> str:
    """Return the comparison as CSV or LaTeX, with the runs that are left out."""
    from microcosmos.statistics import tables

    found = compared(services, question)
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


def records(session: Session, question: Question, last: bool) -> list["RunRecord"]:
    """Return runs with their curves, or with the `last` generation of each, which comes after
    one with negative fitness. Raise `DomainError` for too many generations."""
    from microcosmos.statistics import RunRecord

    curves = _curves(session, question, last)
    names = (Run.id, Run.spec, Run.version, Run.device)
    rows = session.execute(select(*names).where(Run.id.in_(question.runs)))
    found = {row.id: row for row in rows}
    return [
        RunRecord(
            name=str(run.id),
            document=run.spec,
            curves=curves[run.id],
            version=run.version,
            devices=(run.device or "an unknown device",),
            state="finished",
        )
        for run in (found[run_id] for run_id in question.runs if run_id in found)
        if run.id in curves
    ]


def _curves(
    session: Session, question: Question, last: bool
) -> dict[UUID, dict[str, np.ndarray]]:
    # The database reads the JSON: whole summaries are many times as large.
    corrected = [Generation.summary[name].as_float() for name in CORRECTED]
    columns = [getattr(Generation, name) for name in COLUMNS]
    wanted = (
        select(Generation.run_id, *columns, *corrected)
        .join(Run, Run.id == Generation.run_id)
        .where(Run.id.in_(question.runs), Generation.generation <= Run.generation)
        .order_by(Generation.run_id, Generation.generation)
    )
    if last:
        wanted = _ends(wanted, question.runs)
    counted = select(func.count()).select_from(wanted.order_by(None).subquery())
    if (count := session.execute(counted).scalar_one()) > MAX_GENERATIONS:
        needed, got = f"at most {MAX_GENERATIONS:,} generations", f"{count:,} in all runs"
        instead = "fewer runs" if last else "fewer runs, or for last values alone"
        raise _too_large(question, needed, got, instead)
    rows: dict[UUID, list[Sequence[float | None]]] = {}
    for run_id, *values in session.execute(wanted):
        rows.setdefault(run_id, []).append(values)
    return {
        run_id: dict(zip((*COLUMNS, *CORRECTED), np.array(each, float).T, strict=True))
        for run_id, each in rows.items()
    }


def _ends(wanted: Select[*tuple[Any, ...]], runs: Sequence[UUID]) -> Select[*tuple[Any, ...]]:
    """Return the query for the generations on which last values depend."""
    # A caution must not depend on the measures: it is on negative fitness at any time. The
    # first such generation is enough: of a costly gait, all may be negative.
    negative = [getattr(Generation, name) < 0 for name in ("best", "mean", "qd_score")]
    first = (
        select(Generation.run_id, func.min(Generation.generation).label("generation"))
        .where(Generation.run_id.in_(runs), or_(*negative))
        .group_by(Generation.run_id)
        .subquery()
    )
    # What the first generation searched, and where elites were evaluated again.
    reevaluated = Generation.summary[CORRECTED[0]].as_float().is_not(None)
    ends = Generation.generation.in_((1, Run.generation))
    is_negative = Generation.generation == first.c.generation
    joined = wanted.outerjoin(first, first.c.run_id == Generation.run_id)
    return joined.where(or_(ends, reevaluated, is_negative))


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
    (`best>=0.5`), separated by commas. Questions that would take long are refused;
    `microcosmos compare` takes any.
    """

    def make() -> bytes:
        return document(services, question).model_dump_json().encode()

    return await _answer(request, question, JSON, make, {})


def _table_reader(form: str, media_type: str) -> Callable[..., Awaitable[Response]]:
    async def read(request: Request, question: QuestionDep, services: ServicesDep) -> Response:
        def make() -> bytes:
            return table(services, question, form).encode()

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
