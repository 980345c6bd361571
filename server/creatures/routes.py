"""Creatures: read one by its name, bring one."""

from typing import Annotated, Any

from fastapi import APIRouter, Depends, Query, Request
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import JSONResponse, Response

from microcosmos.archive import creature, creature_h5

from ..auth.authorize import MAY_READ, MAY_READ_SHARED, MAY_WRITE
from ..auth.capability import SharedViewDep
from ..core.uploads import limited
from ..services.deps import ServicesDep, SessionDep
from ..tables import Creature
from . import lineage
from . import storage as creatures
from .deps import CreatureDep
from .sandbox import sandbox
from .schemas import Ancestors, Children, CreatureName

FILE_BYTES = 8 << 20
H5 = "application/x-hdf5"
FOR_EVER = "public, max-age=31536000, immutable"

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


async def file_sent(request: Request) -> dict[str, Any]:
    """A creature file in either form, which its first bytes tell."""
    sent = await limited(request, FILE_BYTES)
    return await run_in_threadpool(sandbox().creature, sent)


@router.get(
    "/{sha}", responses={200: {"model": dict[str, Any]}}, dependencies=[MAY_READ_SHARED]
)
def read_creature(
    request: Request,
    row: CreatureDep,
    session: SessionDep,
    share: SharedViewDep,
    download: bool = False,
    ancestors: bool = False,
) -> Response:
    """The creature file; with `ancestors` those that are kept of them come along."""
    if share or ancestors:
        file = creatures.with_ancestors(session, row) if ancestors else creatures.document(row)
        headers = named(row) if download else {}
        headers["Cache-Control"] = "no-cache"
        return JSONResponse(share.licensed(file) if share else file, headers=headers)
    etag = f'"{row.sha256}"'
    headers = {"Cache-Control": FOR_EVER, "ETag": etag}
    if request.headers.get("if-none-match") == etag:
        return Response(status_code=304, headers=headers)
    if download:
        headers |= named(row)
    return JSONResponse(creatures.document(row), headers=headers)


def named(row: Creature) -> dict[str, str]:
    """How the file is called that somebody keeps."""
    name = f"creature-{row.sha256[:12]}.json"
    return {"Content-Disposition": f'attachment; filename="{name}"'}


@router.get(
    "/{sha}/creature.h5",
    response_class=Response,
    responses={200: {"content": {H5: {}}}},
    dependencies=[MAY_READ_SHARED],
)
def read_creature_h5(row: CreatureDep, share: SharedViewDep) -> Response:
    """The creature file as HDF5, with its body and genes as arrays."""
    name = f"creature-{row.sha256[:12]}.h5"
    headers = {
        "Cache-Control": "no-cache",
        "Content-Disposition": f'attachment; filename="{name}"',
    }
    file = creatures.document(row)
    data = creature_h5.dump(creature.parse(share.licensed(file) if share else file))
    return Response(data, headers=headers, media_type=H5)


@router.get("/{sha}/ancestors", dependencies=[MAY_READ_SHARED])
def read_ancestors(
    row: CreatureDep, session: SessionDep, depth: Annotated[int, Query(ge=1, le=32)] = 3
) -> Ancestors:
    """Parents and theirs, nearest first; who never was an elite is known by name alone."""
    return lineage.ancestors(session, row, depth)


@router.get("/{sha}/children", dependencies=[MAY_READ])
def read_children(
    row: CreatureDep,
    session: SessionDep,
    limit: Annotated[int, Query(ge=1, le=lineage.MOST)] = 50,
) -> Children:
    """Elites that came from this creature, best first, and how many there are in all."""
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
    """Keep a creature file, JSON or HDF5; its hash is verified. 200 where it is known.

    Files of its ancestors, listed in `ancestors`, are verified and kept likewise.
    """
    ancestors = file.pop("ancestors")
    with services.sessions.write.begin() as session:
        new = session.get(Creature, file["sha256"]) is None
        creatures.add_all(session, [file, *ancestors])
    response.status_code = 201 if new else 200
    response.headers["Location"] = f"/api/v1/creatures/{file['sha256']}"
    return CreatureName(creature=file["sha256"])
