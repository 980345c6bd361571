"""A tree of processes in the foreground: kept running, and ended together."""

import os
import signal
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from subprocess import Popen
from types import FrameType

from ..core.processes import ending

BACKOFF, LONGEST_BACKOFF, STEADY = 0.5, 30.0, 60.0
GRACE = 25.0
"""Seconds that processes have to end by themselves; workers checkpoint meanwhile."""
LOOK = 0.05

Start = Callable[[], Popen[bytes]]


def say(subject: str, text: str) -> None:
    with suppress(OSError):  # Nobody may be reading any more, which is no reason to fall over.
        print(f"{subject:<10} {text}", flush=True)


class Child:
    """A process that is started again when it dies, ever more slowly."""

    def __init__(self, name: str, start: Start):
        self.name = name
        self._start = start
        self._delay = BACKOFF
        self._due: float | None = None
        self._begin()

    def _begin(self) -> None:
        self.process = self._start()
        self._started = time.monotonic()

    def revive(self) -> None:
        """Where it died, start it again after a delay."""
        code, now = self.process.poll(), time.monotonic()
        if code is None:
            return
        if self._due is None:
            self._delay = BACKOFF if now - self._started > STEADY else self._delay
            self._due = now + self._delay
            say(
                self.name,
                f"died ({ending(code)}); starting it again in {self._delay:g} s",
            )
        elif now >= self._due:
            self._due, self._delay = None, min(2 * self._delay, LONGEST_BACKOFF)
            self._begin()

    def signal(self, sent: signal.Signals) -> None:
        if not self.ended():
            os.killpg(self.process.pid, sent)

    def ended(self) -> bool:
        return self.process.poll() is not None


class Tree:
    """Processes, and the ones that these stand on, which end last."""

    def __init__(self) -> None:
        self.ground: list[Child] = []
        self.children: list[Child] = []
        self._asked = 0

    def listen(self) -> None:
        """Take SIGINT, SIGTERM and the terminal's end as the wish to end; twice means now."""
        signal.signal(signal.SIGINT, self._ask)
        signal.signal(signal.SIGTERM, self._ask)
        if signal.getsignal(signal.SIGHUP) != signal.SIG_IGN:  # nohup means what it says.
            signal.signal(signal.SIGHUP, self._ask)

    def _ask(self, signum: int, frame: FrameType | None) -> None:
        self._asked += 1

    @property
    def asked(self) -> bool:
        """Whether somebody wants it to end."""
        return self._asked > 0

    def watch(self, enough: Callable[[], bool] = lambda: False) -> None:
        """Keep all of them running until it is enough or somebody wants it to end."""
        while not (self.asked or enough()):
            for child in (*self.ground, *self.children):
                child.revive()
            time.sleep(LOOK)

    def end(self) -> None:
        """Ask all to end, wait for them, and kill what is left."""
        for group in (self.children, self.ground):
            for child in group:
                child.signal(signal.SIGTERM)
            self._await(group)
            for child in group:
                child.signal(signal.SIGKILL)

    def _await(self, group: Sequence[Child]) -> None:
        deadline = time.monotonic() + GRACE
        while self._asked < 2 and time.monotonic() < deadline:
            if all(child.ended() for child in group):
                return
            time.sleep(LOOK)
