"""Health checks: alive and dead parts, and the restart of failing containers."""

import os
import socket
import subprocess
import time
from dataclasses import replace

import psutil
import pytest
from rq.serializers import JSONSerializer
from rq.worker import SimpleWorker

from microcosmos_server.maintenance import healthcheck
from microcosmos_server.maintenance.healthcheck import alive, main
from microcosmos_server.workers import registry

HOST = "somewhere"


def test_a_worker_is_alive_while_it_reports(services):
    assert not alive(services, "worker", HOST)
    registry.report(services.sessions, f"{HOST}-17", "a device", 1, "idle")
    assert alive(services, "worker", HOST)
    assert not alive(services, "worker", "some")
    assert not alive(services, "renderer", HOST)
    impatient = services.settings.model_copy(update={"lease": 0.0})
    assert not alive(replace(services, settings=impatient), "worker", HOST), "the lease is over"
    registry.retire(services.sessions, f"{HOST}-17")
    assert not alive(services, "worker", HOST)


@pytest.mark.parametrize("part", ["renderer", "auditor"])
def test_a_renderer_is_alive_from_birth_to_death(services, part):
    queue = services.jobs.renderings
    worker = SimpleWorker([queue], f"{part}-{HOST}-1", serializer=JSONSerializer)
    worker.register_birth()
    assert alive(services, part, HOST)
    assert not alive(services, part, "elsewhere")
    worker.register_death()
    services.redis.delete(worker.key)  # As Redis does when its time is over.
    assert not alive(services, part, HOST)


def test_a_missing_part_gives_an_exit_status(services, monkeypatch):
    settings = services.settings
    monkeypatch.setenv("MICROCOSMOS_DATA", str(settings.data))
    monkeypatch.setenv("MICROCOSMOS_DATABASE_URL", settings.database_url)
    monkeypatch.setenv("MICROCOSMOS_REDIS_URL", settings.redis_url)
    with pytest.raises(SystemExit, match=f"No worker on {socket.gethostname()} has reported"):
        main(["worker"])
    for wrong in ([], ["nobody"], ["worker", "--twice"]):
        with pytest.raises(SystemExit, match="One part is needed, of server"):
            main(wrong)


@pytest.fixture
def container():
    """A first process with one program in it, which ignores that it is asked to end."""
    script = "(trap '' TERM; while :; do sleep 0.1; done) & wait"
    init = subprocess.Popen(["sh", "-c", script], stdout=subprocess.DEVNULL)
    while not (children := psutil.Process(init.pid).children()):
        time.sleep(0.02)
    yield init
    for process in filter(psutil.Process.is_running, children):
        process.kill()
    init.kill()
    init.wait()


def test_a_part_that_fails_for_minutes_is_terminated_then_killed_in_a_container_alone(
    container, monkeypatch, tmp_path
):
    mark = tmp_path / "fails"
    healthcheck.end_failing(mark, container.pid)
    assert not mark.exists(), "nothing is ended outside a container"
    monkeypatch.setattr(healthcheck, "INITS", ("sh",))
    (program,) = psutil.Process(container.pid).children()
    time.sleep(0.2)  # It has set its trap.
    healthcheck.end_failing(mark, container.pid)
    assert mark.exists(), "the first failure is remembered"

    def failing_for(seconds):
        os.utime(mark, (time.time() - seconds,) * 2)
        healthcheck.end_failing(mark, container.pid)

    failing_for(healthcheck.TERMINATE_AFTER - 5)
    failing_for(healthcheck.TERMINATE_AFTER + 5)
    time.sleep(0.2)
    assert program.is_running(), "asked, which it ignores"
    failing_for(healthcheck.KILL_AFTER + 5)
    assert container.wait(10) is not None, "the container ends with its program"


def test_a_part_without_its_database_or_redis_is_not_unhealthy(services, monkeypatch):
    settings = services.settings
    monkeypatch.setattr(healthcheck, "answers", lambda _: False)
    assert healthcheck.fault(settings, "server") == "The server does not answer."
    monkeypatch.setattr(healthcheck, "answers", lambda url: url.endswith("/healthz"))
    with pytest.raises(ConnectionError, match="cannot reach the database, Redis"):
        healthcheck.fault(settings, "server")
    lost = settings.model_copy(update={"redis_url": "redis://127.0.0.1:1/0"})
    with pytest.raises(ConnectionError, match="cannot be reached"):
        healthcheck.fault(lost, "renderer")
