"""A run goes on when its scheduler dies, at whatever moment."""

import time
from dataclasses import dataclass, field

import numpy as np
import pytest

from microcosmos.cluster import devices, dispatch
from microcosmos.cluster.dispatch import Answer, Dispatcher, Work
from microcosmos.cluster.scheduler import configured
from microcosmos.search import never


def answered(work):
    return Answer(np.float32(2 * work.items), 0.01)


@dataclass(eq=False)
class Own:
    """A device of this process, which computes at once."""

    name: str = "own"
    capacity: int = 1
    given: list = field(default_factory=list)

    def submit(self, work):
        self.given.append(work.items)
        return Done(answered(work))

    def fail(self, error):
        raise error


@dataclass
class Done:
    answer: Answer

    def add_done_callback(self, fn):
        fn(self)

    def result(self):
        return self.answer

    def cancel(self): ...


@pytest.fixture
def cluster():
    """A scheduler and a helper, in threads of this process."""
    made = configured().LocalCluster(
        n_workers=1,
        threads_per_worker=1,
        processes=False,
        protocol="tcp://",
        dashboard_address=None,
    )
    yield made
    made.close()


@pytest.fixture
def connection(cluster, monkeypatch):
    monkeypatch.setattr(devices, "compute", answered)
    monkeypatch.setattr(devices, "refusal", lambda *given: None)
    monkeypatch.setattr(devices, "POLL_SECONDS", 0.05)
    # On a busy machine no block is late, so that none is computed twice.
    monkeypatch.setattr(dispatch, "LATE", 1e9)
    # Dask calls the scheduler again for so long, then its client ends.
    monkeypatch.setattr(devices, "CONNECT_SECONDS", 1.0)
    made = devices.Connection(cluster.scheduler_address, None, "{}", "cpu", "run")
    yield made
    made.close()


def test_the_death_of_the_scheduler_between_generations_ends_no_run(cluster, connection):
    own = Own()
    dispatcher = Dispatcher(lambda: [own, *connection.helpers()])

    def generation():
        found = dispatcher.compute([Work("{}", "p", float(i)) for i in range(6)], never)
        assert [float(one) for one in found] == [2.0 * i for i in range(6)]

    until = time.monotonic() + 20
    while not connection.helpers():
        assert time.monotonic() < until
        time.sleep(0.02)
    generation()
    assert len(own.given) < 6  # The helper computed too.
    cluster.close()
    until = time.monotonic() + 3
    while time.monotonic() < until:
        generation()
        time.sleep(0.02)
    assert not connection.helpers()
