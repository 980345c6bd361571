"""The doctor finds faults of a machine and names their remedies."""

import json
import os
import subprocess
import sys

import pytest

from microcosmos.doctor import examination, machine, server
from microcosmos.doctor.machine import Finding, problem

GIB = 1 << 30


def levels(findings):
    return {finding.level for finding in findings}


def test_a_probe_finds_the_devices_and_a_cache_that_works(tmp_path):
    found = list(machine.devices(tmp_path / "cache"))
    assert levels(found) == {"ok"}
    texts = [finding.found for finding in found]
    assert any("× cpu" in text for text in texts)
    assert "a stored program is loaded again" in texts
    assert list((tmp_path / "cache").iterdir()) == []  # It leaves nothing behind.


def test_a_driver_that_hangs_is_reported(tmp_path, monkeypatch):
    hanging = [sys.executable, "-c", "import time; time.sleep(60)"]
    run = subprocess.run
    monkeypatch.setattr(subprocess, "run", lambda _, **options: run(hanging, **options))
    *_, found = machine.devices(tmp_path, patience=0.2)
    assert found.level == "problem"
    assert "a driver hangs" in found.found


def test_an_error_of_jax_is_reported(tmp_path, monkeypatch):
    monkeypatch.setenv("JAX_PLATFORMS", "nonsense")
    *_, found = machine.devices(tmp_path)
    assert found.level == "problem"
    assert "nonsense" in found.found
    assert "JAX_PLATFORMS=cpu" in found.advice


@pytest.mark.parametrize("name", ["MICROCOSMOS_KERNEL", "MICROCOSMOS_INSTRUCTION_SET"])
def test_a_variable_of_the_kernel_with_a_wrong_value_is_named(tmp_path, monkeypatch, name):
    if name != "MICROCOSMOS_KERNEL":
        pytest.importorskip("microcosmos_kernels", reason="it is not installed: no compiler?")
    monkeypatch.setenv(name, "avx")
    *_, found = machine.devices(tmp_path)
    assert (found.level, found.subject) == ("problem", "native kernel")
    assert f"`{name}` must be one of " in found.found
    assert "correct or unset the variable" in found.advice


MEMORY = {"memory_bytes": 8 * GIB, "memory_used_bytes": 2 * GIB}
LOST = ("warning", "is not loaded again")


@pytest.mark.parametrize(
    ("device", "loaded", "expected"),
    [
        ({"error": "CUDA_ERROR_UNKNOWN"}, False, [("problem", "CUDA_ERROR_UNKNOWN"), LOST]),
        ({"correct": False, "memory_bytes": None}, False, [("problem", "wrong numbers"), LOST]),
        ({"correct": True} | MEMORY, True, [("ok", "6.44 GB of 8.59 GB free")]),
    ],
)
def test_a_device_is_reported_with_its_faults(tmp_path, monkeypatch, device, loaded, expected):
    whole = {"platform": "gpu", "model": "a model", "id": 0} | device
    answer = {
        "kind": "gpu",
        "kernel": {"chosen": "auto", "version": None},
        "devices": [whole],
        "cache": {"stored": True, "loaded": loaded},
    }
    monkeypatch.setattr(machine, "probed", lambda *_: answer)
    found = list(machine.devices(tmp_path))
    for level, text in expected:
        assert any(text in one.found and one.level == level for one in found)


def test_packages_that_lack_or_are_old_are_named(monkeypatch):
    needed = ["nowhere-to-be-found>=1", "h5py>=999; python_version > '3'"]
    needed.append("absent>=1; extra == 'x'")
    monkeypatch.setattr(machine, "requires", lambda _: needed)
    _, *found = machine.packages()
    assert [one.level for one in found] == ["problem", "problem"]
    assert "nowhere-to-be-found>=1 is needed and not installed" in found[0].found
    assert "h5py>=999 is needed" in found[1].found


def test_this_installation_is_as_it_should_be():
    assert levels([*machine.python(), *machine.packages()]) == {"ok"}


def test_a_container_has_the_memory_that_is_left_of_its_limit(tmp_path):
    meminfo = tmp_path / "meminfo"
    meminfo.write_text("MemTotal:  8388608 kB\nMemAvailable:  4194304 kB\nHugePages: 0\n")
    (tmp_path / "memory.max").write_text("max\n")
    assert machine.memory_bytes(meminfo, tmp_path) == (8 * GIB, 4 * GIB)
    (tmp_path / "memory.max").write_text("5000000\n")
    (tmp_path / "memory.current").write_text("4500000\n")
    (tmp_path / "memory.stat").write_text("anon 1500000\ninactive_file 3000000\n")
    small, *presets = machine.memory(meminfo, tmp_path)
    assert (small.level, small.found) == ("warning", "3.5 MB of 5 MB available")
    assert any("quality-diversity/demo needs" in one.found for one in presets)


REACHED = {"reachable": True, "error": None}
DATABASE = {"dialect": "sqlite", "version": "3.45", "location": "/data/microcosmos.sqlite"}
DATABASE |= REACHED | {"revision": "0001", "newest_revision": "0001"}
DISK = {"location": "/data/artifacts", "free_bytes": 100 * GIB, "file_system": "ext4"}
DISK |= {"writable": True, "write_seconds": 0.002, "error": None}
REDIS = {"location": "127.0.0.1:6379", "version": "7.2", "policy": "noeviction"} | REACHED


@pytest.mark.parametrize(
    ("changed", "level", "text"),
    [
        ({}, "ok", "sqlite 3.45 at /data/microcosmos.sqlite, tables of migration 0001"),
        ({"revision": "0000"}, "warning", "0001 is the newest"),
        ({"revision": None}, "warning", "0001 is the newest"),
        ({"revision": "9999"}, "problem", "knows up to 0001"),
        ({"reachable": False, "error": "file is not a database"}, "problem", "not a database"),
    ],
)
def test_a_database_is_judged_by_its_migration(changed, level, text):
    (found,) = server.database(DATABASE | changed)
    assert (found.level, text in found.found) == (level, True)


@pytest.mark.parametrize(
    ("changed", "expected"),
    [
        ({"free_bytes": 5 << 20}, {("problem", "5.24 MB free at /data/artifacts")}),
        ({"free_bytes": 2 * GIB}, {("warning", "2.15 GB free at /data/artifacts")}),
        ({"writable": False, "error": "EACCES"}, {("problem", "be written to: EACCES")}),
        ({"write_seconds": 1.5}, {("warning", "takes 1500 ms")}),
        ({"file_system": "nfs4"}, {("warning", "where SQLite may lose data")}),
        ({"free_bytes": None}, set()),
        ({}, set()),
    ],
)
def test_a_full_a_slow_a_remote_and_a_closed_store_are_reported(changed, expected):
    found = [one for one in server.disk(DISK | changed, "sqlite") if one.level != "ok"]
    assert len(found) == len(expected)
    for level, text in expected:
        assert any(one.level == level and one.found.endswith(text) for one in found)
    assert not any("SQLite" in one.found for one in server.disk(DISK | changed, "postgresql"))


@pytest.mark.parametrize(
    ("changed", "levels"),
    [
        ({}, ["ok"]),
        ({"policy": "allkeys-lru"}, ["ok", "warning"]),
        ({"reachable": False, "error": "refused"}, ["problem"]),
    ],
)
def test_redis_has_to_answer_and_to_keep_its_messages(changed, levels):
    assert [one.level for one in server.redis(REDIS | changed)] == levels


def test_a_check_that_fails_leaves_the_other_checks(monkeypatch, tmp_path):
    def broken():
        yield problem("memory", "little", "get more")
        raise KeyError("MemAvailable")

    monkeypatch.setattr(examination, "memory", broken)
    monkeypatch.setattr(examination, "devices", lambda _: iter(()))
    found = list(examination.examine("http://127.0.0.1:9", None, tmp_path))
    assert [one.subject for one in found][-1] == "server"
    assert any("KeyError: 'MemAvailable'" in one.found for one in found)


def test_the_command_says_what_to_do_and_ends_with_1(tmp_path):
    """In a process of its own, which shows that the command itself starts no device."""
    code = (
        "import sys, microcosmos.cli as cli\n"
        "try: cli.app(sys.argv[1:])\n"
        "except SystemExit as end: print(end.code, 'jax' in sys.modules, file=sys.stderr)"
    )
    device = {"JAX_COMPILATION_CACHE_DIR": str(tmp_path), "JAX_PLATFORMS": "cpu"}
    command = [sys.executable, "-c", code, "doctor", "--json", "--url", "http://127.0.0.1:9"]
    done = subprocess.run(
        command, env=os.environ | device, capture_output=True, text=True, check=True
    )
    assert done.stderr.splitlines()[-1] == "1 False"
    found = [Finding(**one) for one in json.loads(done.stdout)]
    assert [one.subject for one in found if one.level == "problem"] == ["server"]
    assert "make run" in found[-1].advice
    assert "database, disk and Redis are not checked" in found[-1].found


@pytest.mark.parametrize(
    ("kernel", "level", "text"),
    [
        ({"chosen": "auto", "version": "0.1.0"}, "ok", "version 0.1.0 simulates"),
        ({"chosen": "jax", "version": None}, "ok", "leaves it out"),
        ({"chosen": "auto", "version": None}, "warning", "several times slower"),
    ],
)
def test_the_native_kernel_is_reported(tmp_path, monkeypatch, kernel, level, text):
    device = {"platform": "cpu", "model": "cpu", "id": 0, "correct": True, "memory_bytes": None}
    answer = {
        "kind": "cpu",
        "kernel": kernel,
        "devices": [device],
        "cache": {"stored": True, "loaded": True},
    }
    monkeypatch.setattr(machine, "probed", lambda *_: answer)
    found = next(one for one in machine.devices(tmp_path) if one.subject == "native kernel")
    assert found.level == level
    assert text in found.found
