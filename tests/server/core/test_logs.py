"""Logs: fields of requests and workers, no secrets, and rotation under writers."""

import json
import logging
import shutil
import subprocess
import sys
from uuid import uuid4

import httpx
import pytest
from real_server import started

from microcosmos_server.auth import tokens
from microcosmos_server.core import logs
from microcosmos_server.core.logs import Json, Plain, redacted
from microcosmos_server.local.launcher import OLDER_PARTS, rotate
from microcosmos_server.settings import Settings

ADMIN = "an-admin-token-of-this-test"
WRITER = """
import sys
for first in map(int, sys.stdin):
    for number in range(first, first + 1000):
        sys.stdout.write(f"line {number:05d}\\n")
    sys.stdout.flush()
    print("written", file=sys.stderr, flush=True)
"""


def record(text: str, *values: object, **fields: object) -> logging.LogRecord:
    made = logging.LogRecord("server.test", logging.WARNING, "", 0, text, values, None)
    vars(made).update(fields)
    return made


def test_a_line_has_the_fields_that_are_known():
    line = json.loads(Json().format(record("%d %s", 2, "runs", run="1b4e", attempt=3)))
    assert line.pop("at").endswith("+00:00")
    assert line == {
        "level": "warning",
        "logger": "server.test",
        "message": "2 runs",
        "run": "1b4e",
        "attempt": 3,
    }
    assert Plain().format(record("text", worker="a-1")).endswith("server.test: text worker=a-1")


def test_secrets_are_in_no_line(services):
    secret = tokens.create(services, "laptop", "read").secret
    settings = Settings(
        token=ADMIN,
        redis_url="redis://:p4ssw0rd@127.0.0.1/0",
        database_url="postgresql://ada:hunter2@127.0.0.1/x",
    )
    try:
        raise ValueError(f"{settings.redis_url} {secret}")
    except ValueError:
        failed = sys.exc_info()
    known = logs._secrets(settings)
    texts = (
        f"token {secret} is revoked",
        f"GET /runs?token={secret}&a=b",
        f"Authorization: Bearer {ADMIN}",
        "authorization: bearer anything-else",
        f"Cookie: microcosmos_token={secret}",
        f"connecting to {settings.database_url}",
        "http://somebody:else@host/path",
        "hunter2 by itself",
        "the store has lost shares/abcd-efgh_ijklmnop.h5",
    )
    for form in (Json(known), Plain(known)):
        lines = [form.format(record(text)) for text in texts]
        lines.append(form.format(record("failed", exc_info=failed)))
        for hidden in (
            secret,
            ADMIN,
            "p4ssw0rd",
            "hunter2",
            "anything-else",
            "somebody:else",
            "efgh",
        ):
            assert not [line for line in lines if hidden in line]
        assert secret[: tokens.PREVIEW_LENGTH] in lines[0]
    assert redacted("http://host:80/a@b", ()) == "http://host:80/a@b"


def test_a_server_logs_requests_as_json_with_their_ids(tmp_path):
    run = str(uuid4())
    settings = {
        "MICROCOSMOS_DATA": str(tmp_path),
        "MICROCOSMOS_LOG_FORMAT": "json",
        "MICROCOSMOS_TOKEN": ADMIN,
        "MICROCOSMOS_REDIS_URL": "redis://:p4ssw0rd@127.0.0.1:1/0",
    }
    with (
        (tmp_path / "log").open("wb") as log,
        started(log, **settings) as (_, address),
        httpx.Client(base_url=address, timeout=30) as client,
    ):
        client.headers["Authorization"] = f"Bearer {ADMIN}"
        made = client.get(f"/api/v1/runs/{run}").headers["X-Request-ID"]
        kept = client.get("/healthz", headers={"X-Request-ID": "of-a-proxy.1"})
        assert kept.headers["X-Request-ID"] == "of-a-proxy.1"
        refused = client.get("/healthz", headers={"X-Request-ID": 'x" injected'})
        assert refused.headers["X-Request-ID"].isalnum()
        client.cookies.set("microcosmos_token", ADMIN)
        client.get(f"/?token={ADMIN}")
        client.get(f"/?token={'wrong' * 8}")
        client.get("/readyz")
    text = (tmp_path / "log").read_text()
    lines = [json.loads(line) for line in text.splitlines()]
    (one,) = [line for line in lines if line.get("request") == made]
    assert (one["run"], one["logger"]) == (run, "uvicorn.access")
    assert one["message"].endswith(f'"GET /api/v1/runs/{run} HTTP/1.1" 404')
    assert any(line.get("request") == "of-a-proxy.1" for line in lines)
    assert any("127.0.0.1:1" in line["message"] for line in lines), "Redis does not answer"
    for hidden in (ADMIN, "p4ssw0rd", "wrongwrong", "injected"):
        assert hidden not in text


def test_a_long_log_is_rotated_under_its_writer(tmp_path):
    log = tmp_path / "server.log"
    (tmp_path / "short.log").write_text("short")
    pipes = {"stdin": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    with log.open("ab") as output:
        writer = subprocess.Popen([sys.executable, "-c", WRITER], stdout=output, **pipes)
    with writer:
        for part in range(OLDER_PARTS + 3):
            writer.stdin.write(f"{1000 * part}\n")
            writer.stdin.flush()
            assert writer.stderr.readline() == "written\n"
            if part < OLDER_PARTS + 2:
                rotate(tmp_path, 10_999)
            rotate(tmp_path, 1 << 20)
    names = ["server.log", *(f"server.log.{number}" for number in range(1, OLDER_PARTS + 1))]
    assert sorted(path.name for path in tmp_path.iterdir()) == [*names, "short.log"]
    for age, name in enumerate(names):
        first = 1000 * (OLDER_PARTS + 2 - age)
        lines = (tmp_path / name).read_text().splitlines()
        assert lines == [f"line {number:05d}" for number in range(first, first + 1000)]


def test_a_full_disk_loses_no_older_part_of_a_log(tmp_path, monkeypatch, capsys):
    for name in ("a.log", "b.log"):
        (tmp_path / name).write_text("new" * 9)
        (tmp_path / f"{name}.1").write_text("old")

    copied = shutil.copyfile

    def full(source, target):
        if source.name == "a.log":
            target.write_text("n")
            raise OSError(28, "No space left on device")
        copied(source, target)

    monkeypatch.setattr(shutil, "copyfile", full)
    rotate(tmp_path, 9)
    assert {path.name: path.read_text() for path in tmp_path.glob("a*")} == {
        "a.log": "new" * 9,
        "a.log.1": "old",
    }
    assert (tmp_path / "b.log.2").read_text() == "old", "the others are rotated"
    assert "a.log cannot be rotated and keeps growing" in capsys.readouterr().out


@pytest.fixture(autouse=True)
def _nothing_bound():
    yield
    logs._process.clear()
