"""Join a cluster with all devices of this machine: one helper process for each."""

import logging
import os
import platform
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from ..device import cores
from ..doctor.machine import PATIENCE, probed

POLL_SECONDS = 0.2
LIVED_SECONDS = 60.0
"""A helper that ends sooner counts as failed to start."""
ATTEMPTS = 5
"""Consecutive failures to start after which a helper is given up."""

log = logging.getLogger(__name__)


@dataclass
class Process:
    """The process of one device."""

    name: str
    command: Sequence[str]
    environment: dict[str, str]
    core: int | None
    failures: int = 0
    started: float = 0.0
    due: float | None = None
    """Time at which it starts again, once it has died."""
    running: subprocess.Popen | None = field(default=None, repr=False)

    def start(self) -> None:
        self.started, self.due = time.monotonic(), None
        self.running = subprocess.Popen(
            self.command, stdin=subprocess.PIPE, env=os.environ | self.environment
        )
        if self.core is not None and hasattr(os, "sched_setaffinity"):
            os.sched_setaffinity(self.running.pid, {self.core})

    def has_given_up(self) -> bool:
        """Start the process again a while after it died; return True after too many failures.

        It never waits: the caller looks for signals.
        """
        if self.running is None or self.running.poll() is None:
            return self.running is None
        now = time.monotonic()
        if self.due is None:
            self.failures = self.failures + 1 if now - self.started < LIVED_SECONDS else 0
            if self.failures >= ATTEMPTS:
                log.error("%s does not start: it stays away", self.name)
                self.running = None
                return True
            pause = 2.0**self.failures
            text = "%s has ended with %s: it starts again in %.0f s"
            log.warning(text, self.name, self.running.returncode, pause)
            self.due = now + pause
        elif now >= self.due:
            self.start()
        return False


def join(url: str, options: Sequence[str], cache: Path, processes: int | None = None) -> bool:
    """Run one helper a device until a signal; return False if none could go on.

    `options` are those of `helper`. A GPU is a device, and without any each core is. Raises
    `RuntimeError` if JAX fails, and `ValueError` for more processes than GPUs.
    """
    started = [
        Process(
            name, [*_command(url, name), *options, "--cache", str(cache)], environment, core
        )
        for name, environment, core in _devices(cache, processes)
    ]
    stopped: list[int] = []
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda number, _: stopped.append(number))
    for process in started:
        process.start()
    try:
        while not stopped:
            if all([process.has_given_up() for process in started]):
                return False
            time.sleep(POLL_SECONDS)
        return True
    finally:
        _end([one.running for one in started if one.running])


def _command(url: str, name: str) -> list[str]:
    return [sys.executable, "-m", "microcosmos.cluster.helper", url, name]


def _devices(
    cache: Path, processes: int | None
) -> Iterator[tuple[str, dict[str, str], int | None]]:
    """Yield a name, an environment and a core for each helper."""
    cache.mkdir(parents=True, exist_ok=True)
    # In a process of its own, which ends: JAX keeps a GPU's memory as long as it runs.
    devices = probed(cache, PATIENCE)["devices"]
    on_gpu = devices[0]["platform"] != "cpu"
    host, process = platform.node(), os.getpid()
    if not on_gpu:
        usable = sorted(getattr(os, "sched_getaffinity", lambda _: range(cores()))(0))
        for number in range(processes or len(usable)):
            name = f"{host} core {number} ({process})"
            yield name, {}, usable[number % len(usable)]
        return
    given = os.environ.get("CUDA_VISIBLE_DEVICES")
    visible = given.split(",") if given else [str(one["id"]) for one in devices]
    if processes and processes > len(visible):
        raise ValueError(
            f"--processes must be at most {len(visible)}, the number of GPUs; got {processes}"
        )
    for number in visible[: processes or len(visible)]:
        yield f"{host} GPU {number} ({process})", {"CUDA_VISIBLE_DEVICES": number}, None


def _end(running: Sequence[subprocess.Popen], patience: float = 10.0) -> None:
    for process in running:
        process.terminate()
    until = time.monotonic() + patience
    for process in running:
        try:
            process.wait(max(0.0, until - time.monotonic()))
        except subprocess.TimeoutExpired:
            process.kill()


SBATCH = """\
#!/bin/bash
# Helpers of a Microcosmos cluster: one task a node, and in it one process a GPU or core.
# They may start at any time and end at any time: a run goes on without them.
#SBATCH --job-name=microcosmos-helpers
#SBATCH --nodes=2
#SBATCH --ntasks-per-node=1
#SBATCH --exclusive
#SBATCH --time=24:00:00
#SBATCH --signal=TERM@60
{comment}#SBATCH --gpus-per-node=1
srun {command}
"""


def sbatch(command: str, gpus: bool) -> str:
    """Return the text of a SLURM batch file that starts a command on two nodes."""
    return SBATCH.format(command=command, comment="" if gpus else "#")
