"""The doctor finds faults of a machine and says how to fix them."""

import json
import os
import sqlite3
import subprocess
import sys
from contextlib import closing
from pathlib import Path

import pytest

from microcosmos.doctor import database, devices, disk, examination, memory, redis, versions
from microcosmos.doctor.finding import GIB, Finding, problem

MIGRATIONS = Path(__file__).parents[3] / "server" / "tables" / "migrations" / "versions"


def levels(findings):
    return {finding.level for finding in findings}


def test_a_probe_finds_the_devices_and_a_cache_that_works(tmp_path):
    found = list(devices.devices(tmp_path / "cache"))
    assert levels(found) == {"ok"}
    told = [finding.found for finding in found]
    assert any("× cpu" in text for text in told)
    assert "a program that was kept is found again" in told
    assert list((tmp_path / "cache").iterdir()) == []  # It leaves nothing behind.


def test_a_driver_that_hangs_is_told(tmp_path, monkeypatch):
    hanging = [sys.executable, "-c", "import time; time.sleep(60)"]
    run = subprocess.run
    monkeypatch.setattr(subprocess, "run", lambda _, **options: run(hanging, **options))
    *_, found = devices.devices(tmp_path, patience=0.2)
    assert found.level == "problem"
    assert "a driver hangs" in found.found


def test_an_error_of_jax_is_reported(tmp_path, monkeypatch):
    monkeypatch.setenv("JAX_PLATFORMS", "nonsense")
    *_, found = devices.devices(tmp_path)
    assert found.level == "problem"
    assert "nonsense" in found.found
    assert "JAX_PLATFORMS=cpu" in found.advice


@pytest.mark.parametrize(
    ("device", "said"),
    [
        ({"error": "CUDA_ERROR_UNKNOWN"}, "CUDA_ERROR_UNKNOWN"),
        ({"right": False, "memory_bytes": None}, "computes wrong numbers"),
    ],
)
def test_a_device_that_is_broken_is_told(tmp_path, monkeypatch, device, said):
    told = {"platform": "gpu", "model": "a model", "id": 0} | device
    answer = {"kind": "gpu", "devices": [told], "cache": {"kept": True, "found": False}}
    monkeypatch.setattr(devices, "probed", lambda *_: answer)
    found = list(devices.devices(tmp_path))
    assert any(said in one.found and one.level == "problem" for one in found)
    assert any("is not found again" in one.found for one in found)


def test_memory_of_a_gpu_is_told(tmp_path, monkeypatch):
    told = {"platform": "gpu", "model": "H", "id": 0, "right": True}
    told |= {"memory_bytes": 8 * GIB, "memory_used_bytes": 2 * GIB}
    answer = {"kind": "gpu, H", "devices": [told], "cache": {"kept": True, "found": True}}
    monkeypatch.setattr(devices, "probed", lambda *_: answer)
    assert any("6.0 GiB of 8.0 GiB free" in f.found for f in devices.devices(tmp_path))


def test_a_cache_that_cannot_be_is_a_problem(tmp_path):
    (tmp_path / "file").write_text("")
    found = next(devices.devices(tmp_path / "file" / "cache", patience=0.01))
    assert found.level == "problem"
    assert "JAX_COMPILATION_CACHE_DIR" in found.advice


@pytest.mark.parametrize(
    ("found", "needed", "satisfied"),
    [
        ("1.2.0", ">=1.2", True),
        ("1.10", ">=1.9", True),
        ("0.10.2", ">=0.8,<0.11", True),
        ("0.11.0", "<0.11", False),
        ("2.0.0rc1", ">=2", True),
        ("1.0", "!=1.0.0", False),
        ("3", "", True),
    ],
)
def test_versions_are_compared_as_numbers(found, needed, satisfied):
    assert versions.satisfied(found, needed) == satisfied


def test_packages_that_lack_or_are_old_are_named(monkeypatch):
    asked = [
        "nowhere-to-be-found>=1",
        "h5py>=999; python_version > '3'",
        "absent>=1; extra == 'x'",
    ]
    monkeypatch.setattr(versions, "requires", lambda _: asked)
    _, *found = versions.packages()
    assert [one.level for one in found] == ["problem", "problem"]
    assert "nowhere-to-be-found>=1 is needed and not installed" in found[0].found
    assert "h5py>=999 is needed" in found[1].found


def test_this_installation_is_as_it_should_be():
    assert levels([*versions.python(), *versions.packages()]) == {"ok"}


def test_a_container_has_the_memory_that_it_is_given(tmp_path):
    meminfo, limit = tmp_path / "meminfo", tmp_path / "max"
    meminfo.write_text("MemTotal:  8388608 kB\nMemAvailable:  4194304 kB\nHugePages: 0\n")
    limit.write_text("max\n")
    assert memory.there(meminfo, limit) == (8 * GIB, 4 * GIB)
    limit.write_text(f"{1 << 20}\n")
    small, *presets = memory.memory(meminfo, limit)
    assert (small.level, small.found) == ("warning", "1 MiB of 1 MiB available")
    assert any("quality-diversity/demo needs" in one.found for one in presets)


def test_a_full_a_remote_and_a_closed_folder_are_told(tmp_path, monkeypatch):
    mounts = tmp_path / "mounts"
    mounts.write_text(f"/dev/sda / ext4 rw 0 0\nhost:/x {tmp_path} nfs4 rw 0 0\n")
    assert disk.file_system(tmp_path / "deeper", mounts) == "nfs4"
    assert disk.file_system(Path("/other"), mounts) == "ext4"
    assert "SQLite may lose data" in list(disk.disk(tmp_path / "data", mounts))[-1].found
    assert list(tmp_path.iterdir()) == [mounts]  # Nothing is made.
    full = type("Usage", (), {"free": 5 << 20})
    monkeypatch.setattr(disk.shutil, "disk_usage", lambda _: full)
    assert next(disk.disk(tmp_path)).level == "problem"

    def refuse(*_: object, **__: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(disk.tempfile, "NamedTemporaryFile", refuse)
    assert any("Permission denied" in one.found for one in disk.disk(tmp_path))


def test_redis_that_is_named_has_to_answer():
    (found,) = redis.redis("redis://:secret@127.0.0.1:1/0")
    assert found.level == "problem"
    assert "127.0.0.1:1 does not answer" in found.found
    assert "secret" not in str(found)


def test_without_redis_it_is_said_who_needs_one(monkeypatch):
    monkeypatch.setattr(redis.shutil, "which", lambda _: None)
    monkeypatch.setattr(redis, "_carried", lambda: None)
    (found,) = redis.redis(None)
    assert found.level == "warning"
    assert "install" in found.advice


@pytest.mark.parametrize(
    ("made", "level", "said"),
    [
        (None, "ok", "first start makes it"),
        ("newest", "ok", "tables of migration"),
        ("0000", "warning", "is the newest"),
        ("9999", "problem", "knows them up to"),
        (b"no database", "problem", "not a database"),
    ],
)
def test_a_database_is_judged_by_its_migration(tmp_path, made, level, said):
    path = tmp_path / "microcosmos.sqlite"
    if isinstance(made, bytes):
        path.write_bytes(made * 100)
    elif made:
        version = database.head(MIGRATIONS) if made == "newest" else made
        with closing(sqlite3.connect(path)) as connection, connection:
            connection.execute("CREATE TABLE alembic_version (version_num TEXT)")
            connection.execute("INSERT INTO alembic_version VALUES (?)", (version,))
    (found,) = database.database(None, tmp_path, MIGRATIONS)
    assert (found.level, said in found.found) == (level, True)


def test_a_database_that_is_away_or_unknown_is_told(tmp_path):
    (away,) = database.database("postgresql+psycopg://me:secret@127.0.0.1:1/x", tmp_path)
    assert away.level == "problem"
    assert "secret" not in str(away)
    (unknown,) = database.database("oracle://x", tmp_path)
    assert unknown.level == "problem"


def test_the_newest_migration_is_the_one_that_none_follows():
    newest = database.head(MIGRATIONS)
    assert newest == max(path.name[:4] for path in MIGRATIONS.glob("0*.py"))
    assert database.head(Path("/nowhere")) is None


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
    environment = os.environ | {
        "MICROCOSMOS_DATA": str(tmp_path),
        "JAX_COMPILATION_CACHE_DIR": str(tmp_path),
        "JAX_PLATFORMS": "cpu",
    }
    command = [sys.executable, "-c", code, "doctor", "--json", "--url", "http://127.0.0.1:9"]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    assert done.stderr.splitlines()[-1] == "1 False"
    found = [Finding(**one) for one in json.loads(done.stdout)]
    assert [one.subject for one in found if one.level == "problem"] == ["server"]
    assert "make run" in found[-1].advice
