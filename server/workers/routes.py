"""Workers that are alive."""

from fastapi import APIRouter

from ..auth.authorize import MAY_READ
from ..services.deps import ServicesDep, SessionDep
from ..tables import Run, Worker
from . import registry
from .brief import brief
from .schemas import PluginRead, WorkerRead

router = APIRouter(prefix="/workers", tags=["workers"])


@router.get("", dependencies=[MAY_READ])
def list_workers(services: ServicesDep, session: SessionDep) -> list[WorkerRead]:
    """By name, each with how busy its device is and the run that it carries out."""
    alive = registry.live(session, services.settings.lease)
    runs = registry.at_work(session, alive)
    return [_read(worker, runs.get(worker.name)) for worker in alive]


def _read(worker: Worker, run: Run | None) -> WorkerRead:
    columns = {column.key: getattr(worker, column.key) for column in Worker.__table__.columns}
    told = columns.pop("run_id")
    names = list(PluginRead.model_fields)
    columns["plugins"] = [{name: one[name] for name in names} for one in worker.plugins]
    return WorkerRead(
        **columns, run=run.id if run else told, current_run=brief(run) if run else None
    )
