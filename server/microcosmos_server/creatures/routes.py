"""Routes of creatures: read, import, relatives, and the network in several forms."""

import json
from collections.abc import Awaitable, Callable
from functools import partial
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Query, Request
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import JSONResponse, Response
from pydantic import TypeAdapter

from microcosmos.archive import creature, creature_h5
from microcosmos.quantities.files import Stroke
from microcosmos.spec.creature import PlanDrawing, plan_drawing
from microcosmos.version import VERSION
from microcosmos.viz.networks import NetworkPositions

from ..auth.authorize import MAY_READ, MAY_READ_SHARED, MAY_WRITE, ShareAccessDep
from ..core.answers import respond, revalidated, tag_of
from ..core.api import Answers, named, sends
from ..core.errors import NotFound
from ..core.json_body import read_body
from ..core.schemas import Wire
from ..services.services import ServicesDep, SessionDep
from ..tables import Creature
from . import lineage, networks
from . import storage as creatures
from .deps import CreatureDep, IdentityDep, MeasuredDep, Sha
from .lineage import Ancestors, Children
from .sandbox import sandbox

FILE_BYTES = 8 << 20
H5 = "application/x-hdf5"

router = APIRouter(prefix="/creatures", tags=["creatures"])
body: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "content": {
            "application/json": {"schema": {"type": "object"}},
            H5: {"schema": {"type": "string", "format": "binary"}},
        },
    }
}


class CreatureName(Wire):
    creature: str


async def file_sent(request: Request) -> dict[str, Any]:
    """Return the creature file of a request; its first bytes tell JSON from HDF5."""
    sent = await read_body(request, FILE_BYTES)
    return await run_in_threadpool(sandbox().creature, sent)


@router.get(
    "/{sha}", responses={200: {"model": dict[str, Any]}}, dependencies=[MAY_READ_SHARED]
)
def read_creature(
    request: Request,
    row: CreatureDep,
    session: SessionDep,
    share: ShareAccessDep,
    download: bool = False,
    ancestors: bool = False,
) -> Response:
    """Return the creature file; with `ancestors` also the files of its ancestors."""
    headers = attachment(row, "json") if download else {}
    file = creatures.with_ancestors(session, row) if ancestors else creatures.document(row)
    answer = JSONResponse(share.licensed(file) if share else file, headers=headers)
    # The name is a hash of the identity alone: a creature that was deleted and imported again
    # may have another licence.
    return revalidated(request, answer)


def attachment(row: Creature, ending: str) -> dict[str, str]:
    return named(f"creature-{row.sha256[:12]}.{ending}")


@router.get("/{sha}/creature.h5", **sends(H5), dependencies=[MAY_READ_SHARED])
def read_creature_h5(row: CreatureDep, share: ShareAccessDep) -> Response:
    """Return the creature file as HDF5, with its body and genes as arrays."""
    file = creatures.document(row)
    data = creature_h5.dump(creature.parse(share.licensed(file) if share else file))
    return Response(data, headers=attachment(row, "h5"), media_type=H5)


@router.get("/{sha}/ancestors", dependencies=[MAY_READ_SHARED])
def read_ancestors(
    row: CreatureDep, session: SessionDep, depth: Annotated[int, Query(ge=1, le=32)] = 3
) -> Ancestors:
    """Return parents and theirs, nearest first. Only elites have more than a name."""
    return lineage.ancestors(session, row, depth)


@router.get("/{sha}/children", dependencies=[MAY_READ])
def read_children(
    row: CreatureDep,
    session: SessionDep,
    limit: Annotated[int, Query(ge=1, le=lineage.MAX_RELATIVES)] = 50,
) -> Children:
    """Return elites with this creature as a parent, best first, and their number."""
    return lineage.children(session, row, limit)


@router.post(
    "",
    status_code=201,
    responses={200: {"model": CreatureName}},
    openapi_extra=body,
    dependencies=[MAY_WRITE],
)
def import_creature(
    file: Annotated[dict[str, Any], Depends(file_sent)],
    services: ServicesDep,
    response: Response,
) -> CreatureName:
    """Import a creature file, JSON or HDF5, after verifying its hash. 200 if it is known.

    The files of its ancestors, listed in `ancestors`, are verified and imported too.
    """
    ancestors = file.pop("ancestors")
    with services.sessions.write.begin() as session:
        new = session.get(Creature, file["sha256"]) is None
        creatures.import_files(session, file, *ancestors)
    response.status_code = 201 if new else 200
    response.headers["Location"] = f"/api/v1/creatures/{file['sha256']}"
    return CreatureName(creature=file["sha256"])


@router.get(
    "/{sha}/plan.json",
    responses={200: {"model": PlanDrawing}, 404: {}},
    dependencies=[MAY_READ_SHARED],
)
def read_plan(request: Request, identity: IdentityDep) -> Response:
    """Return the body plan: nodes at rest, edges, and the genes of every segment."""
    drawn = JSONResponse(TypeAdapter(PlanDrawing).dump_python(drawing(identity), mode="json"))
    return revalidated(request, drawn)


@router.get(
    "/{sha}/stroke.json",
    responses={200: {"model": Stroke | None}},
    dependencies=[MAY_READ_SHARED],
)
async def read_stroke(request: Request, file: MeasuredDep) -> Response:
    """Return the reach of the body in cells, the steps of a stroke, and the sperm number.

    A creature that was measured has the steps that its own strokes took: a body at its limit of
    speed slows its clock. Null for a creature without a stroke, or too few of them to measure.
    """
    tag = tag_of(VERSION, file, networks.STROKE)
    make = partial(sandbox().stroke, file)
    return await respond(request, tag, make, "application/json", {})


def _network_reader(form: str, media_type: str) -> Callable[..., Awaitable[Response]]:
    async def read(request: Request, sha: Sha, identity: IdentityDep) -> Response:
        headers = {
            **named(f"network-{sha[:12]}.{form}", "inline"),
            # A browser that opens an SVG by itself must run nothing in it.
            "Content-Security-Policy": "default-src 'none'; style-src 'unsafe-inline'",
        }
        tag = tag_of(VERSION, sha, form)
        make = partial(sandbox().network, identity, form)
        return await respond(request, tag, make, media_type, headers)

    return read


for form, (media_type, description, _) in networks.FORMS.items():
    json_model: Answers = {200: {"model": NetworkPositions}} if form == "json" else {}
    router.get(
        f"/{{sha}}/network.{form}",
        **sends(media_type, {404: {}, **json_model}),
        name=f"read_network_{form}",
        description=f"Return the network as {description}.",
        dependencies=[MAY_READ_SHARED],
    )(_network_reader(form, media_type))


def drawing(identity: bytes) -> PlanDrawing:
    """Grow the body of a creature; raise `DomainError` where its genes are no plan."""
    creature = json.loads(identity)
    try:
        return plan_drawing(creature)
    except ValueError as error:
        raise NotFound(f"The creature has no body plan: {error}.", title="No plan") from error
