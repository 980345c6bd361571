"""Health checks tell the living from the dead."""

import socket
import subprocess
import sys

import pytest
from rq.serializers import JSONSerializer
from rq.worker import SimpleWorker

from server.workers import registry
from worker.health import alive, main

HOST = "somewhere"


def test_a_worker_is_alive_while_it_tells_of_itself(services):
    assert not alive(services, "worker", HOST)
    registry.report(services.sessions, f"{HOST}-17", "a device", 1, "idle")
    assert alive(services, "worker", HOST)
    assert not alive(services, "worker", "some")
    assert not alive(services, "renderer", HOST)
    patient = services.settings.lease
    object.__setattr__(services.settings, "lease", 0.0)
    assert not alive(services, "worker", HOST), "a lease without a word is over"
    object.__setattr__(services.settings, "lease", patient)
    registry.retire(services.sessions, f"{HOST}-17")
    assert not alive(services, "worker", HOST)


@pytest.mark.parametrize("part", ["renderer", "auditor"])
def test_who_renders_is_alive_from_its_birth_to_its_end(services, part):
    queue = services.jobs.renderings
    worker = SimpleWorker([queue], f"{part}-{HOST}-1", serializer=JSONSerializer)
    worker.register_birth()
    assert alive(services, part, HOST)
    assert not alive(services, part, "elsewhere")
    worker.register_death()
    services.redis.delete(worker.key)  # As Redis does when its time is over.
    assert not alive(services, part, HOST)


def test_nobody_heard_of_is_said_with_an_exit_status(services, settings, monkeypatch):
    monkeypatch.setenv("MICROCOSMOS_DATA", str(settings.data))
    monkeypatch.setenv("MICROCOSMOS_REDIS_URL", settings.redis_url)
    with pytest.raises(SystemExit, match=f"No worker on {socket.gethostname()} was heard of"):
        main(["worker"])
    with pytest.raises(SystemExit, match="One part is needed, of worker"):
        main(["server"])
    code = "import worker.health, sys; print('jax' in sys.modules)"
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert said.stdout.strip() == "False", said.stderr
