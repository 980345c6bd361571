"""Finishing, deleting and purging runs, and counting rows and files."""

from pathlib import Path

from sqlalchemy import func, select, update

from microcosmos.spec import parse
from microcosmos_server.attempts.claim import claim
from microcosmos_server.maintenance.reconcile import reconcile
from microcosmos_server.runs.submission import IdempotentRequest, submit
from microcosmos_server.storage.mark import MARK
from microcosmos_server.tables import Base, DeviceUse, Idempotency, Notification, Run, Total

LEFT = [table.__tablename__ for table in (DeviceUse, Total, Idempotency, Notification)]


def row_counts(services):
    """Count the rows of tables, but of those that a run leaves, and notices, which go soon."""
    with services.sessions.read() as session:
        return {
            table.name: session.scalar(select(func.count()).select_from(table))
            for table in Base.metadata.sorted_tables
            if table.name not in LEFT
        }


def files(services):
    root = Path(services.settings.artifacts)
    found = {str(path.relative_to(root)) for path in root.rglob("*") if path.is_file()}
    return sorted(found - {MARK})


def finish(services, run_id, *reports, files=True):
    attempt = claim(services, run_id, "worker")
    for report in reports:
        attempt.record(report, 1.0)
        if files:
            attempt.save(report.generation, b"%d %s" % (report.generation, run_id.bytes))
    attempt.finish()


def submit_another(services, spec, seed, key=None):
    seeded = {**spec, "seed": seed}
    return submit(services, parse(seeded), IdempotentRequest(seeded, key))[0].id


def let_time_pass(services, run_id):
    """Let a deleted run's day in the bin pass."""
    with services.sessions.write.begin() as session:
        over = update(Run).where(Run.id == run_id)
        session.execute(over.values(purge_at=Run.deleted_at))


def delete_for_good(api, services, run_id):
    assert api.delete(f"runs/{run_id}").status_code == 200
    let_time_pass(services, run_id)
    reconcile(services)
    assert api.get(f"runs/{run_id}").status_code == 404
