"""The data folder's mode, and JSON that people send."""

import json
import os
import stat
import time
from contextlib import closing
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from redis import Redis
from relay import Relay
from sqlalchemy import make_url, text, update
from sqlalchemy.exc import OperationalError

from microcosmos_server import main as alone
from microcosmos_server.core import database as connections
from microcosmos_server.core.errors import problem_response
from microcosmos_server.core.json_body import parse
from microcosmos_server.core.processes import end
from microcosmos_server.local import launcher, redis_embedded
from microcosmos_server.maintenance import backup
from microcosmos_server.services.services import connect
from microcosmos_server.settings import Settings, create_data_folder, from_environment
from microcosmos_server.storage import mark
from microcosmos_server.tables import Run, migrations


@pytest.fixture(autouse=True)
def usual():
    before = os.umask(0o022)
    yield
    os.umask(before)


def mode(folder):
    return stat.S_IMODE(folder.stat().st_mode)


def begin_alone(folder, monkeypatch):
    monkeypatch.setattr(alone, "from_environment", lambda: Settings(data=folder))
    monkeypatch.setattr(alone.uvicorn, "run", lambda *_, **__: None)
    alone.main()


def open_database(folder):
    connections.connect(Settings(data=folder).database).engine.dispose()


def test_a_new_data_folder_is_private(tmp_path, monkeypatch):
    ways = {
        "all": lambda folder: launcher.lock_data_folder(Settings(data=folder)),
        "alone": lambda folder: begin_alone(folder, monkeypatch),
        "database": open_database,
    }
    for name, begin in ways.items():
        begin(tmp_path / name / "data")
        assert mode(tmp_path / name / "data") == 0o700, name
        assert mode(tmp_path / name) == 0o755, "folders above it are as usual"


def test_an_open_data_folder_stays_open_with_a_warning(tmp_path, capsys):
    (tmp_path / "data").mkdir()
    launcher.lock_data_folder(Settings(data=tmp_path / "data"))
    assert mode(tmp_path / "data") == 0o755
    assert capsys.readouterr().out == ""
    (tmp_path / "other").mkdir()
    launcher.lock_data_folder(Settings(data=tmp_path / "other", auth="required"))
    assert f"other users can look into {tmp_path / 'other'}" in capsys.readouterr().out


ODD_NAMES = (
    *("r?1", "r?2", "50%", "#1", "a&b", "a:b", "a::b", "a;b", "two words", "new\nline"),
    *("кит", "鯨", "\u202eحوت", 'quote"', "back\\slash"),
)


@pytest.mark.parametrize("name", ODD_NAMES)
def test_any_name_of_a_data_folder_is_that_of_the_folder(tmp_path, name):
    folder = tmp_path / name / "data"
    services = connect(Settings(data=folder))
    migrations.upgrade(services.sessions)
    mark.leave(services.sessions, services.artifacts)
    services.artifacts.write("a/file", b"content")
    assert services.artifacts.read("a/file") == b"content"
    services.close()
    saved = backup.make(services, tmp_path / f"{name}-copy")
    assert saved.database == "sqlite"
    assert {one.name for one in tmp_path.iterdir()} == {name, f"{name}-copy"}
    assert {one.name for one in folder.iterdir()} >= {"microcosmos.sqlite", "artifacts"}


@pytest.mark.parametrize("name", ["plain", "r?1 #% 鯨", 'a"b\\c', "new\nline"])
def test_redis_starts_in_any_folder(tmp_path, name):
    redis = redis_embedded.prepare(tmp_path / name)
    process = redis.start(tmp_path / "log")
    try:
        redis.wait(process, tmp_path / "log")
        with Redis.from_url(redis.url) as client:
            assert client.config_get("dir")["dir"] == str(tmp_path / name)
    finally:
        end(process)
        os.close(redis.lock)


def test_a_folder_that_cannot_be_is_refused_by_its_name(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    (tmp_path / "circle").symlink_to(tmp_path / "circle")
    wrong = {
        "file": "is a file",
        "file/below": f"{tmp_path / 'file'} is a file",
        "circle": "ymlink loop",
        "a" * 256: "File name too long",
    }
    for name, said in wrong.items():
        monkeypatch.setenv("MICROCOSMOS_DATA", str(tmp_path / name))
        with pytest.raises(SystemExit) as end_of_program:
            from_environment()
        text = str(end_of_program.value)
        assert text.startswith("`data` must be a folder, or one that can be made; got "), name
        assert str(tmp_path / name) in text
        assert said in text


@pytest.mark.parametrize(
    ("name", "wrong", "needed"),
    [
        ("LEASE", "inf", "less than or equal to 3153600000"),
        ("GRACE", "1e11", "less than or equal to 3153600000"),
        ("RECONCILE_INTERVAL", "inf", "less than or equal to 3153600000"),
        ("BIN_SECONDS", "inf", "less than or equal to 3153600000"),
        ("KEEP_CHECKPOINTS", "1e6", "must be at most 36500 days, or inf: for ever"),
        ("KEEP_RENDERINGS", "1e6", "must be at most 36500 days, or inf: for ever"),
        ("KEEP_DEVICE_USE", "nan", "greater than or equal to 31"),
        ("DATABASE_URL", "sqlite://", "or sqlite:///FILE"),
        ("DATABASE_URL", "sqlite:///:memory:", "or sqlite:///FILE"),
        ("DATABASE_URL", "sqlite:///file::memory:?uri=true", "or sqlite:///FILE"),
        ("DATABASE_URL", "sqlite:///file:x?mode=memory&uri=true", "or sqlite:///FILE"),
        ("DATABASE_URL", "sqlite+aiosqlite:///x", "or sqlite:///FILE"),
        ("DATABASE_URL", "postgresql+psycopg2://host/x", "must be postgresql+psycopg://"),
        ("REDIS_URL", "http://host", "must be redis://"),
        ("REDIS_URL", "redis://host:abc", "must be redis://"),
        ("REDIS_URL", "redis://host/abc", "must be redis://"),
        ("REDIS_URL", "redis://host/0?foo=1", "must be redis://"),
        ("REDIS_URL", "rediss://host/0?ssl_cert_reqs=foo", "must be redis://"),
    ],
)
def test_a_setting_that_would_break_later_is_refused_at_the_start(
    monkeypatch, name, wrong, needed
):
    monkeypatch.setenv(f"MICROCOSMOS_{name}", wrong)
    with pytest.raises(SystemExit) as end_of_program:
        from_environment()
    text = str(end_of_program.value)
    assert text.startswith(f"`{name.lower()}` ")
    assert needed in text


@pytest.mark.parametrize(
    "url",
    [
        *("redis://host", "redis://host/", "rediss://:secret@host:1/3?ssl_ca_certs=/ca.pem"),
        "unix:///run/redis.sock?db=1",
    ],
)
def test_each_address_of_redis_is_accepted(url):
    assert Settings(redis_url=url).redis_url == url


def test_a_folder_that_nobody_may_make_is_refused_by_its_name():
    with pytest.raises(SystemExit, match=r"`data` must be .*; got /proc/none/data"):
        create_data_folder(Settings(data=Path("/proc/none/data")))


@pytest.mark.parametrize("body", [b'"\\\\u0000"', '"\U0001f41f"'.encode(), b'"\\ud83d\\udc1f"'])
def test_unusual_text_is_accepted(body):
    assert parse(body) in ("\\u0000", "\U0001f41f")


@pytest.mark.postgresql
@pytest.mark.parametrize("database", ["postgresql"], indirect=True)
def test_a_database_that_is_read_only_is_named(services, run_id, read_only):
    read_only(1)
    with pytest.raises(OperationalError) as raised, services.sessions.write.begin() as session:
        session.execute(update(Run).values(note="new"))
    answer = problem_response(raised.value)
    assert (answer.status_code, answer.headers["retry-after"]) == (503, "2")
    assert json.loads(answer.body)["detail"] == "The database does not answer; try again."


@pytest.mark.parametrize("database", ["postgresql"], indirect=True)
def test_a_frozen_postgresql_is_not_waited_for_for_ever(services, monkeypatch):
    monkeypatch.setattr(connections.PatientConnection, "patience", 1.0)
    url = make_url(services.settings.database_url)
    ask = text("SELECT 1")
    with closing(Relay(f"http://{url.host}:{url.port or 5432}")) as relay:
        place = urlsplit(relay.url)
        sessions = connections.connect(url.set(host=place.hostname, port=place.port))
        with sessions.read() as session:
            assert session.scalar(ask) == 1
            relay.going.clear()
            began = time.monotonic()
            with pytest.raises(OperationalError, match="no answer for 1 s"):
                session.scalar(ask)
            assert time.monotonic() - began < 8
        relay.going.set()
        with sessions.read() as session:
            assert session.scalar(ask) == 1, "a new connection answers"
        sessions.engine.dispose()
