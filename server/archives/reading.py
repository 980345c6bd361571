"""Read an archive, or its history, from the database."""

from collections.abc import Callable, Sequence
from typing import Any

from sqlalchemy import Select, func, select
from sqlalchemy.orm import Session

from ..core.errors import ProblemError, invalid_field
from ..runs.curves import coverage_at
from ..services.services import Services
from ..tables import Elite, Run
from . import elites, learned, reprojection
from . import measures as recorded_measures
from .schemas import ArchiveRead, HistoryRead, Measure, ReprojectionRead

HISTORY_ENTRIES = 400_000
"""About 50 MB of JSON."""


def archive(
    session: Session,
    services: Services,
    run: Run,
    generation: int | None,
    after: int | None,
    measures: str,
) -> ArchiveRead:
    """Return the elite of each cell; with `after` those alone that entered later."""
    as_of = run.generation if generation is None else min(generation, run.generation)
    own = learned.read(session, services, run)
    recorded = _recorded(session, run, own)
    names = _requested(measures, recorded)
    known = -1 if after is None else min(after, run.generation)
    kind, cells = recorded_measures.kind(run)
    return ArchiveRead(
        generation=as_of,
        kind=kind,
        cells=cells,
        axes=recorded_measures.axes(run),
        recorded=recorded,
        coverage=coverage_at(session, run.id, as_of),
        **_columns(session, lambda stored: elites.as_of(run, as_of, stored, known), names, own),
        **_emptied(session, elites.emptied(run, as_of, known)),
    )


def history(session: Session, services: Services, run: Run, measures: str) -> HistoryRead:
    """Return every elite that ever entered; raise `ProblemError` for too many."""
    own = learned.read(session, services, run)
    names = _requested(measures, _recorded(session, run, own))
    _refuse_long(session, run)

    def ordered(stored: Sequence[str]) -> Select[*tuple[Any, ...]]:
        return elites.all_time(run, stored).order_by(Elite.generation, Elite.cell)

    columns = _columns(session, ordered, names, own)
    columns |= _emptied(session, elites.losses(run))
    return HistoryRead(generation=run.generation, **columns)


def reprojected(session: Session, run: Run, axes: str, measures: str) -> ReprojectionRead:
    """Return the archive over other axes; raise `ProblemError` for impossible ones."""
    recorded = recorded_measures.recorded(session, run)
    names, more = list(filter(None, axes.split(","))), _requested(measures, recorded)
    _refuse_long(session, run)
    return reprojection.read(session, run, names, more, [one.name for one in recorded])


def _requested(measures: str, recorded: Sequence[Measure]) -> list[str]:
    names = list(dict.fromkeys(filter(None, measures.split(","))))
    existing = [measure.name for measure in recorded]
    if wrong := [name for name in names if name not in existing]:
        raise invalid_field("measures", f"names among {', '.join(existing)}", ", ".join(wrong))
    return names


def _refuse_long(session: Session, run: Run) -> None:
    counted = select(func.count()).select_from(Elite).where(elites.recorded_in(run))
    entries = session.execute(counted).scalar_one()
    if entries > HISTORY_ENTRIES:
        detail = (
            f"The history of this archive has {entries:,} entries, more than the "
            f"{HISTORY_ENTRIES:,} that one answer holds. Read single generations at "
            f"/api/v1/runs/{run.id}/archive?generation=."
        )
        raise ProblemError(422, "History too long", detail)


def _recorded(session: Session, run: Run, own: learned.LearnedMeasures | None) -> list[Measure]:
    return [*(own.described if own else []), *recorded_measures.recorded(session, run)]


def _columns(
    session: Session,
    select_with: Callable[[Sequence[str]], Select[*tuple[Any, ...]]],
    names: Sequence[str],
    own: learned.LearnedMeasures | None,
) -> dict[str, Any]:
    """Return the wire's columns; `select_with` selects elites with stored measures."""
    stored, first = learned.stored(names, own), len(elites.COLUMNS)
    found = session.execute(select_with(stored)).all()
    values = {name: [elite[first + i] for elite in found] for i, name in enumerate(stored)}
    if own and set(names) & set(own.names):
        values |= own.columns(values)
    return {
        "cell": [elite.cell for elite in found],
        "fitness": [elite.fitness for elite in found],
        "descriptors": [elite.descriptors for elite in found],
        "elite_generation": [elite.generation for elite in found],
        "creature": [elite.creature for elite in found],
        "trusted": [elite.trusted for elite in found],
        "measures": {name: values[name] for name in names},
    }


def _emptied(session: Session, found: Select[int, int]) -> dict[str, Any]:
    rows = session.execute(found).all()
    cells, generations = [row.cell for row in rows], [row.generation for row in rows]
    return {"emptied": cells, "emptied_generation": generations}
