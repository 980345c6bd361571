"""Alert rules, and the queries of the dashboard against a real Prometheus and a real run."""

import json
import re
import shutil
import subprocess
import time
from contextlib import contextmanager

import httpx
import pytest
import yaml
from drive import ROOT, free_port, wait_until

DEPLOY = ROOT / "deploy"
RULES = DEPLOY / "prometheus" / "alerts.yml"
TESTS = DEPLOY / "prometheus" / "alerts_test.yml"
DASHBOARD = DEPLOY / "grafana" / "microcosmos.json"
OPERATION = (ROOT / "docs" / "operation.md").read_text()
NEED_MORE = {
    "microcosmos_worker_problems": "a worker with a problem",
    "microcosmos_gpu_temperature_celsius": "a GPU",
    "microcosmos_gpu_ecc_errors_total": "a GPU",
}
"""Metrics that a healthy installation without GPUs does not have."""
WINDOW = "10s"
"""In place of Grafana's window of rates, which is four scrapes and more."""

needs_prometheus = pytest.mark.skipif(
    shutil.which("promtool") is None or shutil.which("prometheus") is None,
    reason="no `prometheus` and `promtool` on PATH: Debian's package `prometheus` has them",
)


def alerts():
    return [
        rule for group in yaml.safe_load(RULES.read_text())["groups"] for rule in group["rules"]
    ]


def queries():
    panels = json.loads(DASHBOARD.read_text())["panels"]
    found = [target["expr"] for panel in panels for target in panel["targets"]]
    return [re.sub(r"\[[$\w]+\]", f"[{WINDOW}]", one) for one in found]


def metrics_in(text):
    """The names of metrics in an expression, as a scrape has them."""
    return set(re.findall(r"microcosmos_\w+", text))


@needs_prometheus
def test_rules_and_configuration_are_valid_and_each_alert_fires_and_is_quiet():
    for what in (
        ("check", "rules", RULES),
        ("check", "config", RULES.with_name("prometheus.yml")),
        ("test", "rules", TESTS),
    ):
        done = subprocess.run(["promtool", *what], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr + done.stdout


def test_each_alert_is_tested_both_ways_and_documented():
    names = {one["alert"] for one in alerts()}
    cases = [
        case
        for test in yaml.safe_load(TESTS.read_text())["tests"]
        for case in test["alert_rule_test"]
    ]
    assert {one["alertname"] for one in cases if one.get("exp_alerts")} == names
    assert {one["alertname"] for one in cases if not one.get("exp_alerts")} == names
    rows = re.findall(r"^\| `([A-Z]\w+)` \| (page|ticket) \|", OPERATION, re.MULTILINE)
    assert dict(rows) == {one["alert"]: one["labels"]["severity"] for one in alerts()}


@pytest.fixture(scope="module")
def computing(product, undisturbed, spec):
    """The installation while it computes a run that has a checkpoint."""
    search = spec["search"] | {"generations": 100_000}
    run = product.submit(spec | {"search": search})
    product.reach(run, 2)
    yield product
    httpx.post(f"http://127.0.0.1:{product.port}/api/v1/runs/{run}/cancel")
    product.wait(run, "cancelled", seconds=60)


def scraped(product):
    return httpx.get(f"http://127.0.0.1:{product.port}/metrics", timeout=20).text


def test_rules_and_dashboard_name_metrics_of_a_real_scrape(computing):
    found = set(re.findall(r"^(microcosmos_\w+?)(?:\{| )", scraped(computing), re.MULTILINE))
    used = set.union(
        *(metrics_in(one["expr"]) for one in alerts()), *map(metrics_in, queries())
    )
    assert used - found == set(NEED_MORE) & used
    unused = found - used - {"microcosmos_info"}
    assert {one for one in unused if not re.search("_(count|sum)$", one)} == set()


@contextmanager
def prometheus(folder, target):
    """A Prometheus that scrapes an address each second, on loopback; yields its API."""
    port = free_port()
    job = {"job_name": "microcosmos", "static_configs": [{"targets": [target]}]}
    settings = {"global": {"scrape_interval": "1s"}, "scrape_configs": [job]}
    (folder / "prometheus.yml").write_text(json.dumps(settings))
    command = [
        "prometheus",
        f"--config.file={folder / 'prometheus.yml'}",
        f"--storage.tsdb.path={folder / 'data'}",
        f"--web.listen-address=127.0.0.1:{port}",
    ]
    with (folder / "log").open("wb") as log:
        process = subprocess.Popen(command, stdout=log, stderr=log)
    try:
        yield f"http://127.0.0.1:{port}/api/v1/query"
    finally:
        process.terminate()
        process.wait()


@needs_prometheus
def test_the_dashboards_queries_return_data_of_a_real_run(computing, tmp_path):
    def ask(query):
        try:
            answer = httpx.get(api, params={"query": query}, timeout=20)
        except httpx.ConnectError:  # It has just started.
            return []
        assert answer.status_code in (200, 503), f"{query}: {answer.text}"
        return answer.json()["data"]["result"] if answer.status_code == 200 else []

    expected = {one for one in queries() if metrics_in(one) & set(NEED_MORE)}
    with prometheus(tmp_path, f"127.0.0.1:{computing.port}") as api:
        evaluated = f"rate(microcosmos_evaluations_total[{WINDOW}]) > 0"
        wait_until(lambda: ask(evaluated), 60, "two scrapes")
        # A scrape that a busy machine delays beyond its second hides all series until the next.
        empty, deadline = set(queries()), time.monotonic() + 20
        while empty != expected and time.monotonic() < deadline:
            time.sleep(0.5)
            empty = {query for query in empty if not ask(query)}
        firing = [one["alert"] for one in alerts() if ask(one["expr"])]
    assert empty == expected
    of_the_machine = {"DiskAlmostFull", "DiskFillsSoon", "DatabaseSlow"}
    assert set(firing) <= of_the_machine
