"""Routes that extend and fork runs."""

from typing import Any
from uuid import UUID

from fastapi import APIRouter, Response

from microcosmos.spec import Spec

from ..auth.authorize import Writer
from ..core.json_body import json_route
from ..creatures.initial import initial_of
from ..runs.announce import changed
from ..runs.deps import OwnRunId, find_run
from ..runs.schemas import Extension, Fork, RunRead
from ..runs.submission import (
    IdempotencyKey,
    IdempotentRequest,
    answer,
    refuse_too_large,
)
from ..services.services import ServicesDep
from ..specs import parsing
from ..specs.deps import SPEC_BYTES
from . import extending, forking

router = APIRouter(prefix="/runs/{run_id}", tags=["runs"], route_class=json_route(SPEC_BYTES))


@router.post("/extend", status_code=202)
def extend_run(run_id: OwnRunId, services: ServicesDep, sent: Extension) -> RunRead:
    """Add generations to a finished run; the result is the same as with all from the start."""
    with services.sessions.read() as session:
        run = find_run(session, run_id)
    spec = extending.longer(run, sent.generations)
    refuse_too_large(services, spec)
    longer = changed(services, run_id, lambda session, _: extending.extend(session, run, spec))
    services.wake.send()
    return longer


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
        with services.sessions.read() as session, parsing.parsing(services) as parse:
            spec = forking.spec_of(session, find_run(session, run_id), sent, parse)
        origin = {"forked_from": run_id, "n_initial": len(initial_of(spec))}
        return spec, {"name": sent.name or None, **origin}

    request = IdempotentRequest(body, idempotency_key, principal.token)
    return answer(services, response, request, fork)
