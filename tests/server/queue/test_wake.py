"""Idle workers are woken by messages, and look again without them."""

import threading
import time

import pytest
from redis import Redis

from server.queue.wake import Wake


def seconds(alarm, limit):
    began = time.monotonic()
    alarm.wait(limit)
    return time.monotonic() - began


def test_a_waiting_worker_is_woken_by_one_message_of_its_installation(services):
    alarm = services.wake.listen()
    alarm.wait(0.01)  # It subscribes.
    Wake(services.redis, "another:").send()
    assert seconds(alarm, 0.2) >= 0.2
    threading.Timer(0.1, services.wake.send).start()
    assert seconds(alarm, 30) < 20
    services.wake.send()
    services.wake.send()
    assert seconds(alarm, 30) < 20
    assert seconds(alarm, 0.2) >= 0.2, "two messages ask for one look"
    alarm.close()


@pytest.mark.long
def test_a_worker_looks_again_while_redis_is_away():
    wake = Wake(Redis(port=1), "test:")
    wake.send()
    alarm = wake.listen()
    assert 0.1 <= seconds(alarm, 0.1) < 20
    assert 0.1 <= seconds(alarm, 0.1) < 20
