"""Routes of renderings: pose streams, films, pictures, audits, measurements of a creature."""

from collections.abc import Callable
from hashlib import sha256

from fastapi import APIRouter, Request
from fastapi.responses import Response

from microcosmos.archive.poses import PoseStream, decode

from ..auth.authorize import MAY_READ, MAY_READ_SHARED, MAY_WRITE, ShareAccessDep
from ..core.api import Answers, sends
from ..core.errors import ProblemError
from ..core.static_files import FRESH, IMMUTABLE
from ..creatures.deps import CreatureDep
from ..services.services import ServicesDep, SessionDep
from ..tables import AUDIT, EVALUATION, LOOP, MEASUREMENT, PREVIEW, REPLAY
from . import poses, storage
from .responses import MEDIA_TYPES, ON_REQUEST, PENDING, enqueued, existing
from .schemas import Measurement, Rendering, Verdict

router = APIRouter(prefix="/creatures/{sha}", tags=["creatures"])
EXPORTS = (
    ("csv", "text/csv", PoseStream.csv),
    ("npz", "application/octet-stream", PoseStream.npz),
)
NOT_ORDERED: Answers = {204: {"description": "Nobody has ordered it"}}


def _reader(kind: str, *, on_request: bool = True) -> Callable[..., Response]:
    """Return the function of a route, which enqueues what is missing if it is `on_request`."""

    def read(
        request: Request,
        row: CreatureDep,
        share: ShareAccessDep,
        session: SessionDep,
        services: ServicesDep,
    ) -> Response:
        if found := existing(request, row, session, services, kind):
            return found
        if not on_request and (share or not storage.is_ordered(services, row.sha256, kind)):
            return Response(status_code=204)
        if share and kind not in (REPLAY, EVALUATION):
            raise ProblemError(
                404, "Not found", f"The share has no {storage.NOUNS[kind]} of it."
            )
        return enqueued(services, row.sha256, kind, anonymous=share is not None)

    read.__name__ = f"read_{kind.replace('.', '_')}"
    never = "" if on_request else ", or 204 if nobody has ordered one"
    noun = storage.NOUNS.get(kind, kind)
    read.__doc__ = f"Return the {noun}, or 202 while it is computed{never}."
    return read


for kind in ON_REQUEST:
    router.get(
        f"/{kind}",
        **sends(MEDIA_TYPES[kind], PENDING),
        dependencies=[MAY_READ if kind in (PREVIEW, LOOP) else MAY_READ_SHARED],
    )(_reader(kind))

router.get(
    "/audit", **sends(MEDIA_TYPES[AUDIT], PENDING | NOT_ORDERED), dependencies=[MAY_READ]
)(_reader(AUDIT, on_request=False))
router.get(
    "/measurement",
    responses={200: {"model": Measurement}, **PENDING, **NOT_ORDERED},
    dependencies=[MAY_READ_SHARED],
)(_reader(MEASUREMENT, on_request=False))


@router.get(
    "/poses", **sends("application/octet-stream", PENDING), dependencies=[MAY_READ_SHARED]
)
def read_poses(
    request: Request,
    row: CreatureDep,
    share: ShareAccessDep,
    session: SessionDep,
    services: ServicesDep,
) -> Response:
    """Return the pose stream; without one, that of the replay, or 202 while it is recorded."""
    data = poses.find(session, services, row)
    if data is None:
        return enqueued(services, row.sha256, REPLAY, anonymous=share is not None)
    # A share may be revoked, and a stream made from a replay gives way to a recorded one.
    lasting = row.poses is not None and share is None
    headers = {**(IMMUTABLE if lasting else FRESH), "ETag": f'"{sha256(data).hexdigest()}"'}
    if headers["ETag"] in request.headers.get("if-none-match", ""):
        return Response(status_code=304, headers=headers)
    return Response(data, headers=headers, media_type="application/octet-stream")


def _poses_exporter(
    ending: str, media_type: str, export: Callable[[PoseStream], str | bytes]
) -> Callable[..., Response]:
    def read(
        row: CreatureDep, share: ShareAccessDep, session: SessionDep, services: ServicesDep
    ) -> Response:
        data = poses.find(session, services, row)
        if data is None:
            return enqueued(services, row.sha256, REPLAY, anonymous=share is not None)
        name = f"poses-{row.sha256[:12]}.{ending}"
        headers = {**FRESH, "Content-Disposition": f'attachment; filename="{name}"'}
        return Response(export(decode(data)), headers=headers, media_type=media_type)

    read.__name__ = f"read_poses_{ending}"
    read.__doc__ = f"Return the pose stream as {ending.upper()}, or 202 like `poses`."
    return read


for ending, media_type, export in EXPORTS:
    router.get(
        f"/poses.{ending}", **sends(media_type, PENDING), dependencies=[MAY_READ_SHARED]
    )(_poses_exporter(ending, media_type, export))


@router.get("/verdict", dependencies=[MAY_READ_SHARED])
def read_verdict(row: CreatureDep) -> Verdict:
    """Return the verdict of the saved audit; reading it enqueues none."""
    return Verdict(trusted=row.trusted)


@router.post("/audit", status_code=202, dependencies=[MAY_WRITE])
def order_audit(row: CreatureDep, session: SessionDep, services: ServicesDep) -> Rendering:
    """Have the creature audited, unless it was; read `audit`."""
    if storage.find(session, row.sha256, AUDIT) is None:
        storage.enqueue(services, row.sha256, AUDIT)
    return Rendering()


@router.post("/measurement", status_code=202, dependencies=[MAY_WRITE])
def order_measurement(row: CreatureDep, services: ServicesDep) -> Rendering:
    """Have the program that measured it evaluate the creature again; read `measurement`."""
    if not row.measured:
        detail = "The creature's file contains no measurement to compare a new one with."
        raise ProblemError(422, "Never measured", detail)
    storage.enqueue_again(services, row.sha256, MEASUREMENT)
    return Rendering()
