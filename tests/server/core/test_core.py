"""The data folder's mode, and JSON that people send."""

import os
import stat

import pytest

from server import main as alone
from server.core import database
from server.core.json_body import parse
from server.local import launcher
from server.settings import Settings


@pytest.fixture(autouse=True)
def usual():
    before = os.umask(0o022)
    yield
    os.umask(before)


def mode(folder):
    return stat.S_IMODE(folder.stat().st_mode)


def begin_alone(folder, monkeypatch):
    monkeypatch.setattr(alone, "Settings", lambda: Settings(data=folder))
    monkeypatch.setattr(alone.uvicorn, "run", lambda *_, **__: None)
    alone.main()


def open_database(folder):
    database.connect(f"sqlite:///{folder / 'microcosmos.sqlite'}").engine.dispose()


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


@pytest.mark.parametrize("body", [b'"\\\\u0000"', '"\U0001f41f"'.encode(), b'"\\ud83d\\udc1f"'])
def test_unusual_text_is_accepted(body):
    assert parse(body) in ("\\u0000", "\U0001f41f")
