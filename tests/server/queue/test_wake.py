"""Idle workers are woken by messages, and look again without them."""

import threading
import time

from microcosmos_server.services.messages import Wake


def seconds(alarm, limit):
    began = time.monotonic()
    alarm.wait(limit)
    return time.monotonic() - began


def test_a_waiting_worker_is_woken_by_one_message_of_its_installation(services):
    alarm = services.wake.listen()
    alarm.wait(0.01)  # It subscribes.
    Wake(services.redis, "another:", services.events.messenger).send()
    assert seconds(alarm, 0.2) >= 0.2
    threading.Timer(0.1, services.wake.send).start()
    assert seconds(alarm, 30) < 20
    services.wake.send()
    services.wake.send()
    services.events.messenger.flush()
    assert seconds(alarm, 30) < 20
    assert seconds(alarm, 0.2) >= 0.2, "two messages ask for one look"
    alarm.close()
