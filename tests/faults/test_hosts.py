"""Workers on several hosts, of which some cannot work: no run suffers from them."""

import signal
import subprocess
import sys

import pytest
from drive import ROOT, wait_until

pytestmark = pytest.mark.long


@pytest.fixture
def start_worker(start_product):
    """A product without workers, and a function that starts one with settings of its own."""
    product = start_product(WORKERS="0")
    (server,) = product.named("server.main")
    started = []

    def start(**settings):
        command = [sys.executable, "-m", "worker.supervisor"]
        environment = server.environ() | {"WORKERS": "1"} | settings
        started.append(subprocess.Popen(command, cwd=ROOT, env=environment))
        return started[-1]

    yield product, start
    for one in started:
        one.kill()
        one.wait()


def problem_of(product):
    """Wait until a worker, having tested itself, says why it takes no run."""

    def problem():
        found = (one["problem"] for one in product.get("workers"))
        return next((one for one in found if one and not one.startswith("It tests ")), None)

    return wait_until(problem, 120, "a worker says what is wrong")


def test_a_host_without_the_mount_takes_no_run_and_rewinds_none(
    start_worker, spec, undisturbed, tmp_path
):
    product, start = start_worker
    run = product.submit(spec)
    good = start()
    product.reach(run, 5)
    good.send_signal(signal.SIGTERM)
    good.wait(60)
    before = product.wait(run, "queued")
    assert before["generation"] >= 5
    (tmp_path / "empty").mkdir()
    lost = start(MICROCOSMOS_ARTIFACTS_URL=str(tmp_path / "empty"))
    reason = problem_of(product)
    assert reason.startswith(f"The store {tmp_path / 'empty'} has no file `installation`")
    later = product.read(run)
    assert (later["status"], later["generation"]) == ("queued", before["generation"])
    assert reason in later["waiting_reason"]
    assert lost.poll() is None, "it waits for the mount"
    start()
    product.wait(run, "finished", seconds=300)
    assert product.results(run) == undisturbed


def test_a_host_without_its_device_fails_no_run(start_worker, spec, undisturbed):
    product, start = start_worker
    runs = [product.submit(spec | {"seed": seed}) for seed in (7, 8, 9)]
    start(JAX_PLATFORMS="cuda")  # There is none.
    reason = problem_of(product)
    assert reason.startswith("Its self-test fails: ")
    found = [product.read(run) for run in runs]
    assert [one["status"] for one in found] == ["queued"] * 3
    assert reason in found[0]["waiting_reason"]
    start()
    for run in runs:
        product.wait(run, "finished", seconds=300)
    assert product.results(runs[0]) == undisturbed
