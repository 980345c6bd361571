"""The route of workers."""

from fastapi import APIRouter

from ..auth.authorize import MAY_READ
from ..services.services import ServicesDep, SessionDep
from ..tables import Run, Worker
from .registry import live, run_brief, running
from .schemas import PluginRead, WorkerRead

router = APIRouter(prefix="/workers", tags=["workers"])


@router.get("", dependencies=[MAY_READ])
def list_workers(services: ServicesDep, session: SessionDep) -> list[WorkerRead]:
    """Return the live workers by name, with their load and their runs."""
    alive = live(session, services.settings.lease)
    runs = running(session, alive)
    return [_read(worker, runs.get(worker.name)) for worker in alive]


def _read(worker: Worker, run: Run | None) -> WorkerRead:
    columns = {column.key: getattr(worker, column.key) for column in Worker.__table__.columns}
    reported = columns.pop("run_id")
    names = list(PluginRead.model_fields)
    columns["plugins"] = [{name: one[name] for name in names} for one in worker.plugins]
    return WorkerRead(
        **columns,
        run=run.id if run else reported,
        current_run=run_brief(run) if run else None,
    )
