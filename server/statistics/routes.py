"""Routes of the statistics of runs: for the page, and as tables to download."""

from collections.abc import Awaitable, Callable
from typing import Annotated
from uuid import UUID

from fastapi import APIRouter, Depends, Query, Request
from fastapi.responses import Response

from microcosmos.version import VERSION

from ..auth.authorize import MAY_READ
from ..core.answers import respond, tag_of
from ..core.api import sends
from ..core.errors import invalid_field
from ..services.services import ServicesDep
from . import comparing
from .comparing import Asked
from .schemas import Statistics

router = APIRouter(prefix="/statistics", tags=["runs"])
JSON = "application/json"
MAX_RUNS = 100
UUID_PATTERN = "[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}"
RUNS = rf"^{UUID_PATTERN}(,{UUID_PATTERN}){{0,{MAX_RUNS - 1}}}$"


def _asked(
    services: ServicesDep,
    runs: Annotated[str | None, Query(pattern=RUNS)] = None,
    sweep: UUID | None = None,
    measures: Annotated[str, Query(max_length=400)] = "",
) -> Asked:
    """Read the state of the runs over a connection that is closed again."""
    if (runs is None) == (sweep is None):
        raise invalid_field("runs", "either `runs` or a `sweep`", runs)
    with services.sessions.read() as session:
        if sweep is not None:
            return comparing.of_sweep(session, sweep, measures)
        return comparing.of_runs(
            session, [UUID(one) for one in (runs or "").split(",")], measures
        )


AskedDep = Annotated[Asked, Depends(_asked)]


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
    request: Request, wanted: AskedDep, services: ServicesDep
) -> Response:
    """Compare finished runs, grouped by what differs in their specs beside the seed: quartiles,
    rank tests with Holm's correction, and effect sizes with bootstrap intervals.

    `runs` are ids separated by commas; or give the id of a `sweep`. `measures` are curves
    (`qd_score`), curves after evaluations (`qd_score@6400`) or the evaluations to a value
    (`best>=0.5`), separated by commas.
    """

    def make() -> bytes:
        with services.sessions.read() as session:
            return comparing.document(session, wanted).model_dump_json().encode()

    return await _answer(request, wanted, JSON, make, {})


def _table_reader(form: str, media_type: str) -> Callable[..., Awaitable[Response]]:
    async def read(request: Request, wanted: AskedDep, services: ServicesDep) -> Response:
        def make() -> bytes:
            with services.sessions.read() as session:
                return comparing.table(session, wanted, form).encode()

        headers = {"Content-Disposition": f'attachment; filename="statistics.{form}"'}
        return await _answer(request, wanted, media_type, make, headers)

    read.__name__ = f"read_statistics_{form}"
    read.__doc__ = f"Return the same comparison as {'CSV' if form == 'csv' else 'LaTeX'}."
    return read


for form, media_type in comparing.FORMS.items():
    router.get(
        f".{form}",
        **sends(media_type, {404: {}, 409: {}}),
        dependencies=[MAY_READ],
    )(_table_reader(form, media_type))


async def _answer(
    request: Request,
    wanted: Asked,
    media_type: str,
    make: Callable[[], bytes],
    headers: dict[str, str],
) -> Response:
    """Make the answer once for each state of the runs, in a thread."""
    tag = tag_of(VERSION, request.scope["route"].path, wanted)
    kept = request.app.state.archive_answers
    return await respond(request, kept, tag, make, media_type, headers)
