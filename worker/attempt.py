"""One attempt at a run: what is written down when, and when it has to stop."""

import logging
import math
import time
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import Any, TypeVar
from uuid import UUID

from sqlalchemy.exc import OperationalError

from microcosmos.archive.report import Report
from server.attempts.begin import claim
from server.attempts.claim import CheckpointUnavailable, Claim, ClaimLost
from server.services.services import Services
from server.settings import Settings
from server.tables import CANCELLED, PAUSED

from . import stop

LOOK_SECONDS = 1.0
"""At most so often the database is asked between two blocks."""
DATABASE_SECONDS = 600.0
"""How long a computed generation waits for a database that does not answer."""

T = TypeVar("T")
log = logging.getLogger(__name__)


@contextmanager
def claimed(services: Services, run_id: UUID, worker: str) -> Iterator["Attempt | None"]:
    """A run that is ours until the end of the block, or None where it is not to be had.

    What goes wrong inside is kept on the run; whoever lost it ends without a word.
    """
    held = claim(services, run_id, worker)
    try:
        yield Attempt(held) if held else None
    except ClaimLost as error:
        log.warning("Lost %s", error)
    except CheckpointUnavailable as error:
        log.error("Run %s: %s", run_id, error)
        if held:
            with suppress(ClaimLost):
                Attempt(held).set_aside(str(error))
    except Exception:
        log.exception("Run %s failed", run_id)
        if held:
            with suppress(ClaimLost):
                held.fail(traceback.format_exc())


class Attempt:
    """Records and checkpoints a run, and knows what the outside wants of it."""

    def __init__(self, held: Claim):
        self._claim = held
        self._requested_state: str | None = None
        self._looked = time.monotonic()
        # The first generation is saved at once: its file says where the cells of a CVT are.
        self._saved = time.monotonic() if held.generation else -math.inf

    @property
    def spec(self) -> dict[str, Any]:
        return self._claim.spec

    @property
    def settings(self) -> Settings:
        return self._claim.services.settings

    def use(self, device: str) -> None:
        """Say on which kind of device it is computed."""
        persist(lambda: self._claim.use(device))

    def restore(self) -> bytes | None:
        return persist(self._claim.restore)

    def initial(self) -> list[dict[str, Any]]:
        """The files of the creatures that the run begins from."""
        return persist(self._claim.initial)

    @property
    def other_device(self) -> bool:
        return self._claim.other_device

    def wait_for_override(self, reason: str) -> None:
        """Pause: on this kind of device bits may differ, which is for people to allow."""
        text = f"{reason} To go on here, resume the run; its archive will say so."
        persist(lambda: self._claim.wait_for_override(text))

    def set_aside(self, reason: str) -> None:
        """Pause: this worker lacks a plug-in or a file that people can bring back."""
        text = f"{reason}. Resume the run when this is mended."
        persist(lambda: self._claim.set_aside(text))

    def refuse(self, reason: str) -> None:
        """Fail at once: another attempt would come to the same."""
        persist(lambda: self._claim.refuse(reason))

    def interrupted(self) -> bool:
        """Whether to stop here; asked between blocks."""
        now = time.monotonic()
        if self._requested_state is None and now - self._looked >= LOOK_SECONDS:
            self._looked = now
            self._requested_state = persist(self._claim.requested)
        return self._requested_state is not None or stop.requested()

    def record(self, report: Report, seconds: float, save: Callable[[], bytes]) -> None:
        """Write down a generation that took so many seconds; checkpoint when it is due."""
        self._requested_state = persist(lambda: self._claim.record(report, seconds))
        if time.monotonic() - self._saved >= self._claim.services.settings.checkpoint_interval:
            self._checkpoint(report.generation, save)

    def end(self, done: bool, generation: int, save: Callable[[], bytes]) -> None:
        """Checkpoint the last whole generation and say how the run stands.

        Where the last checkpoint cannot be written the run waits, paused: resuming it does
        again what was not saved.
        """
        saved = generation == self._claim.generation or self._checkpoint(generation, save)
        if done and saved:
            persist(self._claim.finish)
        elif self._requested_state == CANCELLED:
            persist(self._claim.cancel)
        elif done or self._requested_state == PAUSED:
            persist(self._claim.pause)
        else:
            persist(self._claim.requeue)

    def _checkpoint(self, generation: int, save: Callable[[], bytes]) -> bool:
        """Whether it was written; if not the previous one stays and the run says why."""
        self._saved = time.monotonic()
        data = save()
        try:
            persist(lambda: self._claim.save(generation, data))
        except OSError as error:
            log.warning("No checkpoint of generation %s: %s", generation, error)
            text = (
                f"The checkpoint of generation {generation} could not be written ({error}); "
                f"the one of generation {self._claim.generation} stays, and it is tried again."
            )
            persist(lambda: self._claim.warn(text))
            return False
        return True


def persist(write: Callable[[], T]) -> T:
    """Write, waiting for a database that is away for a while; unless we are to stop."""
    deadline = time.monotonic() + DATABASE_SECONDS
    while True:
        try:
            return write()
        except OperationalError as error:
            if time.monotonic() > deadline or stop.requested():
                raise
            log.warning("Waiting for the database: %s", error)
            time.sleep(LOOK_SECONDS)
