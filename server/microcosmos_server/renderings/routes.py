"""Routes of renderings: pose streams, films, audits and measurements; first creatures."""

import json
import struct
from collections.abc import Callable
from functools import partial
from typing import Annotated

import numpy as np
from fastapi import APIRouter, Query, Request
from fastapi.responses import JSONResponse, Response
from sqlalchemy import select

from microcosmos import naming
from microcosmos.archive import columns, poses
from microcosmos.archive.poses import PoseStream, decode
from microcosmos.bodies import extent, from_edges
from microcosmos.spec import Evolution
from microcosmos.viz import motion
from microcosmos.viz.replay_file import read_motion

from ..auth.authorize import MAY_READ, MAY_READ_SHARED, MAY_WRITE, ShareAccessDep
from ..core.answers import revalidated
from ..core.api import Answers, named, sends
from ..core.errors import Invalid, NotFound
from ..core.json_body import json_route
from ..creatures.deps import CreatureDep
from ..queue.jobs import FIRST, KINDS, ON_REQUEST
from ..services.services import Services, ServicesDep
from ..specs.parsing import SPEC_BYTES, SpecDep
from ..storage.artifacts import Artifacts
from ..tables import AUDIT, EVALUATION, LOOP, MEASUREMENT, PREVIEW, REPLAY, Artifact, Creature
from . import storage
from .responses import (
    PENDING,
    Measurement,
    Rendering,
    Verdict,
    enqueued,
    existing,
)

LENGTH = struct.Struct("<I")


def find(services: Services, sha: str) -> bytes | None:
    """Return the pose stream; None without a stored one and without a replay."""
    with services.sessions.read() as session:
        stored = session.scalars(select(Creature.poses).where(Creature.sha256 == sha)).one()
    if stored is not None:
        return stored
    return storage.read(
        services, sha, REPLAY, partial(from_replay, services.artifacts, creature=sha)
    )


def from_replay(artifacts: Artifacts, replay: Artifact, creature: str) -> bytes:
    """Return a pose stream with every k-th frame of the whole replay; it spans no strokes."""
    (length,) = LENGTH.unpack(_part(artifacts, replay, 0, LENGTH.size))
    start = LENGTH.size + length
    header = json.loads(_part(artifacts, replay, LENGTH.size, start))
    shape = header["frames"], header["nodes"], 2
    data = _part(artifacts, replay, start, start + 4 * np.prod(shape, dtype=int))
    whole = np.frombuffer(data, "<f4").reshape(shape)
    stride = max(1, -(-(len(whole) - 1) // poses.FRAMES))
    kept = whole[::stride]
    positions, middles, scale = poses.quantised(kept[1:] if len(kept) > 1 else kept)
    edges = np.array(header["edges"], int).reshape(-1, 2)
    return poses.PoseStream(
        positions=positions,
        path=kept.mean(1),
        middles=middles,
        scale=scale,
        edges=edges,
        start=0,
        stop=header["every"] * stride * (len(kept) - 1),
        strokes=0,
        steps=header["steps"],
        size=tuple(header["size"]),
        length=extent(from_edges(whole[0], edges)),
        creature=creature,
    ).encode()


def _part(artifacts: Artifacts, replay: Artifact, start: int, stop: int) -> bytes:
    return artifacts.read(replay.path, start, stop)


creatures = APIRouter(prefix="/creatures/{sha}", tags=["creatures"])
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
        services: ServicesDep,
    ) -> Response:
        if found := existing(request, row.sha256, services, kind):
            return found
        if not on_request and (share or not storage.is_ordered(services, row.sha256, kind)):
            return Response(status_code=204)
        if share and kind not in (REPLAY, EVALUATION):
            raise NotFound(f"The share has no {KINDS[kind].noun} of it.")
        return enqueued(services, row.sha256, kind, anonymous=share is not None)

    return read


for kind in ON_REQUEST:
    creatures.get(
        f"/{kind}",
        **sends(KINDS[kind].media_type, PENDING),
        name=f"read_{kind.replace('.', '_')}",
        description=f"Return the {KINDS[kind].noun}, or 202 while it is computed.",
        dependencies=[MAY_READ if kind in (PREVIEW, LOOP) else MAY_READ_SHARED],
    )(_reader(kind))

creatures.get(
    "/audit",
    **sends(KINDS[AUDIT].media_type, PENDING | NOT_ORDERED),
    name="read_audit",
    description="Return the audit, or 202 while it is computed, or 204 if nobody has ordered "
    "one.",
    dependencies=[MAY_READ],
)(_reader(AUDIT, on_request=False))
creatures.get(
    "/measurement",
    responses={200: {"model": Measurement}, **PENDING, **NOT_ORDERED},
    name="read_measurement",
    description="Return the measurement, or 202 while it is computed, or 204 if nobody has "
    "ordered one.",
    dependencies=[MAY_READ_SHARED],
)(_reader(MEASUREMENT, on_request=False))


@creatures.get(
    "/poses", **sends("application/octet-stream", PENDING), dependencies=[MAY_READ_SHARED]
)
def read_poses(
    request: Request, row: CreatureDep, share: ShareAccessDep, services: ServicesDep
) -> Response:
    """Return the pose stream; without one, that of the replay, or 202 while it is recorded."""
    data = find(services, row.sha256)
    if data is None:
        return enqueued(services, row.sha256, REPLAY, anonymous=share is not None)
    return revalidated(request, Response(data, media_type="application/octet-stream"))


def _poses_exporter(
    ending: str, media_type: str, export: Callable[[PoseStream], str | bytes]
) -> Callable[..., Response]:
    def read(row: CreatureDep, share: ShareAccessDep, services: ServicesDep) -> Response:
        data = find(services, row.sha256)
        if data is None:
            return enqueued(services, row.sha256, REPLAY, anonymous=share is not None)
        headers = named(f"poses-{row.sha256[:12]}.{ending}")
        return Response(export(decode(data)), headers=headers, media_type=media_type)

    return read


for ending, media_type, export in EXPORTS:
    creatures.get(
        f"/poses.{ending}",
        **sends(media_type, PENDING),
        name=f"read_poses_{ending}",
        description=f"Return the pose stream as {ending.upper()}, or 202 like `poses`.",
        dependencies=[MAY_READ_SHARED],
    )(_poses_exporter(ending, media_type, export))


@creatures.get(
    "/motion", **sends("application/octet-stream", PENDING), dependencies=[MAY_READ_SHARED]
)
def read_small_motion(
    row: CreatureDep, share: ShareAccessDep, services: ServicesDep
) -> Response:
    """Return the replay made small, for a page without a server, or 202 like `replay`."""

    def small(replay: Artifact) -> bytes:
        return motion.encode(read_motion(partial(services.artifacts.read, replay.path)))

    data = storage.read(services, row.sha256, REPLAY, small)
    if data is None:
        return enqueued(services, row.sha256, REPLAY, anonymous=share is not None)
    return Response(data, media_type="application/octet-stream")


@creatures.get("/verdict", dependencies=[MAY_READ_SHARED])
def read_verdict(row: CreatureDep) -> Verdict:
    """Return the verdict of the saved audit; reading it enqueues none."""
    return Verdict(trusted=row.trusted)


@creatures.post("/audit", status_code=202, dependencies=[MAY_WRITE])
def order_audit(row: CreatureDep, services: ServicesDep) -> Rendering:
    """Have the creature audited, unless it was; read `audit`."""
    if storage.existing(services, row.sha256, AUDIT) is None:
        storage.enqueue(services, row.sha256, AUDIT)
    return Rendering()


@creatures.post("/measurement", status_code=202, dependencies=[MAY_WRITE])
def order_measurement(row: CreatureDep, services: ServicesDep) -> Rendering:
    """Have the program that measured it evaluate the creature again; read `measurement`."""
    if not row.measured:
        detail = "The creature's file contains no measurement to compare a new one with."
        raise Invalid(detail, title="Never measured")
    storage.enqueue_again(services, row.sha256, MEASUREMENT)
    return Rendering()


runs = APIRouter(tags=["runs"], route_class=json_route(SPEC_BYTES))


@runs.post("/first-creature", **sends(columns.MEDIA_TYPE, PENDING), dependencies=[MAY_WRITE])
def read_first_creature(
    spec: SpecDep, services: ServicesDep, number: Annotated[int, Query(ge=0, lt=1 << 31)] = 0
) -> Response:
    """Return the inputs of the evaluation of a creature of a run's first generation.

    202 while a renderer makes them. `number` counts within the generation, again and again.
    The answer is kept for ten minutes; no run is queued and no creature is stored.
    """
    if not isinstance(spec, Evolution) or spec.search.initial:
        detail = "Only a search that starts from random creatures has such a first generation."
        raise Invalid(detail, title="No random creatures")
    document = spec.model_dump(mode="json")
    number %= spec.search.batch
    name = naming.name({"spec": document, "number": number})
    if (inputs := services.jobs.first(name)) is not None:
        return Response(inputs, media_type=columns.MEDIA_TYPE)
    job = services.jobs.find(services.jobs.rendering_id(name, FIRST))
    if not storage.is_underway(job, "first creature"):
        services.jobs.order_first(name, document, number)
    return JSONResponse(Rendering().model_dump(), 202, {"Retry-After": "1"})


router = APIRouter()
for group in (creatures, runs):
    router.include_router(group)
