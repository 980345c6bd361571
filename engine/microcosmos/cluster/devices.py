"""The devices of a run over many hosts: those of this process, and helpers by a scheduler."""

import logging
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import CancelledError, Future, ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import replace
from itertools import count
from pathlib import Path
from typing import Any
from uuid import uuid4

import jax

from .. import search
from ..experiments import Experiment
from ..experiments.evolution import Evolution
from ..optional import require
from .dispatch import Answer, Device, Dispatcher, Pending, Work, compute, refusal, timed
from .scheduler import PACKAGE, security

POLL_SECONDS = 0.5
"""Time between two checks for helpers that have joined or left."""
CONNECT_SECONDS = 10.0
"""Longest time for an answer of the scheduler."""
CLOSE_SECONDS = 5.0
"""Longest time for the end of a connection, which needs the scheduler's answer."""
RETRY_SECONDS = 2.0
"""Time before a scheduler that did not answer is called again."""

log = logging.getLogger(__name__)


class Asked:
    """A task of a helper; a `dispatch.Pending` that never waits for a lost connection."""

    def __init__(self, future: Any):
        self._future = future

    def add_done_callback(self, fn: Callable[[Any], object]) -> None:
        self._future.add_done_callback(lambda _: fn(self))

    def result(self) -> Any:
        # Dask would ask its loop, which a client that closes may have stopped.
        if self._future.cancelled():
            raise CancelledError("the connection is lost, or the helper has left")
        return self._future.result()

    def cancel(self) -> None:
        # `Future.cancel` would ask the loop too. Dask cancels what nobody waits for.
        self._future.release()


class Helper:
    """A process elsewhere that computes blocks; a `dispatch.Device`."""

    capacity = 2

    def __init__(self, client: Any, address: str, name: str, run: str):
        self.address, self.name = address, name
        self.fits = False
        """True once it has said that it can compute the run, until it fails at a block."""
        self._client, self._run, self._numbers = client, run, count()

    def ask(self, function: Any, *arguments: Any) -> Pending:
        # Keys have to differ, or Dask would return an earlier result.
        key = f"{function.__name__}-{self._run}-{self.name}-{next(self._numbers)}"
        return Asked(
            self._client.submit(
                function, *arguments, key=key, workers=[self.address], pure=False
            )
        )

    def is_there(self) -> bool:
        """Return whether it fits, and a scheduler would bring it a block."""
        return self.fits and self._client.status == "running"

    def submit(self, work: Work) -> Pending:
        return self.ask(compute, work)

    def fail(self, error: BaseException) -> None:
        self.fits = False
        text = "%s computes no more blocks of this run: %s: %s"
        log.warning(text, self.name, type(error).__name__, error)


class Connection:
    """Keeps a connection with a scheduler, and asks each helper whether it fits the run."""

    def __init__(self, url: str, certificate: Path | None, spec: str, device: str, run: str):
        """Raise `ValueError` for an address that may not be used."""
        self._security = security(url, certificate)
        self._url, self._spec, self._device, self._run = url, spec, device, run
        self._asked: dict[str, Helper] = {}
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._keep, daemon=True, name="cluster")
        self._thread.start()

    def helpers(self) -> Sequence[Helper]:
        """Return the helpers that compute for the run now."""
        return [one for one in list(self._asked.values()) if one.is_there()]

    def close(self) -> None:
        self._ended.set()
        # Not for longer: a worker that has to stop has yet to write its checkpoint.
        self._thread.join(CLOSE_SECONDS)

    def _keep(self) -> None:
        distributed, away = require("distributed", PACKAGE), False
        while not self._ended.is_set():
            try:
                with distributed.Client(
                    self._url,
                    security=self._security,
                    timeout=CONNECT_SECONDS,
                    set_as_default=False,
                    name=f"microcosmos {self._run}",
                ) as client:
                    log.info("Connected with the scheduler at %s", self._url)
                    away = False
                    self._watch(client)
            except Exception as error:  # Dask may raise anything; the run goes on.
                if not away:  # Once, however long it lasts.
                    text = "The scheduler at %s does not answer; it is called again: %s"
                    log.warning(text, self._url, error)
                away = True
            self._asked = {}
            self._ended.wait(RETRY_SECONDS)

    def _watch(self, client: Any) -> None:
        """List helpers until the run ends or the connection is lost."""
        while client.status == "running" and not self._ended.wait(POLL_SECONDS):
            # `scheduler_info` is for a moment empty whenever a worker leaves.
            workers = client.sync(client.scheduler.identity, n_workers=-1)["workers"]
            for address, worker in workers.items():
                if address not in self._asked:
                    self._ask(client, Helper(client, address, str(worker["id"]), self._run))
            for address in [one for one in self._asked if one not in workers]:
                log.info("%s has left", self._asked.pop(address).name)

    def _ask(self, client: Any, helper: Helper) -> None:
        """Ask a helper whether it fits; until it answers it gets nothing."""
        self._asked[helper.address] = helper
        pending = helper.ask(refusal, self._spec, self._device)

        def answered(pending: Any) -> None:
            try:
                problem = pending.result()
            except BaseException as error:  # It has left, or the connection is lost.
                problem = f"{type(error).__name__}: {error}"
            if problem:
                log.warning("%s gets no blocks of this run: %s", helper.name, problem)
            else:
                log.info("%s computes for this run", helper.name)
            helper.fits = not problem

        pending.add_done_callback(answered)


class OwnDevice:
    """A device of the run's own process; a `dispatch.Device`."""

    capacity = 1

    def __init__(self, device: Any, programs: dict[str, Callable[..., Any]]):
        self.name = f"this process ({device.platform} {device.id})"
        self._device, self._programs = device, programs
        self._thread = ThreadPoolExecutor(max_workers=1, thread_name_prefix="block")

    def submit(self, work: Work) -> Future[Answer]:
        program = self._programs[work.program]
        return self._thread.submit(timed, program, work.items, self._device)

    def fail(self, error: BaseException) -> None:
        raise error

    def close(self) -> None:
        self._thread.shutdown(cancel_futures=True)


class ClusterDevices:
    """This process's devices and all helpers of a cluster; `search.Devices`.

    Without helpers, or while the scheduler is away, a run goes on here. Device seconds are sums
    of the blocks' times.
    """

    def __init__(
        self, experiment: Evolution, url: str, certificate: Path | None, own: bool = True
    ):
        programs = experiment.block_programs()
        self._names = {id(program): name for name, program in programs.items()}
        self._spec = experiment.facts.spec
        self._own = [OwnDevice(one, programs) for one in jax.local_devices()] if own else []
        self._connection = Connection(
            url, certificate, self._spec, experiment.device, uuid4().hex[:8]
        )
        self._dispatcher = Dispatcher(self._listed)
        self._available, self._since, self._count = 0.0, time.monotonic(), len(self._own)
        self._before = 0.0

    def evaluate(
        self,
        program: Callable[..., Any],
        items: Any,
        *,
        block: int,
        stop: Callable[[], bool] = search.never,
    ) -> Any:
        name = self._names[id(program)]
        works = [Work(self._spec, name, part) for part in search.blocks_of(items, block)]
        return search.joined(self._dispatcher.compute(works, stop), items)

    def seconds(self) -> float:
        return self._dispatcher.seconds

    def summary(self) -> dict[str, float]:
        """Return the number of devices, and the efficiency: device seconds used over available.

        The time in which offspring are made and inserted counts as available.
        """
        self._listed()
        used, available = self._dispatcher.seconds - self._before, self._available
        self._before, self._available = self._dispatcher.seconds, 0.0
        efficiency = {"cluster.efficiency": used / available} if available else {}
        return {"cluster.devices": self._count} | efficiency

    def close(self) -> None:
        self._connection.close()
        for device in self._own:
            device.close()

    def _listed(self) -> list[Device]:
        now = time.monotonic()
        self._available += self._count * (now - self._since)
        devices: list[Device] = [*self._own, *self._connection.helpers()]
        self._since, self._count = now, len(devices)
        return devices


@contextmanager
def over(
    experiment: Experiment, url: str, certificate: Path | None = None, *, own: bool = True
) -> Iterator[Experiment]:
    """Compute a search with the helpers of a cluster, and on own devices unless `own` is false.

    Raises `ValueError` for an address or certificate that may not be used, and for an
    experiment that is no search.
    """
    if not isinstance(experiment, Evolution):
        kind = type(experiment).__name__
        raise ValueError(f"a cluster computes searches with an archive, got a {kind}")
    devices = ClusterDevices(experiment, url, certificate, own)
    try:
        yield replace(experiment, devices=devices)
    finally:
        devices.close()
