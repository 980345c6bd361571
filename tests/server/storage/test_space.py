"""A disk that fills warns before it is full."""

import httpx
import pytest
from object_store import new_prefix

from microcosmos_server.storage import space

EXABYTE = 10**18


@pytest.fixture
def short(services, monkeypatch) -> str:
    """The warning of a disk that has less than it should."""
    monkeypatch.setattr(services.settings, "min_free_bytes", EXABYTE)
    return space.shortage(services.settings, services.artifacts)


def test_enough_space_is_no_warning(services, api):
    assert space.shortage(services.settings, services.artifacts) is None
    assert api.get("queue").json()["warning"] is None


def test_the_warning_names_what_the_disk_holds_and_what_is_left(services, short, api):
    assert short.startswith(("The disk of the store has ", "The disk of the database has "))
    assert str(services.settings.data) not in short, "readers need no path of the server"
    assert short.endswith("runs keep their last checkpoint and lose what they compute after it")
    # Other programs write to the disk, too.
    begin = short.split(" has ")[0]
    assert api.get("queue").json()["warning"].startswith(begin)


def test_the_disk_of_the_database_is_that_of_its_file(services, tmp_path):
    url = f"sqlite:///{tmp_path / 'fast' / 'x.sqlite'}"
    settings = services.settings.model_copy(update={"database_url": url})
    assert space.folders(settings, services.artifacts)["database"] == tmp_path / "fast"


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


@pytest.mark.postgresql
def test_an_object_store_has_no_disk(object_store, serve, database):
    with serve(artifacts_url=new_prefix()) as address:
        ready = httpx.get(f"{address}/readyz").json()
        assert ready["store"] == "ok", "the first start marks it"
        assert ready["disk"] == ("none" if database == "postgresql" else "ok")
        found = httpx.get(f"{address}/api/v1/health").json()["disk"]
    assert (found["writable"], found["free_bytes"], found["file_system"]) == (True, None, "s3")
    assert found["location"].startswith("s3://")
