"""Readiness of a worker: it must see its installation, and compute correctly."""

import json
import logging
import os
import time
from contextlib import suppress
from hashlib import sha256
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import NamedTuple

from microcosmos_server.core import processes
from microcosmos_server.services.services import Services
from microcosmos_server.storage import mark
from microcosmos_server.tables import ProblemKind, migrations

from .device import NO_DEVICE, Device

CHECK_SECONDS = 5.0
"""Seconds after which a good installation is checked again, a bad one each time."""
TEST_SECONDS = 300.0
"""Longest time for a self-test: a broken driver may hang it."""
RETEST_SECONDS = 60.0
"""Time after which a worker whose self-test has failed tests itself again."""
TRUST_SECONDS = 86_400.0
"""Seconds for which workers that start on the same device rely on an earlier self-test."""
BOOT = Path("/proc/sys/kernel/random/boot_id")
VARIABLES = (
    "MICROCOSMOS_KERNEL",
    "MICROCOSMOS_INSTRUCTION_SET",
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
    """A reason why a worker takes no run."""

    kind: ProblemKind
    text: str


class InstallationCheck:
    """Checks repeatedly the revision of the tables, and that the store is the installation's.

    `problem` says what is wrong.
    """

    def __init__(self, services: Services):
        self._services = services
        self._good_until = 0.0
        self.problem: Problem | None = None

    def is_good(self) -> bool:
        if time.monotonic() < self._good_until:
            return True
        found = self._find()
        if found != self.problem:
            place = self._services.artifacts.location
            text = found.text if found else "The installation is in order again"
            log.warning("%s (store: %s)", text, place)
        self.problem = found
        if found is None:
            self._good_until = time.monotonic() + CHECK_SECONDS
        return found is None

    def _find(self) -> Problem | None:
        if fault := migrations.fault(self._services.sessions):  # Before any table is read.
            return Problem("schema", fault)
        fault = mark.fault(self._services.sessions, self._services.artifacts)
        return Problem("store", fault) if fault else None


class Readiness:
    """Checks the installation repeatedly, and the device when needed."""

    def __init__(self, services: Services, device: Device):
        self._installation, self._device = InstallationCheck(services), device
        self._record = _record(services, device)
        self._test_at = 0.0
        self._device_problem: Problem | None = None
        self._database_problem: Problem | None = None
        self._database_retry_at = 0.0
        self.device_kinds: list[str] = []
        """Kinds of device whose results this one repeats; none before a self-test succeeds."""

    @property
    def problem(self) -> Problem | None:
        """Return the reason why the worker takes no run, if there is one."""
        untested = Problem("untested", "It tests itself before its first run")
        installation = self._database_problem or self._installation.problem
        return self._device_problem or (installation if self.device_kinds else untested)

    def check(self) -> bool:
        """Return True if the worker may take a run."""
        if time.monotonic() >= self._database_retry_at:
            self._database_problem = None
        # One that has failed has to succeed itself, whatever others on the device find.
        if not self.device_kinds and self._device_problem is None:
            self.device_kinds = _read(self._record)
        if not self.device_kinds and time.monotonic() >= self._test_at:
            self.test_device()
        good = self._database_problem is None and self._installation.is_good()
        return bool(self.device_kinds) and good

    def note_unclaimed(self) -> None:
        """Note that the process of a job could not use the database; wait before the next.

        A new process makes new connections and runs the code that is installed now, so it may
        fail where this one does not.
        """
        text = "The processes that it starts cannot use the database: its log says why"
        self._database_problem = Problem("database", text)
        self._database_retry_at = time.monotonic() + RETEST_SECONDS

    def test_device(self) -> bool:
        """Compute a few creatures whose numbers are known; return whether that succeeds.

        If it does not, the worker takes no run, and tests itself again from time to time.
        """
        with suppress(OSError):  # A read-only disk is no fault of the device.
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
    command = processes.python("microcosmos_worker.self_test", needed)
    try:
        test = processes.run(
            command,
            os.environ | device.environment,
            seconds=TEST_SECONDS,
            stop_requested=processes.stop_requested,
        )
    except processes.StoppedError:
        return [], Problem("untested", "the worker has to stop")
    except processes.TooLateError:
        text = f"it has no result after {TEST_SECONDS:g} s; a driver may hang"
        return [], Problem("self-test", text)
    try:
        said = json.loads(test.output.splitlines()[-1])
    except (IndexError, ValueError):  # A native crash prints nothing, a library perhaps last.
        said = None
    if test.code == 0 and isinstance(said, list):
        return said, None
    if test.code > 0 and isinstance(said, str):
        return [], Problem("device" if test.code == NO_DEVICE else "self-test", said)
    ended = processes.exit_reason(test.code)
    return [], Problem("self-test", f"it gave no result and {ended}")


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
