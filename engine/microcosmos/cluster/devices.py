"""The devices of a run over many hosts: those of this process, and all helpers."""

import time
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any
from uuid import uuid4

import jax

from .. import search
from ..experiments import Experiment
from ..experiments.evolution import Evolution
from .block import Answer, Work, timed
from .connection import Connection
from .dispatch import Device, Dispatcher


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
    of what the blocks took.
    """

    def __init__(
        self, experiment: Evolution, url: str, certificate: Path | None, own: bool = True
    ):
        programs = experiment.block_programs()
        self._names = {id(program): name for name, program in programs.items()}
        self._spec = experiment.plan.spec
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
        """Return the number of devices, and device seconds that counted over those there were.

        What there were includes the time in which offspring are made and inserted.
        """
        self._listed()
        used, there = self._dispatcher.seconds - self._before, self._available
        self._before, self._available = self._dispatcher.seconds, 0.0
        efficiency = {"cluster: efficiency": used / there} if there else {}
        return {"cluster: devices": self._count} | efficiency

    def close(self) -> None:
        self._connection.close()
        for device in self._own:
            device.close()

    def _listed(self) -> list[Device]:
        now = time.monotonic()
        self._available += self._count * (now - self._since)
        found: list[Device] = [*self._own, *self._connection.helpers()]
        self._since, self._count = now, len(found)
        return found


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
