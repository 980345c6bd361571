"""Interrupted runs end with the same archive, byte for byte."""

import io
import json
import os
import random
import shutil
import signal
import subprocess
from contextlib import suppress

import h5py
import pytest
from databases import Missing, service_settings
from drive import (
    interrupt,
    kill_job,
    kill_job_of,
    kill_worker,
    pause_and_resume,
    stop_worker,
    wait_until,
)

from microcosmos.archive import file

LATEST = 9
"""Faults come before this generation, so that the run is not over."""


def test_a_run_that_is_killed_and_paused_ends_with_the_same_archive(product, spec, undisturbed):
    faults = [kill_job, pause_and_resume]
    moments = sorted(random.choices(range(LATEST), k=len(faults)))
    run = product.submit(spec)
    interrupt(product, run, zip(moments, faults, strict=True))
    assert product.wait(run, "finished")["attempt"] == 1 + len(faults)
    assert product.results(run) == undisturbed, f"interrupted at {moments}"


AGAIN = {"reevaluation": {"every": 3, "samples": 2}}
PARTS = {
    "screening, initial": {"search": AGAIN | {"screening": {"rounds": 2, "candidates": 3}}},
    "fronts": {"archive": {"container": {"kind": "fronts", "size": 3}}},
    "learned axes": {
        "archive": {"container": {"kind": "learned", "bins": 5, "first": 2, "measures": []}}
    },
    "lessons": {
        "control": {"encoding": "direct", "period": 30},
        "search": {"emitters": [{"operator": "cma-mega"}]},
    },
    "table": {
        "experiment": "gaits",
        "swimmers": ["worm", "tadpole", "ray"],
        "viscosities": [0.1, 0.2, 0.5, 1.0],
        "period": 40,
        "cycles": 20,
    },
}
"""Searches with each optional part, and an experiment of another kind. Every search can breed;
`worker/test_evolution.py` kills one whose creatures were chosen."""


@pytest.mark.long
@pytest.mark.parametrize("part", PARTS)
def test_a_killed_run_with_each_part_ends_with_the_same_bytes(product, spec, undisturbed, part):
    document = PARTS[part]
    if "experiment" not in document:
        search = spec["search"] | {"generations": 20, "batch": 8} | document.get("search", {})
        document = spec | document | {"search": search}
    if "initial" in part:
        document["search"]["initial"] = sorted(undisturbed["archive"]["creature"][:2])
    runs = [product.submit(document) for _ in range(2)]
    interrupt(product, runs[1], [(2, kill_job_of)], seconds=300)
    attempts = [product.wait(run, "finished", seconds=300)["attempt"] for run in runs]
    assert attempts == [1, 2]
    assert product.archive(runs[0]) == product.archive(runs[1])


@pytest.mark.long
def test_a_run_goes_on_while_redis_is_killed_and_started_again(product, spec, undisturbed):
    run = product.submit(spec)
    attempt = product.reach(run, 1)
    product.signal("redis-server", signal.SIGKILL)
    assert product.wait(run, "finished")["attempt"] == attempt
    assert product.results(run) == undisturbed
    product.wait(product.submit(spec), "finished")


@pytest.mark.long
def test_a_frozen_worker_is_replaced_and_writes_nothing_when_it_wakes(
    product, spec, undisturbed
):
    run = product.submit(spec)
    attempt = product.reach(run, 2)
    with product.slowed():
        owner = product.owner(run)
    with product.frozen([owner, *owner.children(recursive=True)]):
        successor = product.reach(run, 0, after=attempt)
    assert product.wait(run, "finished")["attempt"] == successor == attempt + 1
    assert product.results(run) == undisturbed
    wait_until(lambda: not owner.children(), 10, "the woken job has ended")
    assert owner.is_running()


@pytest.mark.long
@pytest.mark.parametrize(
    ("sent", "status", "seconds"), [(signal.SIGINT, 0, 10), (signal.SIGKILL, -9, 30)]
)
def test_the_end_of_the_root_ends_all_and_the_next_start_resumes(
    product, spec, undisturbed, sent, status, seconds
):
    run = product.submit(spec)
    product.reach(run, 3)
    assert product.end(sent) == status
    wait_until(lambda: not list(product.processes()), seconds, "all processes have ended")
    product.start()
    product.wait(run, "finished")
    assert product.results(run) == undisturbed


@pytest.fixture
def postgresql_and_redis():
    """The settings of an installation on this machine's PostgreSQL and Redis."""
    try:
        with service_settings() as settings:
            yield settings
    except Missing as missing:
        pytest.skip(str(missing))


@pytest.mark.long
def test_postgresql_and_a_redis_server_give_the_same_bytes(
    postgresql_and_redis, start_product, spec, undisturbed
):
    """`undisturbed` is of SQLite and the embedded Redis."""
    product = start_product(**postgresql_and_redis)
    assert "the one that MICROCOSMOS_REDIS_URL names" in product.output.read_text()
    assert not product.named("redis-server")
    assert not list(product.folder.glob("*.sqlite"))
    run = product.submit(spec)
    interrupt(product, run, [(1, kill_job), (4, kill_worker), (7, stop_worker)])
    assert product.wait(run, "finished")["attempt"] == 4
    assert product.results(run) == undisturbed


@pytest.mark.long
def test_a_run_changes_device_only_with_its_owners_leave(start_product, spec):
    product = start_product()
    run = product.submit(spec)
    product.reach(run, 3)
    product.end()
    product.environment["XLA_FLAGS"] += " --xla_cpu_enable_fast_math=false"  # Another kind.
    product.start()
    words = "Waits for a worker whose device repeats its bits"
    waits = product.follow(run, lambda one: words in (one["waiting_reason"] or ""), 120, words)
    assert waits["attempt"] == 1
    leave = {"device_patience": 0}
    product.http.patch(f"/api/v1/runs/{run}", json=leave).raise_for_status()
    product.wait(run, "finished")
    _, attributes = file.load(product.archive(run))
    first, second = json.loads(attributes["device"])
    assert first != second
    assert "--xla_cpu_enable_fast_math=false" in second


@pytest.fixture
def small_disk(tmp_path):
    """A folder on a file system of its own, of four megabytes."""
    folder = tmp_path / "disk"
    folder.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=4m", "tmpfs", str(folder)]
    if os.geteuid() or subprocess.run(mount, check=False, capture_output=True).returncode:
        pytest.skip("mounting a small disk needs root")
    yield folder
    subprocess.run(["umount", "--lazy", str(folder)], check=True)


def fill(folder):
    """Fill the disk, and return the file that takes the space."""
    ballast = folder / "ballast"
    with suppress(OSError), ballast.open("wb", 0) as file:
        while True:
            file.write(bytes(4096))
    assert not shutil.disk_usage(folder).free
    return ballast


@pytest.mark.long
def test_a_full_disk_leaves_the_last_checkpoint_and_the_run_says_so(
    small_disk, start_product, spec, undisturbed
):
    product = start_product(MICROCOSMOS_ARTIFACTS_URL=str(small_disk))
    run = product.submit(spec)
    product.reach(run, 3)
    ballast = fill(small_disk)
    paused = product.wait(run, "paused")
    assert "No space left on device" in paused["warning"]
    with h5py.File(io.BytesIO(product.archive(run))) as archive:
        assert 0 < archive["loop/generation"][()] < spec["search"]["generations"]
    ballast.unlink()
    product.ask(run, "resume")
    assert product.wait(run, "finished")["warning"] is None
    assert product.results(run) == undisturbed


@pytest.mark.long
def test_a_replay_is_made_though_its_renderer_is_killed(product, undisturbed):
    creature = undisturbed["archive"]["creature"][0]
    address = f"/api/v1/creatures/{creature}/replay"
    assert product.http.get(address).status_code == 202
    product.signal("microcosmos_worker.renderer", signal.SIGKILL)

    def there():
        answer = product.http.get(address)
        assert answer.status_code in (200, 202), answer.text
        return answer.content if answer.status_code == 200 else None

    replay = wait_until(there, 120, "the replay is there")
    size = int.from_bytes(replay[:4], "little")
    header = json.loads(replay[4 : 4 + size])
    assert header["creature"] == creature
    floats = 2 * header["nodes"] + len(header["joints"]) + len(header["edges"])
    cells = header["size"][0] * header["size"][1]
    planes = 3 * header["frames"] + header["energy"]["frames"]
    assert len(replay) == 4 + size + 4 * header["frames"] * floats + planes * cells
