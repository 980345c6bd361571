"""Routes of the statistics of a sweep: for the page, and as tables to download."""

from collections.abc import Awaitable, Callable
from typing import Annotated
from uuid import UUID

from fastapi import APIRouter, Depends, Query, Request
from fastapi.responses import Response

from microcosmos.version import VERSION

from ..auth.authorize import MAY_READ
from ..core.answers import respond, tag_of
from ..core.api import sends
from ..core.errors import ProblemError
from ..services.services import ServicesDep
from ..tables import Sweep
from . import statistics
from .statistics import Asked
from .statistics_schemas import SweepStatistics

router = APIRouter(prefix="/sweeps/{sweep_id}", tags=["sweeps"])
JSON = "application/json"


def _asked(
    sweep_id: UUID, services: ServicesDep, measures: Annotated[str, Query(max_length=400)] = ""
) -> Asked:
    """Read the state of the runs over a connection that is closed again."""
    with services.sessions.read() as session:
        sweep = session.get(Sweep, sweep_id)
        if sweep is None:
            raise ProblemError(404, "Not found", f"No sweep has the id {sweep_id}.")
        return statistics.asked(session, sweep, measures)


AskedDep = Annotated[Asked, Depends(_asked)]


@router.get(
    "/statistics",
    responses={
        200: {"model": SweepStatistics},
        304: {"description": "Unchanged"},
        404: {},
        409: {},
    },
    dependencies=[MAY_READ],
)
async def read_statistics(
    request: Request, wanted: AskedDep, services: ServicesDep
) -> Response:
    """Compare the cases of a sweep whose runs are finished: quartiles, rank tests with Holm's
    correction, and effect sizes with bootstrap intervals.

    `measures` are curves (`qd_score`), curves after evaluations (`qd_score@6400`) or the
    evaluations to a value (`best>=0.5`), separated by commas.
    """

    def make() -> bytes:
        with services.sessions.read() as session:
            return statistics.document(session, wanted).model_dump_json().encode()

    return await _answer(request, wanted, JSON, make, {})


def _table_reader(form: str, media_type: str) -> Callable[..., Awaitable[Response]]:
    async def read(
        sweep_id: UUID, request: Request, wanted: AskedDep, services: ServicesDep
    ) -> Response:
        def make() -> bytes:
            with services.sessions.read() as session:
                return statistics.table(session, wanted, form).encode()

        name = f"statistics-{str(sweep_id)[:8]}.{form}"
        headers = {"Content-Disposition": f'attachment; filename="{name}"'}
        return await _answer(request, wanted, media_type, make, headers)

    read.__name__ = f"read_statistics_{form}"
    read.__doc__ = f"Return the same comparison as {'CSV' if form == 'csv' else 'LaTeX'}."
    return read


for form, media_type in statistics.FORMS.items():
    router.get(
        f"/statistics.{form}",
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
