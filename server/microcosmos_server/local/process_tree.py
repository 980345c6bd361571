"""A tree of processes in the foreground: restarted when they die, and ended together."""

import signal
import time
from collections.abc import Callable
from contextlib import suppress
from subprocess import Popen, SubprocessError
from types import FrameType

from ..core.processes import exit_reason, signal_group

BACKOFF, LONGEST_BACKOFF = 0.5, 30.0
STABLE_SECONDS = 60.0
"""Seconds of life after which the delay of a restart is the shortest again."""
GRACE = 25.0
"""Seconds that processes have to end; workers checkpoint meanwhile."""
POLL_SECONDS = 0.05
UPKEEP_SECONDS = 5.0
"""Seconds between two calls of a tree's upkeep."""

Start = Callable[[], Popen[bytes]]


def say(subject: str, text: str) -> None:
    with suppress(OSError):  # The terminal may be gone.
        print(f"{subject:<10} {text}", flush=True)


class Child:
    """A process that is restarted when it dies, with increasing delays."""

    def __init__(self, name: str, start: Start):
        self.name = name
        self._start = start
        self._delay = BACKOFF
        self._due: float | None = None
        self._begin()

    def _begin(self) -> None:
        self.process = self._start()
        self._started = time.monotonic()

    def restart_if_dead(self) -> None:
        """Restart a dead process when its delay is over."""
        code, now = self.process.poll(), time.monotonic()
        if code is None:
            return
        if self._due is None:
            self._delay = BACKOFF if now - self._started > STABLE_SECONDS else self._delay
            self._due = now + self._delay
            say(self.name, f"{exit_reason(code)}; restarting it in {self._delay:g} s")
        elif now >= self._due:
            self._delay = min(2 * self._delay, LONGEST_BACKOFF)
            try:
                self._begin()
                self._due = None
            except (OSError, SubprocessError) as error:  # The machine may lack memory.
                self._due = now + self._delay
                say(self.name, f"cannot start: {error}; trying again in {self._delay:g} s")

    def signal(self, sent: signal.Signals) -> None:
        signal_group(self.process, sent)

    def ended(self) -> bool:
        return self.process.poll() is not None


class Tree:
    """`children`, and the `services` that they depend on; services end last."""

    def __init__(self) -> None:
        self.services: list[Child] = []
        self.children: list[Child] = []
        self.upkeep: Callable[[], None] = lambda: None
        self._requests = 0

    def handle_signals(self) -> None:
        """End on SIGINT, SIGTERM or the terminal's end; the second signal ends at once."""
        signal.signal(signal.SIGINT, self._request)
        signal.signal(signal.SIGTERM, self._request)
        if signal.getsignal(signal.SIGHUP) != signal.SIG_IGN:  # Respect nohup.
            signal.signal(signal.SIGHUP, self._request)

    def _request(self, signum: int, frame: FrameType | None) -> None:
        self._requests += 1

    @property
    def stop_requested(self) -> bool:
        return self._requests > 0

    def watch(self, enough: Callable[[], bool] = lambda: False) -> None:
        """Restart dead processes until it is enough or a signal requests to stop."""
        due = 0.0
        while not (self.stop_requested or enough()):
            for child in (*self.services, *self.children):
                child.restart_if_dead()
            if time.monotonic() >= due:
                self.upkeep()
                due = time.monotonic() + UPKEEP_SECONDS
            time.sleep(POLL_SECONDS)

    def end(self) -> None:
        """Ask all processes to end, wait, and kill the rest."""
        for group in (self.children, self.services):
            for child in group:
                child.signal(signal.SIGTERM)
            deadline = time.monotonic() + GRACE
            while self._requests < 2 and time.monotonic() < deadline:
                if all(child.ended() for child in group):
                    break
                time.sleep(POLL_SECONDS)
            for child in group:
                child.signal(signal.SIGKILL)
