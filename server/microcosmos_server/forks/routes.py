"""Derive runs from a run: fork it with a patched spec, or extend it by generations."""

from collections.abc import Callable, Iterator, Mapping
from typing import Any
from uuid import UUID

from fastapi import APIRouter, Response
from pydantic import ValidationError
from sqlalchemy.orm import Session

from microcosmos.archive.report import ENDED
from microcosmos.spec import Evolution, Spec, estimate, parse
from microcosmos.spec.search import MAX_INITIAL

from ..archives import elites, measures
from ..auth.authorize import Writer
from ..core.database import clock
from ..core.errors import Conflict, DomainError, FieldError, invalid_field
from ..core.json_body import json_route
from ..creatures.initial import initial_of
from ..runs.announce import changed
from ..runs.deps import OwnRunId, find_run
from ..runs.lifecycle import NOT_IN_BIN, change, refuse
from ..runs.log import note
from ..runs.schemas import Extension, Fork, ForkStart, RunRead
from ..runs.submission import IdempotencyKey, IdempotentRequest, answer, refuse_too_large
from ..schedule.take import refuse_too_many
from ..services.services import ServicesDep
from ..specs import parsing
from ..specs.parsing import SEARCHES, SPEC_BYTES, Parse
from ..tables import FINISHED, QUEUED, Run


def spec_of(session: Session, run: Run, sent: Fork, parse: Parse) -> Spec:
    """Return the spec of the fork; raise `ValidationError` or `DomainError`."""
    document = patched(run.spec, sent.spec)
    search = document.get("search")
    if document.get("experiment") not in SEARCHES or not isinstance(search, dict):
        needed = f"one of {', '.join(SEARCHES)}"
        raise invalid_field("experiment", needed, document.get("experiment"))
    names = chosen(session, run, sent.start, sent.generation)
    document = {**document, "search": {**search, "initial": names}}
    return parse(with_nulls(document, run.spec, sent.spec, parse))


def patched(document: Any, patch: Any) -> Any:
    """Apply a merge patch (RFC 7396): null removes a member."""
    if not isinstance(patch, Mapping):
        return patch
    whole = dict(document) if isinstance(document, Mapping) else {}
    for name, value in patch.items():
        if value is None:
            whole.pop(name, None)
        else:
            whole[name] = patched(whole.get(name), value)
    return whole


def with_nulls(document: Any, before: Any, patch: Any, parse: Parse) -> Any:
    """Set fields that a patch removed to null, where the spec allows null.

    Otherwise a default would replace the removed value; a merge patch cannot say null.
    """
    for path in _removed(before, patch):
        other = patched(document, {})
        parent = other
        for name in path[:-1]:
            parent[name] = dict(parent[name])
            parent = parent[name]
        parent[path[-1]] = None
        try:
            parse(other)
        except (ValidationError, DomainError):
            continue
        document = other
    return document


def _removed(before: Any, patch: Any, path: tuple[str, ...] = ()) -> Iterator[tuple[str, ...]]:
    if not isinstance(before, Mapping) or not isinstance(patch, Mapping):
        return
    for name in before.keys() & patch.keys():
        if patch[name] is None and before[name] is not None:
            yield (*path, name)
        yield from _removed(before[name], patch[name], (*path, name))


def chosen(session: Session, run: Run, start: ForkStart, generation: int | None) -> list[str]:
    """Return the names of the initial creatures, each once."""
    as_of = elites.generation_of(run, generation)
    if start.creatures is not None:
        return sorted(set(start.creatures))
    if not measures.has_archive(run):
        needed = "`creatures`, since this run has no archive"
        raise invalid_field("from", needed, run.experiment)
    archive = session.execute(elites.as_of(run, as_of)).all()
    within = _selection(run, start)
    names = sorted({elite.creature for elite in archive if within(elite)})
    filled = {elite.cell for elite in archive}
    if start.cells is not None and (empty := sorted(set(start.cells) - filled)):
        raise invalid_field("from.cells", "cells with an elite", empty[:10])
    if not names:
        field = "from.region" if start.region is not None else "from"
        raise invalid_field(field, "at least one elite", "none")
    if len(names) > MAX_INITIAL:
        needed = f"at most {MAX_INITIAL:,} creatures; choose a `region` or some `cells`"
        raise invalid_field("from", needed, len(names))
    return names


def _selection(run: Run, start: ForkStart) -> Callable[[Any], bool]:
    if start.cells is not None:
        cells = set(start.cells)
        return lambda elite: elite.cell in cells
    if start.region is None:
        return lambda _: True
    axes = [axis.name for axis in measures.axes(run)]
    if unknown := set(start.region) - set(axes):
        name = min(unknown)
        needed = f"one of the archive's axes {', '.join(axes)}"
        raise invalid_field(f"from.region.{name}", needed, name)
    ends = [(axes.index(name), *ends) for name, ends in start.region.items()]
    return lambda elite: all(low <= elite.descriptors[i] <= high for i, low, high in ends)


def longer(run: Run, more: int) -> Spec:
    """Return the spec with more generations; raise `DomainError` if that is impossible."""
    if "generations" not in run.spec.get("search", {}):
        detail = (
            f"A run of `{run.experiment}` is complete at its end: only searches, which have "
            "`search.generations`, can be extended."
        )
        error = FieldError(field="search.generations", reason=detail, got=run.experiment)
        raise Conflict(detail, [error], title="Not extensible")
    if run.status == FINISHED and (ended := ENDED.of(run.summary)):
        (limit, generation), *_ = ended.items()
        detail = (
            f"`search.stop.{limit}` ended the run after generation {generation} and "
            "would end a longer one at the same generation. Fork the run with another "
            "`search.stop`."
        )
        raise Conflict(detail, title="More generations have no effect")
    search = {**run.spec["search"], "generations": run.generations + more}
    spec = parse({**run.spec, "search": search})
    assert isinstance(spec, Evolution)
    return spec


def extend(session: Session, run: Run, spec: Spec) -> Run:
    """Queue a run again, to continue from its last checkpoint."""
    refuse_too_many(session, run.owner, 1)
    # The second of two concurrent extensions would set a wrong total.
    unchanged = (NOT_IN_BIN, Run.status == FINISHED, Run.generations == run.generations)
    changed = change(
        session,
        run.id,
        *unchanged,
        status=QUEUED,
        spec=spec.model_dump(mode="json"),
        generations=spec.generations,
        memory_bytes=estimate(spec).memory_bytes,
        finished_at=None,
        worker=None,
        queued_at=clock(),
        attempts_without_checkpoint=0,
    )
    if changed is None:
        refuse(session, "extend", run, "finished")
    more = spec.generations - run.generations
    plural = "s" if more > 1 else ""
    text = f"Extended by {more} generation{plural} to {spec.generations}: queued again."
    note(session, changed, text)
    return changed


router = APIRouter(prefix="/runs/{run_id}", tags=["runs"], route_class=json_route(SPEC_BYTES))


@router.post("/extend", status_code=202)
def extend_run(run_id: OwnRunId, services: ServicesDep, sent: Extension) -> RunRead:
    """Add generations to a finished run; the result is the same as with all from the start."""
    with services.sessions.read() as session:
        run = find_run(session, run_id)
        if run.status != FINISHED:  # Its end may be a limit, which `longer` refuses.
            refuse(session, "extend", run, "finished")
    spec = longer(run, sent.generations)
    refuse_too_large(services, spec)
    extended = changed(services, run_id, lambda session, _: extend(session, run, spec))
    services.wake.send()
    return extended


@router.post("/fork", status_code=202, responses={200: {"model": RunRead}})
def fork_run(
    principal: Writer,
    run_id: UUID,
    services: ServicesDep,
    response: Response,
    sent: Fork,
    idempotency_key: IdempotencyKey = None,
) -> RunRead:
    """Create a run that starts from creatures of this one; a merge patch changes its spec.

    The same key with the same request gives the same run, even if the archive has changed.
    """
    body = {"fork": str(run_id), **sent.model_dump(mode="json")}

    def fork() -> tuple[Spec, dict[str, Any]]:
        with services.sessions.read() as session, parsing.parsing(services, session) as parse:
            spec = spec_of(session, find_run(session, run_id), sent, parse)
        origin = {"forked_from": run_id, "n_initial": len(initial_of(spec))}
        return spec, {"name": sent.name or None, **origin}

    request = IdempotentRequest(body, idempotency_key, principal.token)
    return answer(services, response, request, fork)
