"""Whether a worker may take runs: it must see its installation's store, and compute rightly."""

import json
import logging
import os
import subprocess
import sys
import time
from hashlib import sha256
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import NamedTuple

from server.services.services import Services
from server.storage import mark
from server.tables import ProblemKind

from .device import NO_DEVICE, Device
from .process_setup import stop_requested

CHECK_SECONDS = 5.0
"""Time for which a good store is taken to stay good. A bad one is read again at once."""
TEST_SECONDS = 300.0
"""Longest time for a self-test: a broken driver may hang it."""
RETEST_SECONDS = 60.0
"""Time after which a worker whose self-test has failed tests itself again."""
STOP_CHECK_SECONDS = 0.5
"""Longest time before a self-test notices that its worker has to stop."""
TRUST_SECONDS = 86_400.0
"""Time for which workers that start on the same device believe an earlier self-test."""
BOOT = Path("/proc/sys/kernel/random/boot_id")
VARIABLES = (
    "MICROCOSMOS_KERNEL",
    "XLA_FLAGS",
    "JAX_PLATFORMS",
    "CUDA_VISIBLE_DEVICES",
    "MICROCOSMOS_CLUSTER",
    "MICROCOSMOS_CLUSTER_CERTIFICATE",
)
"""Variables on which the result of a self-test depends, beside the device's own."""
SOFTWARE = ("microcosmos", "microcosmos-kernels", "jax", "jaxlib")

log = logging.getLogger(__name__)


class Problem(NamedTuple):
    """Why a worker takes no run."""

    kind: ProblemKind
    text: str


class StoreCheck:
    """Checks again and again that the store is the installation's, and says what is wrong."""

    def __init__(self, services: Services):
        self._services = services
        self._good_until = 0.0
        self.problem: str | None = None

    def is_good(self) -> bool:
        if time.monotonic() < self._good_until:
            return True
        fault = mark.fault(self._services.sessions, self._services.artifacts)
        if fault != self.problem:
            log.warning("%s", fault or "The store is the right one again")
        self.problem = fault
        if fault is None:
            self._good_until = time.monotonic() + CHECK_SECONDS
        return fault is None


class Readiness:
    """Checks the store again and again, and the device when it has to; says what is wrong."""

    def __init__(self, services: Services, device: Device):
        self._store, self._device = StoreCheck(services), device
        self._record = _record(services, device)
        self._test_at = 0.0
        self._device_problem: Problem | None = None
        self.device_kinds: list[str] = []
        """Kinds of device whose results this one repeats; none before a self-test succeeds."""

    @property
    def problem(self) -> Problem | None:
        """Why the worker takes no run, if that is so."""
        untested = Problem("untested", "It tests itself before its first run")
        store = self._store.problem and Problem("store", self._store.problem)
        return self._device_problem or (store if self.device_kinds else untested) or None

    def check(self) -> bool:
        """Return True if the worker may take a run."""
        if not self.device_kinds:
            self.device_kinds = _read(self._record)
        if not self.device_kinds and time.monotonic() >= self._test_at:
            self.test_device()
        return bool(self.device_kinds) and self._store.is_good()

    def test_device(self) -> bool:
        """Compute a few creatures whose numbers are known; return whether that succeeds.

        If it does not, the worker takes no run, and tests itself again from time to time.
        """
        self._record.unlink(missing_ok=True)
        self.device_kinds, found = _self_test(self._device)
        if found is None:
            log.info("Its self-test succeeds")
            _write(self._record, self.device_kinds)
        else:
            found = Problem(found.kind, f"Its self-test fails: {found.text}")
            log.warning("%s", found.text)
        self._device_problem = found
        self._test_at = time.monotonic() + RETEST_SECONDS
        return found is None


def _self_test(device: Device) -> tuple[list[str], Problem | None]:
    """Return the kinds of device, and what is wrong with it; None for a good one."""
    needed = "cpu" if device.gpu is None else "gpu"
    command = [sys.executable, "-m", "worker.self_test", needed, str(os.getpid())]
    test = subprocess.Popen(
        command,
        env={**os.environ, **device.environment},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        errors="replace",
    )
    deadline = time.monotonic() + TEST_SECONDS
    while True:
        try:
            output, errors = test.communicate(timeout=STOP_CHECK_SECONDS)
            break
        except subprocess.TimeoutExpired:
            stopped = stop_requested()
            if stopped or time.monotonic() > deadline:
                test.kill()
                test.communicate()
                late_words = f"it has no result after {TEST_SECONDS:g} s; a driver may hang"
                text = "the worker has to stop" if stopped else late_words
                return [], Problem("untested" if stopped else "self-test", text)
    if test.returncode == 0:
        return json.loads(output.splitlines()[-1]), None
    words = errors.strip().splitlines()
    text = words[-1][:300] if words else f"it ended with status {test.returncode}"
    return [], Problem("device" if test.returncode == NO_DEVICE else "self-test", text)


def _record(services: Services, device: Device) -> Path:
    """Return the file with the result of a self-test of this device since the machine began."""
    boot = BOOT.read_text() if BOOT.exists() else ""
    environment = {**os.environ, **device.environment}
    settings = [environment.get(name) for name in VARIABLES]
    on = [device.name, device.gpu, boot, *settings, *map(_version, SOFTWARE)]
    name = f"self-test-{sha256(json.dumps(on).encode()).hexdigest()[:16]}.json"
    cache = os.environ.get("JAX_COMPILATION_CACHE_DIR")
    return Path(cache or services.settings.data) / name


def _version(distribution: str) -> str | None:
    try:
        return version(distribution)
    except PackageNotFoundError:
        return None


def _read(record: Path) -> list[str]:
    """Return the kinds of device in a record; none if it is missing, damaged or old."""
    try:
        if time.time() - record.stat().st_mtime < TRUST_SECONDS:
            return list(json.loads(record.read_text()))
    except (OSError, ValueError):
        pass
    return []


def _write(record: Path, kinds: list[str]) -> None:
    """Write a record whole or not at all; without one the next worker tests itself, too."""
    part = record.with_name(f"{record.name}.{os.getpid()}")
    try:
        record.parent.mkdir(parents=True, exist_ok=True)
        part.write_text(json.dumps(kinds))
        part.replace(record)
    except OSError as error:
        log.warning("The self-test is not recorded: %s", error)
