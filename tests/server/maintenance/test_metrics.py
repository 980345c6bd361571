"""Metrics for Prometheus."""

import re

import httpx
import pytest
from sqlalchemy.exc import OperationalError

from microcosmos_server.attempts.leases import end_job
from microcosmos_server.core.database import ago
from microcosmos_server.maintenance import metrics
from microcosmos_server.tables import Artifact, InstallationState, Run
from microcosmos_server.workers import registry

SAMPLE = re.compile(r'^(\w+)(?:\{((?:\w+="(?:[^"\\]|\\.)*",?)*)\})? (\S+)$')


@pytest.fixture
def address(serve):
    """A server whose requests nobody has counted yet."""
    with serve() as address:
        yield address


@pytest.fixture
def scrape(address):
    def read():
        answer = httpx.get(f"{address}/metrics", verify=False)
        assert answer.headers["content-type"].startswith("text/plain; version=0.0.4")
        assert answer.text.endswith("\n")
        found = {}
        for line in answer.text.splitlines():
            if line.startswith("#"):
                continue
            name, labels, value = SAMPLE.match(line).groups()
            found[name.removeprefix("microcosmos_"), labels or ""] = float(value)
        return found

    return read


def test_runs_queues_and_workers_are_counted(services, run_id, scrape, record):
    before = scrape()
    assert before["runs", 'status="queued"'] == 1
    assert before["queue_length", 'queue="renderings"'] == 0
    assert before["evaluations_total", ""] == 0
    assert ("generation_seconds", "") not in before
    record(4, {5: 1.0}, seconds=10.0)
    registry.report(services.sessions, "worker", "a device", 1, "busy", run_id, kind="gpu")
    after = scrape()
    assert (after["runs", 'status="queued"'], after["runs", 'status="running"']) == (0, 1)
    assert after["evaluations_total", ""] == 16 * 4
    assert after["infeasible_total", ""] == 4
    assert after["generations_total", ""] == 1, "one report"
    assert after["computing_seconds_total", ""] == 10
    assert after["generation_seconds", ""] == 2.5
    assert after["workers", 'kind="gpu",status="busy"'] == 1
    assert after["workers", 'kind="cpu",status="idle"'] == 0
    assert after["redis_up", ""] == 1


def test_requests_are_counted_by_route_and_not_by_address(scrape, api, run_id):
    for _ in range(2):
        assert api.get(f"runs/{run_id}").status_code == 200
    assert api.get("runs/not-a-run").status_code == 422
    assert api.get("nothing/there").status_code == 404
    found = scrape()
    one = 'method="GET",route="/api/v1/runs/{run_id}",status='
    assert found["requests_total", f'{one}"200"'] == 2
    assert found["requests_total", f'{one}"422"'] == 1
    routes = [labels for name, labels in found if name == "requests_total"]
    assert not any("nothing" in labels or str(run_id) in labels for labels in routes)
    buckets = [value for (name, _), value in found.items() if name == "request_seconds_bucket"]
    assert buckets == sorted(buckets)
    assert buckets[-1] == found["request_seconds_count", ""] >= 4
    assert found["request_seconds_sum", ""] > 0


def test_no_path_makes_labels_without_limit(scrape, address):
    def labels():
        return {labels for name, labels in scrape() if name == "requests_total"}

    with httpx.Client(base_url=address, verify=False, timeout=20) as client:
        for name in ("abcdefgh", "ijklmnop", "qrstuvwx"):
            for path in (
                f"s/{name}Y/s/{name}",
                f"api/v1/{name}",
                f"{name}/s/{name}",
                f"s/{name}",
            ):
                client.get(path)
    found = [one for one in labels() if "/s/" in one or "rest" in one or "page" in one]
    assert len(found) <= 4
    assert not any("abc" in one or "ijk" in one for one in found)


def test_metrics_without_redis_show_the_rest(run_id, served):
    address = served(redis_url="redis://127.0.0.1:1/0")
    lines = httpx.get(f"{address}/metrics", verify=False, timeout=30).text.splitlines()
    assert "microcosmos_redis_up 0.0" in lines
    assert 'microcosmos_runs{status="queued"} 1.0' in lines
    assert not any(line.startswith("microcosmos_queue_length{") for line in lines)


def test_the_age_of_checkpoints_is_that_of_running_runs(
    services, run_id, attempt, record, scrape, update_rows
):
    key = ("run_checkpoint_age_seconds", f'run="{run_id}"')
    with services.sessions.read() as session:
        then = ago(session, 3600)
    update_rows(Run, started_at=then)
    assert scrape()[key] == pytest.approx(3600, abs=60), "there is none yet"
    record(1, {5: 1.0})
    attempt.save(1, b"data")
    assert scrape()[key] < 60
    update_rows(Artifact, created_at=then)
    assert scrape()[key] == pytest.approx(3600, abs=60)
    attempt.finish()
    assert key not in scrape()


@pytest.mark.parametrize("running", [False, True])
def test_a_run_that_a_person_pauses_needs_nobody(
    api, services, run_id, claim_run, scrape, row, running
):
    run = f"runs/{run_id}"
    claim_run().pause_until_resumed("It needs the plug-in mine.sway")
    assert scrape()["runs_need_person", ""] == 1
    assert api.post(f"{run}/resume").json()["warning"] is None
    if running:
        attempt = claim_run()
        attempt.warn("The disk is almost full.")
        api.post(f"{run}/pause")
        attempt.warn("The disk is almost full.")
        attempt.pause()
    else:
        claim_run().warn("The disk is almost full.")
        end_job(services, run_id, "worker")
        api.post(f"{run}/pause")
    assert (row().status, row().warning) == ("paused", None)
    assert scrape()["runs_need_person", ""] == 0


@pytest.mark.long
@pytest.mark.postgresql
@pytest.mark.parametrize(
    ("columns", "missing"),
    [
        ({"labels": []}, None),
        ({"labels": ["a100"]}, "labels"),
        ({"memory_bytes": 1 << 40}, "memory"),
        ({"plugin_versions": ["ab"]}, "plugins"),
        ({"device": "another kind", "checkpoint_generation": 3}, "device"),
        ({"device": "another kind", "checkpoint_generation": 0}, None),
        ({"device": "another", "checkpoint_generation": 3, "device_patience": 0.0}, None),
        ({"device": "another", "checkpoint_generation": 3, "device_patience": 9e6}, "device"),
    ],
)
def test_runs_that_no_worker_fits_are_counted_by_what_is_missing(
    services, run_id, scrape, update_rows, columns, missing
):
    assert scrape()["runs_unfit", 'missing="worker"'] == 1
    registry.report(services.sessions, "worker-1", "a device", 1 << 30, "idle")
    update_rows(Run, **columns)
    found = scrape()
    for name in ("worker", "plugins", "labels", "memory", "device"):
        assert found["runs_unfit", f'missing="{name}"'] == (name == missing), name


def test_workers_with_a_problem_and_their_gpus_are_shown_by_host(services, scrape):
    gpu = {"uuid": "GPU-1", "temperature_celsius": 91.0, "ecc_errors": 2}
    for number in (1, 2):  # Two workers share the card.
        name = f"box-7-{number}"
        trouble = {"problem": "It fails", "problem_kind": "self-test"} if number == 2 else {}
        more = {"kind": "gpu", "gpu": gpu, **trouble}
        registry.report(services.sessions, name, "a GPU", 1, "idle", xid_errors=2, **more)
    unknown = gpu | {"uuid": "GPU-2", "temperature_celsius": None, "ecc_errors": None}
    registry.report(services.sessions, "other-1", "a GPU", 1, "idle", kind="gpu", gpu=unknown)
    found = scrape()
    assert found["workers", 'kind="gpu",status="problem"'] == 1
    assert found["workers", 'kind="gpu",status="idle"'] == 2
    assert found["worker_problems", 'host="box-7",problem="self-test"'] == 1
    card = 'gpu="GPU-1",host="box-7"'
    assert found["gpu_temperature_celsius", card] == 91
    assert found["gpu_ecc_errors_total", card] == 2
    assert found["gpu_xid_errors_total", 'host="box-7"'] == 4
    assert found["gpu_xid_errors_total", 'host="other"'] == 0
    assert not any("GPU-2" in labels for _, labels in found)


def test_the_servers_own_work_is_measured(serve, services, update_rows, eventually):
    with serve(reconcile_interval=0.05) as address:

        def lines():
            text = httpx.get(f"{address}/metrics", verify=False).text
            return dict(line.rsplit(" ", 1) for line in text.splitlines() if line[0] != "#")

        age = "microcosmos_reconciler_pass_age_seconds"
        eventually(lambda: float(lines().get(age, "inf")) < 20)  # Earlier tests had passes too.
        assert float(lines()["microcosmos_reconciler_pass_seconds"]) > 0
        with services.sessions.read() as session:
            then = ago(session, 600)
        update_rows(InstallationState, passed_at=then, reconciled_at=then)
        eventually(lambda: float(lines()[age]) < 20)
        found = lines()
    assert float(found["microcosmos_database_statement_seconds_count"]) > 10
    assert float(found['microcosmos_database_connections{state="in_use"}']) >= 0
    assert float(found["microcosmos_database_connections_limit"]) == 20
    free, whole = (f'microcosmos_disk_{one}_bytes{{holds="store"}}' for one in ("free", "size"))
    assert 0 < float(found[free]) < float(found[whole])


def test_metrics_without_the_database_show_the_rest(scrape, monkeypatch):
    def refuse(*_):
        raise OperationalError("SELECT", None, Exception("connection refused"))

    monkeypatch.setattr(metrics, "of_database", refuse)
    found = scrape()
    assert found["database_up", ""] == 0
    assert found["redis_up", ""] == 1
    assert not any(name == "runs" for name, _ in found)
