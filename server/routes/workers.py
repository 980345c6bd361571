"""Workers that are alive."""

from fastapi import APIRouter

from .. import workers
from ..deps import ServicesDep, SessionDep
from ..schemas import WorkerRead

router = APIRouter(prefix="/workers", tags=["workers"])


@router.get("")
def list_workers(services: ServicesDep, session: SessionDep) -> list[WorkerRead]:
    return [
        WorkerRead(
            name=worker.name,
            device=worker.device,
            memory_bytes=worker.memory_bytes,
            status=worker.status,
            run=worker.run_id,
            heartbeat_at=worker.heartbeat_at,
        )
        for worker in workers.live(session, services.settings.lease)
    ]
