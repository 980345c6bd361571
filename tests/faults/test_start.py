"""Reasons for which an installation does not start."""

import os
import re
import subprocess
import sys

import pytest
from drive import ROOT, free_port

from microcosmos_server.auth import tokens
from microcosmos_server.services.services import connect
from microcosmos_server.settings import Settings
from microcosmos_server.tables import migrations


@pytest.fixture
def refused(tmp_path):
    """Runs `python -m microcosmos_server.local`, which must refuse; returns its message."""

    def start(**environment):
        settings = {"MICROCOSMOS_DATA": str(tmp_path / "data"), "PORT": str(free_port())}
        answer = subprocess.run(
            [sys.executable, "-m", "microcosmos_server.local"],
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


def test_an_unusable_setting_is_named_with_the_reason(refused):
    message = refused(MICROCOSMOS_DATABASE_URL="postgresql://127.0.0.1:1/none")
    assert re.search("The database .* fails", message)


def test_a_server_without_an_admin_token_does_not_listen(tmp_path, refused):
    shared = connect(Settings(data=tmp_path / "data", database_url="", redis_url="redis://x"))
    migrations.upgrade(shared.sessions)
    tokens.create(shared, "reader", "read")
    shared.close()
    message = refused(MICROCOSMOS_AUTH="required")
    assert "there is none: create one with `python -m microcosmos_server.auth create" in message
