"""Move a run to the bin, and restore it."""

from fastapi import APIRouter

from ..runs.announce import changed
from ..runs.deps import OwnRunId
from ..runs.schemas import RunRead
from ..services.services import ServicesDep
from . import bin

router = APIRouter(prefix="/runs/{run_id}", tags=["runs"])


@router.delete("")
def delete_run(run_id: OwnRunId, services: ServicesDep) -> RunRead:
    """Move a run to the bin, from which it can be restored until `purge_at`."""
    keep = services.settings.bin_seconds
    return changed(services, run_id, lambda session, run: bin.put(session, run, keep))


@router.post("/restore")
def restore_run(run_id: OwnRunId, services: ServicesDep) -> RunRead:
    """Restore a run from the bin."""
    return changed(services, run_id, bin.restore, deleted=True)
