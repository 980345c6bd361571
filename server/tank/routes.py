"""Routes of the tank: its creatures, and the pose streams of many creatures at once."""

from typing import Annotated, NamedTuple

from fastapi import APIRouter, Depends, Query, Request
from fastapi.responses import Response
from sqlalchemy import select

from microcosmos.archive import poses
from microcosmos.version import VERSION

from ..auth.authorize import MAY_READ
from ..core.answers import respond, tag_of
from ..core.api import sends
from ..services.services import ServicesDep
from ..tables import Creature, InstallationState, Run
from ..workers.registry import run_brief
from .choosing import choose, latest_runs
from .schemas import Tank

router = APIRouter(prefix="/tank", tags=["creatures"])
JSON = "application/json"
MAX_CREATURES = 100
DIGESTS = rf"^[0-9a-f]{{64}}(,[0-9a-f]{{64}}){{0,{MAX_CREATURES - 1}}}$"


class Latest(NamedTuple):
    """The runs of the tank, and with the verdicts all on which it depends."""

    runs: list[Run]
    verdicts: int


def _latest(services: ServicesDep) -> Latest:
    with services.sessions.read() as session:
        verdicts = session.scalars(select(InstallationState.verdicts)).one()
        return Latest(latest_runs(session), verdicts)


@router.get("", response_model=Tank, dependencies=[MAY_READ])
async def read_tank(
    request: Request,
    services: ServicesDep,
    latest: Annotated[Latest, Depends(_latest)],
    limit: Annotated[int, Query(ge=1, le=MAX_CREATURES)] = 60,
) -> Response:
    """Return the best and the most different creatures of the latest runs."""
    briefs = [run_brief(run) for run in latest.runs]

    def make() -> bytes:
        with services.sessions.read() as session:
            swimmers = choose(session, latest.runs, limit)
        return Tank(swimmers=swimmers, runs=briefs).model_dump_json().encode()

    rewinds = [run.rewinds for run in latest.runs]
    tag = tag_of(VERSION, limit, briefs, rewinds, latest.verdicts)
    return await respond(request, request.app.state.archive_answers, tag, make, JSON, {})


@router.get("/poses", **sends("application/octet-stream"), dependencies=[MAY_READ])
def read_tank_poses(
    services: ServicesDep, creatures: Annotated[str, Query(pattern=DIGESTS)]
) -> Response:
    """Return the pose streams of creatures, whose names are separated by commas.

    The length of each stream precedes it, as a little-endian uint32. Creatures without a
    stream are left out.
    """
    stored = select(Creature.poses).where(Creature.sha256.in_(creatures.split(",")))
    with services.sessions.read() as session:
        found = session.scalars(stored.order_by(Creature.sha256)).all()
    return Response(poses.batch(found), media_type="application/octet-stream")
