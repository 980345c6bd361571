"""The health report: the state of each part, and its error."""

import httpx
import pytest

from server.maintenance import health_report
from server.tables import migrations
from server.workers import registry


@pytest.mark.postgresql
def test_a_healthy_server_reports_all_its_parts(api, services, run_id, database):
    registry.report(services.sessions, "worker", "a device", 1, "busy", kind="gpu")
    found = api.get("health").json()
    assert found["database"]["dialect"] == database
    assert found["database"]["reachable"] is True
    assert found["database"]["revision"] == found["database"]["newest_revision"]
    assert found["disk"]["writable"] is True
    assert 0 < found["disk"]["free_bytes"] <= found["disk"]["total_bytes"]
    assert found["disk"]["write_seconds"] > 0
    assert found["redis"]["reachable"] is True
    assert found["redis"]["version"]
    assert found["redis"]["policy"] == "noeviction"
    assert found["queues"] == {"runs": 1, "renderings": 0, "audits": 0}
    assert found["workers"] == {"idle": 0, "busy": 1, "problem": 0}


def test_a_part_that_does_not_answer_is_reported_with_its_error(services, serve, monkeypatch):
    def full(path, data):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(services.artifacts, "write", full)
    assert "No space left" in health_report.disk(services).error
    monkeypatch.setattr(migrations, "newest", lambda: "9999")
    assert health_report.database(services).newest_revision == "9999"
    with serve(redis_url="redis://127.0.0.1:1/0") as address:
        found = httpx.get(f"{address}/api/v1/health", timeout=30).json()
    assert found["redis"]["reachable"] is False
    assert found["queues"] == {"runs": 0}


def test_the_location_of_the_database_has_no_password(services):
    assert "@" not in health_report.database(services).location
