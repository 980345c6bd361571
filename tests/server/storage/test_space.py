"""A disk that fills warns before it is full."""

import shutil

import httpx
import pytest
from object_store import new_prefix

from server.storage import space

EXABYTE = 10**18


@pytest.fixture
def short(services, monkeypatch) -> str:
    """The warning of a disk that has less than it should."""
    monkeypatch.setattr(services.settings, "min_free_bytes", EXABYTE)
    return space.shortage(services.settings, services.artifacts)


def test_enough_space_is_no_warning(services, api):
    assert space.shortage(services.settings, services.artifacts) is None
    assert api.get("queue").json()["warning"] is None


def test_the_warning_names_the_folder_and_what_is_left(services, short, api):
    root = services.artifacts.root
    assert short.startswith((f"The disk of {root} has ", "The disk of "))
    assert short.endswith("runs keep their last checkpoint and lose what they compute after it")
    # Other programs write to the disk, too.
    begin = short.split(" has ")[0]
    assert api.get("queue").json()["warning"].startswith(begin)


def test_a_run_warns_with_its_checkpoint_until_there_is_space(
    services, attempt, record, row, short, monkeypatch
):
    record(1)
    assert attempt.checkpoint(1, b"state")
    assert row().checkpoint_generation == 1
    assert row().warning.startswith("The disk of ")
    monkeypatch.setattr(services.settings, "min_free_bytes", 0)
    record(2)
    assert attempt.checkpoint(2, b"state")
    assert row().warning is None


def test_a_server_is_ready_while_a_disk_is_almost_full_and_not_when_it_is(
    address, services, short, monkeypatch
):
    ready = httpx.get(f"{address}/readyz")
    assert (ready.status_code, ready.json()["disk"]) == (200, "almost full")
    monkeypatch.setattr(space, "FULL_BYTES", EXABYTE)
    ready = httpx.get(f"{address}/readyz")
    assert (ready.status_code, ready.json()["disk"]) == (503, "full")
    assert ready.json()["database"] == ready.json()["store"] == "ok", "neither is the culprit"


def test_the_free_bytes_of_each_disk_are_a_metric(services, address):
    text = httpx.get(f"{address}/metrics").text
    found = dict(
        line.removeprefix("microcosmos_disk_free_bytes").split()
        for line in text.splitlines()
        if line.startswith("microcosmos_disk_free_bytes")
    )
    for holds in found:
        assert holds in ('{holds="store"}', '{holds="database"}')
    free = shutil.disk_usage(services.settings.data).free
    assert float(found['{holds="store"}']) == pytest.approx(free, rel=0.2)


@pytest.mark.postgresql
def test_an_object_store_has_no_disk(object_store, serve, database):
    with serve(artifacts_url=new_prefix()) as address:
        ready = httpx.get(f"{address}/readyz").json()
        assert ready["store"] == "ok", "the first start marks it"
        assert ready["disk"] == ("none" if database == "postgresql" else "ok")
        found = httpx.get(f"{address}/api/v1/health").json()["disk"]
    assert (found["writable"], found["free_bytes"], found["file_system"]) == (True, None, "s3")
    assert found["location"].startswith("s3://")
