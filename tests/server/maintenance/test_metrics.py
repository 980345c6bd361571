"""Metrics for Prometheus."""

import re

import httpx
import pytest

from server.workers import registry

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
    assert after["generations_total", ""] == 4
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


def test_unknown_methods_are_counted_as_one(scrape, address):
    for number in range(5):
        assert httpx.request(f"INVENTED{number}", address, verify=False).status_code == 405
    methods = re.findall(r'method="(\w+)"', " ".join(labels for _, labels in scrape()))
    assert set(methods) == {"other"}


def test_metrics_without_redis_show_the_rest(run_id, serve):
    with serve(redis_url="redis://127.0.0.1:1/0") as address:
        lines = httpx.get(f"{address}/metrics", verify=False, timeout=30).text.splitlines()
    assert "microcosmos_redis_up 0.0" in lines
    assert 'microcosmos_runs{status="queued"} 1.0' in lines
    assert not any(line.startswith("microcosmos_queue_length{") for line in lines)
