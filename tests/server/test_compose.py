"""The names in docker-compose.yml and the Dockerfiles exist and fit together.

Images are not built here: this keeps the words in them from going stale.
"""

import asyncio
import importlib.util
import os
import re
import signal
import tomllib
from contextlib import suppress
from itertools import pairwise
from pathlib import Path
from subprocess import Popen
from typing import Any
from unittest.mock import MagicMock

import pytest
import yaml
from packaging.specifiers import SpecifierSet
from redis import Redis
from redis.backoff import ConstantBackoff
from redis.retry import Retry
from setting_names import setting_names
from sqlalchemy.exc import OperationalError
from uvicorn.middleware.proxy_headers import ProxyHeadersMiddleware

from microcosmos_server.local.redis_embedded import find_binary, free_port
from microcosmos_server.main import SHUTDOWN_SECONDS
from microcosmos_server.maintenance.healthcheck import KILL_AFTER, PARTS, TERMINATE_AFTER
from microcosmos_server.tables.migrations import __main__ as migrate
from microcosmos_worker.supervisor import STOP_SECONDS

ROOT = Path(__file__).parents[2]
HEALTH = "microcosmos_server.maintenance.healthcheck"
OURS = ("microcosmos-server", "microcosmos-worker", "microcosmos-worker-cuda")
OTHERS = {"JAX_PLATFORMS", "JAX_COMPILATION_CACHE_DIR", "FORWARDED_ALLOW_IPS"}
OTHERS |= {"AWS_ENDPOINT_URL", "AWS_ACCESS_KEY_ID", "AWS_SECRET_ACCESS_KEY"}  # Of botocore.
OF_PYTHON = {"PYTHONUNBUFFERED", "PYTHONDONTWRITEBYTECODE", "PYTHONPATH"}


@pytest.fixture(scope="module")
def compose():
    return yaml.safe_load((ROOT / "docker-compose.yml").read_text())


@pytest.fixture(scope="module")
def services(compose):
    return compose["services"]


@pytest.fixture(scope="module")
def ours(services):
    return {name: one for name, one in services.items() if one["image"] in OURS}


def dockerfiles():
    return sorted((ROOT / "docker").glob("*.Dockerfile"))


def instructions(path):
    """Each as its word and the rest, comments and line ends taken out."""
    text = re.sub(r"\\\n", " ", path.read_text())
    lines = [line for line in text.splitlines() if line and not line.startswith("#")]
    return [tuple(line.split(maxsplit=1)) for line in lines]


def seconds(text):
    number, unit = re.fullmatch(r"(\d+)(s|m)", text).groups()
    return int(number) * {"s": 1, "m": 60}[unit]


def started(service):
    """The modules that its command and its health check start."""
    words = [*service["command"], *service.get("healthcheck", {}).get("test", ())]
    return {word for before, word in pairwise(words) if before == "-m"}


def test_every_module_that_is_started_exists(ours):
    modules = {module for one in ours.values() for module in started(one)}
    assert {
        "microcosmos_server.main",
        "microcosmos_server.tables.migrations",
        "microcosmos_worker.supervisor",
        HEALTH,
    } <= modules
    for name in modules:
        spec = importlib.util.find_spec(name)
        assert spec, name
        if spec.submodule_search_locations:
            assert importlib.util.find_spec(f"{name}.__main__"), name


def test_every_variable_is_one_that_is_read(ours):
    for name, one in ours.items():
        assert set(one["environment"]) <= setting_names() | OTHERS, name
    for path in dockerfiles():
        given = " ".join(rest for word, rest in instructions(path) if word == "ENV")
        names = {pair.partition("=")[0] for pair in given.split()}
        assert names <= setting_names() | OTHERS | OF_PYTHON, path


def test_every_secret_has_a_place_in_the_example_and_no_default(compose):
    text = (ROOT / "docker-compose.yml").read_text()
    example = dict(
        line.split("=", 1)
        for line in (ROOT / "docker" / "example.env").read_text().splitlines()
        if line and not line.startswith("#")
    )
    needed = set(re.findall(r"\$\{(\w+):\?", text))
    assert needed == {name for name, value in example.items() if not value}
    optional = set(re.findall(r"\$\{(\w+):-", text))
    assert optional <= example.keys()
    profiles = {p for one in compose["services"].values() for p in one.get("profiles", ())}
    assert set(example["COMPOSE_PROFILES"].split(",")) <= profiles


def test_every_service_has_its_own_health_check(services, ours):
    assert {name for name, one in services.items() if "healthcheck" not in one} == {"migrate"}
    for name in ours.keys() - {"migrate"}:
        *_, module, part, restart = ours[name]["healthcheck"]["test"]
        assert (module, restart) == (HEALTH, "--restart"), name
        assert part in PARTS
        assert name.startswith(part)


def test_an_unhealthy_container_is_restarted_after_its_start_period(ours):
    """Docker marks containers as unhealthy and does no more."""
    for name in ours.keys() - {"migrate"}:
        assert ours[name]["restart"] == "unless-stopped", name
        assert ours[name]["init"] is True, "signals reach the program through it"
        check = ours[name]["healthcheck"]
        assert seconds(check["start_period"]) < TERMINATE_AFTER, name
        assert seconds(check["interval"]) < KILL_AFTER - TERMINATE_AFTER, name
        grace = seconds(ours[name].get("stop_grace_period", "10s"))
        assert grace < KILL_AFTER - TERMINATE_AFTER, name


def test_a_database_is_ready_once_it_listens_to_others(services):
    """PostgreSQL answers on its socket alone while it creates its files, and then restarts."""
    assert "pg_isready -h 127.0.0.1" in services["postgres"]["healthcheck"]["test"][1]


def test_migrations_are_tried_again(ours, monkeypatch, capsys):
    assert ours["migrate"]["restart"] == "on-failure:5"
    asked = iter([OperationalError("", {}, Exception("starting up")), None])

    def upgrade(_):
        if error := next(asked):
            raise error

    monkeypatch.setattr(migrate, "upgrade", upgrade)
    monkeypatch.setattr(migrate, "RETRY_SECONDS", 0)
    monkeypatch.setattr(migrate, "connect", MagicMock())
    migrate.main()
    assert "does not answer yet: starting up" in capsys.readouterr().out
    asked = iter([OperationalError("", {}, Exception("gone"))])
    monkeypatch.setattr(migrate, "WAIT_SECONDS", -1)
    with pytest.raises(SystemExit, match="The database does not answer: gone"):
        migrate.main()


def test_our_containers_have_few_rights_and_wait_for_others(ours):
    for name, one in ours.items():
        assert one["read_only"] is True, name
        assert one["cap_drop"] == ["ALL"], name
        waits = one["depends_on"]
        conditions = {"migrate": "service_completed_successfully", "valkey": "service_healthy"}
        if name == "migrate":
            conditions = {"postgres": "service_healthy"}
        assert {other: how["condition"] for other, how in waits.items()} == conditions, name


def test_containers_have_longer_to_stop_than_their_programs(ours):
    for name, one in ours.items():
        if "microcosmos_worker.supervisor" in one["command"]:
            assert seconds(one["stop_grace_period"]) >= STOP_SECONDS + 15, name
    assert seconds(ours["server"]["stop_grace_period"]) > SHUTDOWN_SECONDS


def test_only_the_server_has_a_port_on_loopback(services):
    assert {name for name, one in services.items() if "ports" in one} == {"server"}
    assert all(port.startswith("127.0.0.1:") for port in services["server"]["ports"])


def test_a_local_proxy_names_the_client(services):
    """Otherwise all clients share one rate limit, and cookies lack `Secure`."""
    received: dict[str, Any] = {}

    async def app(scope, receive, send):
        received.update(scope)

    forwarded = {"x-forwarded-for": "10.0.0.7, 203.0.113.5", "x-forwarded-proto": "https"}
    headers = [(name.encode(), value.encode()) for name, value in forwarded.items()]
    scope = {"type": "http", "scheme": "http", "client": ("172.18.0.1", 1), "headers": headers}
    trusted = services["server"]["environment"]["FORWARDED_ALLOW_IPS"]
    asyncio.run(ProxyHeadersMiddleware(app, trusted)(scope, None, None))
    # The client may have claimed the first address; the proxy added the second.
    assert (received["client"][0], received["scheme"]) == ("203.0.113.5", "https")


def test_files_copied_into_images_exist_and_are_not_ignored(services):
    kept = (ROOT / ".dockerignore").read_text().split("\n")
    for path in dockerfiles():
        for word, rest in instructions(path):
            if word != "COPY" or "--from" in rest:
                continue
            for source in rest.split()[:-1]:
                name = source.replace("${LOCK}", "requirements.lock").rstrip("/")
                assert (ROOT / name).exists(), f"{path.name}: {name}"
                assert any(f"!{part}" in kept for part in (name, name.split("/")[0])), name
    for one in services.values():
        if isinstance(built := one.get("build"), dict):
            assert (ROOT / built["dockerfile"]).is_file()
            assert (ROOT / built.get("args", {}).get("LOCK", "requirements.lock")).is_file()


def test_valkey_takes_its_password_from_a_pipe_and_ends_on_sigterm(services, tmp_path):
    """Docker tells the first process: a shell before it would not hand that on."""
    (tmp_path / "valkey-server").symlink_to(find_binary())
    port, password = free_port(), "abc123"
    *shell, script = services["valkey"]["command"]
    script = script.replace("$$", "$").replace("dir /data", f"dir {tmp_path}\nport {port}")
    environment = {"PATH": f"{tmp_path}:{os.environ['PATH']}", "VALKEY_PASSWORD": password}
    with (tmp_path / "log").open("w") as log:
        started = Popen([*shell, script], env=environment, stdout=log, process_group=0)
    try:
        retry = Retry(ConstantBackoff(0.1), 100)
        with Redis(port=port, password=password, retry=retry) as client:
            assert client.config_get("appendonly") == {"appendonly": "yes"}
        started.terminate()
        assert started.wait(20) == 0, (tmp_path / "log").read_text()
    finally:
        with suppress(ProcessLookupError):
            os.killpg(started.pid, signal.SIGKILL)


def test_images_run_as_an_unprivileged_user_with_locked_packages():
    python = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["requires-python"]
    for path in dockerfiles():
        words = instructions(path)
        assert [rest for word, rest in words if word == "USER"] == ["microcosmos"]
        installs = [rest for word, rest in words if word == "RUN" and "pip install" in rest]
        # The kernel's wheel was built in a stage before, with packages of the lock file.
        assert installs
        ours = [one for one in installs if "--require-hashes" not in one]
        assert all(one.endswith("--no-index --no-deps /wheels/*.whl") for one in ours)
        base = next(r for word, r in words if word == "FROM" and r.startswith("python"))
        assert re.match(r"python:([\d.]+)", base)[1] in SpecifierSet(python)
    server = (ROOT / "docker" / "server.Dockerfile").read_text()
    assert "npm ci" in server
    assert re.findall(r"requirements\S*\.lock", server)[0] == "requirements-server.lock"
