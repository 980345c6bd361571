"""The health report: the state of each part, and its error."""

import httpx
import pytest
from sqlalchemy.exc import OperationalError

from microcosmos_server.maintenance import healthcheck, routes
from microcosmos_server.tables import migrations
from microcosmos_server.workers import registry


@pytest.mark.postgresql
def test_a_healthy_server_reports_all_its_parts(api, services, run_id, database):
    registry.report(services.sessions, "worker", "a device", 1, "busy", kind="gpu")
    found = api.get("health").json()
    assert (found["database"]["dialect"], found["database"]["reachable"]) == (database, True)
    assert found["database"]["revision"] == found["database"]["newest_revision"]
    assert found["disk"]["writable"] is True
    assert (found["redis"]["reachable"], found["redis"]["policy"]) == (True, "noeviction")
    assert found["queues"] == {"runs": 1, "renderings": 0, "audits": 0}
    assert found["workers"] == {"idle": 0, "busy": 1, "problem": 0}


def test_a_part_that_does_not_answer_is_reported_with_its_error(services, served, monkeypatch):
    def full(path, data):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(services.artifacts, "write", full)
    assert "No space left" in routes.disk(services).error
    monkeypatch.setattr(migrations, "newest", lambda: "9999")
    assert routes.database(services).newest_revision == "9999"
    address = served(redis_url="redis://127.0.0.1:1/0")
    found = httpx.get(f"{address}/api/v1/health", timeout=30).json()
    assert found["redis"]["reachable"] is False
    assert found["queues"] == {"runs": 0}


@pytest.mark.postgresql
@pytest.mark.parametrize("database", ["postgresql"], indirect=True)
def test_a_worker_that_cannot_report_to_its_database_is_not_to_blame(services, read_only):
    read_only(1)
    with pytest.raises(OperationalError):
        healthcheck.alive(services, "worker", "somewhere")


def test_the_location_of_the_database_has_no_password(services):
    assert "@" not in routes.database(services).location
