"""The helpers of a run: who has joined, and which of them compute for it."""

import logging
import threading
from collections.abc import Sequence
from itertools import count
from pathlib import Path
from typing import Any

from ..optional import require
from .block import Work, compute, refusal
from .dispatch import Pending
from .security import PACKAGE, security

POLL_SECONDS = 0.5
"""Time between two looks at who has joined or left."""
CONNECT_SECONDS = 10.0
"""Longest time for an answer of the scheduler."""
RETRY_SECONDS = 2.0
"""Time before a scheduler that did not answer is called again."""

log = logging.getLogger(__name__)


class Helper:
    """A process elsewhere that computes blocks; a `dispatch.Device`."""

    capacity = 2

    def __init__(self, client: Any, address: str, name: str, run: str):
        self.address, self.name = address, name
        self.fits = False
        """Whether it has said that it can compute the run, and failed at no block."""
        self._client, self._run, self._numbers = client, run, count()

    def ask(self, function: Any, *arguments: Any) -> Pending:
        # Keys have to differ, or Dask would return an earlier result.
        key = f"{function.__name__}-{self._run}-{self.name}-{next(self._numbers)}"
        return self._client.submit(
            function, *arguments, key=key, workers=[self.address], pure=False
        )

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
        return [one for one in list(self._asked.values()) if one.fits]

    def close(self) -> None:
        self._ended.set()
        self._thread.join(2 * CONNECT_SECONDS)

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
            except (
                Exception
            ) as error:  # Whatever Dask raises, the run goes on, and calls again.
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
            found = client.sync(client.scheduler.identity, n_workers=-1)["workers"]
            for address, worker in found.items():
                if address not in self._asked:
                    self._ask(client, Helper(client, address, str(worker["id"]), self._run))
            for address in [one for one in self._asked if one not in found]:
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
