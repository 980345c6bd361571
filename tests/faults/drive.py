"""An installation of Microcosmos, driven over HTTP and by signals."""

import os
import signal
import socket
import sqlite3
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import closing, contextmanager, suppress
from pathlib import Path
from typing import Any

import httpx
import psutil

ROOT = Path(__file__).parents[2]
QUICK = {
    "JAX_PLATFORMS": "cpu",
    "JAX_COMPILATION_CACHE_DIR": str(ROOT / ".cache" / "jax"),
    "MICROCOSMOS_MIN_FREE_BYTES": "0",
    "XLA_FLAGS": "--xla_backend_optimization_level=0 --xla_cpu_use_fusion_emitters=false "
    "--xla_cpu_parallel_codegen_split_count=1",
}
"""Settings with which programs compile in a fifth of the time, and are cached."""
SHORT = QUICK | {
    "MICROCOSMOS_DEMONSTRATION": "0",
    "MICROCOSMOS_CHECKPOINT_INTERVAL": "0.2",
    "MICROCOSMOS_SEGMENT_BYTES": "256",  # Else columns of small runs fill none.
    "MICROCOSMOS_LEASE": "3",
    "MICROCOSMOS_RECONCILE_INTERVAL": "0.5",
}
"""Settings that shorten minutes to seconds."""
TERMINAL = ("finished", "failed", "cancelled")
SERVICES = ("MICROCOSMOS_REDIS_URL", "MICROCOSMOS_DATABASE_URL", "MICROCOSMOS_ARTIFACTS_URL")
"""Settings that an installation does not inherit."""
JOB, SUPERVISOR = "microcosmos_worker.job_process", "microcosmos_worker.supervisor"


def wait_until(
    condition: Callable[[], Any], seconds: float, what: str, every: float = 0.1
) -> Any:
    """Return the first true value of the condition, asked again `every` seconds."""
    deadline = time.monotonic() + seconds
    while not (found := condition()):
        if time.monotonic() > deadline:
            raise TimeoutError(f"waited {seconds:g} s in vain until {what}")
        time.sleep(every)
    return found


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Installation:
    """A product in a data folder; `environment` holds its settings, `port` that of one that
    another process has started."""

    def __init__(
        self, folder: Path, environment: dict[str, str], port: int | None = None
    ) -> None:
        self.folder, self.environment = folder, environment
        self.output = folder / "output.txt"
        self.port = port or free_port()
        self.url = f"http://127.0.0.1:{self.port}"
        self.http = httpx.Client(base_url=self.url, timeout=30)

    def start(self) -> None:
        self.folder.mkdir(parents=True, exist_ok=True)
        settings = {"MICROCOSMOS_DATA": str(self.folder), "PORT": str(self.port)}
        inherited = {name: value for name, value in os.environ.items() if name not in SERVICES}
        with self.output.open("ab") as output:
            self.process = subprocess.Popen(
                [sys.executable, "-m", "microcosmos_server.local"],
                cwd=ROOT,
                env=inherited | self.environment | settings,
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=output,
                start_new_session=True,
            )
        wait_until(self.answers, 120, f"the server answers; {self.output.read_text()}")

    def answers(self) -> bool:
        if self.process.poll() is not None:
            raise RuntimeError(f"it ended: {self.output.read_text()}")
        with suppress(httpx.TransportError):
            return self.http.get("/healthz").status_code == 200
        return False

    def end(self, sent: signal.Signals = signal.SIGINT, seconds: float = 60) -> int:
        """Ask it to end, as Ctrl-C does, and return its exit status."""
        self.process.send_signal(sent)
        return self.process.wait(seconds)

    def close(self) -> None:
        for process in self.processes():
            process.kill()
        if hasattr(self, "process"):
            self.process.wait()
        self.http.close()

    def get(self, path: str, **query: Any) -> Any:
        """Return the JSON of a path of the API."""
        return self.http.get(f"/api/v1/{path}", params=query).raise_for_status().json()

    def submit(self, spec: dict[str, Any]) -> str:
        return self.http.post("/api/v1/runs", json=spec).raise_for_status().json()["id"]

    def read(self, run: str) -> dict[str, Any]:
        """Read a run, retrying while the server is restarted."""

        def found() -> dict[str, Any] | None:
            with suppress(httpx.TransportError):
                return self.get(f"runs/{run}")

        return wait_until(found, 10, "the server answers")

    def ask(self, run: str, action: str) -> None:
        """Pause, resume or cancel."""
        self.http.post(f"/api/v1/runs/{run}/{action}").raise_for_status()

    def wait(self, run: str, *statuses: str, seconds: float = 120) -> dict[str, Any]:
        """Wait until a run has one of the statuses."""
        what = f"run {run} is {' or '.join(statuses)}"
        return self.follow(run, lambda found: found["status"] in statuses, seconds, what)

    def reach(self, run: str, generation: int, after: int = 0, seconds: float = 120) -> int:
        """Wait for an attempt, beyond `after`, that has recorded a generation."""

        def reached(found: dict[str, Any]) -> bool:
            recorded = found["status"] == "running" and found["generation"] >= generation
            return recorded and found["attempt"] > after

        what = f"run {run} reaches generation {generation}"
        return self.follow(run, reached, seconds, what, 0.03)["attempt"]

    def follow(self, run: str, condition: Callable[[Any], bool], *limits: Any) -> Any:
        """Read a run, as `wait_until`, until a condition holds; raise if it ends before."""

        def there() -> dict[str, Any] | None:
            found = self.read(run)
            if not (holds := condition(found)) and found["status"] in TERMINAL:
                raise RuntimeError(f"the run {found['status']} too soon: {found['error']}")
            return found if holds else None

        return wait_until(there, *limits)

    def archive(self, run: str) -> bytes:
        return self.http.get(f"/api/v1/runs/{run}/archive.h5").raise_for_status().content

    def results(self, run: str) -> dict[str, Any]:
        """The archive's file, and curves and archive in the API, without wall times."""
        curves = self.get(f"runs/{run}/generations")
        curves |= {"seconds": None, "summary": curves["summary"] | {"device_seconds": None}}
        archive = self.get(f"runs/{run}/archive")
        return {"file": self.archive(run), "curves": curves, "archive": archive}

    def processes(self) -> Iterator[psutil.Process]:
        for process in psutil.process_iter():
            with suppress(psutil.Error):
                ours = process.environ().get("MICROCOSMOS_DATA") == str(self.folder)
                # Redis writes over its environment, but it works inside of our folder.
                if ours or self.folder in Path(process.cwd()).parents:
                    yield process

    def owner(self, run: str) -> psutil.Process:
        """The supervisor whose job computes a run."""

        def name() -> str | None:
            workers = self.get("workers")
            return next((one["name"] for one in workers if one["run"] == run), None)

        found = wait_until(name, 10, f"a worker reports that it computes {run}")
        return psutil.Process(int(found.rpartition("-")[2]))

    @contextmanager
    def frozen(self, processes: Sequence[psutil.Process]) -> Iterator[None]:
        """Suspend processes for a while, none of them within a transaction.

        A suspended writer would keep SQLite's lock, and no other process could write.
        """

        database = self.folder / "microcosmos.sqlite"

        def resume() -> None:
            for process in processes:
                with suppress(psutil.NoSuchProcess):  # It may be killed while it is frozen.
                    process.resume()

        def freeze() -> bool:
            for process in processes:
                process.suspend()
            connection = sqlite3.connect(database, timeout=1, isolation_level=None)
            with closing(connection), suppress(sqlite3.OperationalError):
                connection.execute("BEGIN IMMEDIATE")
                return True
            resume()
            return False

        wait_until(freeze, 60, "the processes are frozen outside of a transaction")
        try:
            yield
        finally:
            resume()

    @contextmanager
    def slowed(self) -> Iterator[None]:
        """Let all jobs compute for a fifth of the time.

        So a run on a fast machine is not over before a test has disturbed it.
        """
        jobs, over = self.named(JOB), threading.Event()

        def hold() -> None:
            while not over.wait(0.02):
                for job in jobs:
                    with suppress(psutil.NoSuchProcess):
                        job.suspend()
                over.wait(0.08)
                for job in jobs:
                    with suppress(psutil.NoSuchProcess):
                        job.resume()

        thread = threading.Thread(target=hold)
        thread.start()
        try:
            yield
        finally:
            over.set()
            thread.join()

    def named(self, module: str) -> list[psutil.Process]:
        """Living processes that run a Python module or a program."""
        found = []
        for process in self.processes():
            with suppress(psutil.Error):
                runs = any(module in part for part in process.cmdline())
                if runs and process.status() != psutil.STATUS_ZOMBIE:
                    found.append(process)
        return found

    def signal(self, module: str, sent: signal.Signals) -> None:
        """Send a signal to each process that runs a module, of which there has to be one."""
        wait_until(lambda: self.named(module), 60, f"a process runs {module}")
        for process in self.named(module):
            process.send_signal(sent)


@contextmanager
def running(folder: Path, environment: dict[str, str]) -> Iterator[Installation]:
    """Yield a started installation, and end it."""
    product = Installation(folder, environment)
    try:
        product.start()
        yield product
        product.end()
    finally:
        product.close()


def kill_job(product: Installation, run: str) -> None:
    """Kill the process that computes, as the kernel does when memory runs out."""
    product.signal(JOB, signal.SIGKILL)


def kill_job_of(product: Installation, run: str) -> None:
    """Kill the process that computes this run alone."""
    with product.slowed():
        for child in product.owner(run).children():
            child.kill()


def kill_worker(product: Installation, run: str) -> None:
    product.signal(SUPERVISOR, signal.SIGKILL)


def stop_worker(product: Installation, run: str) -> None:
    """Terminate the worker; the process that started it starts it again."""
    product.signal(SUPERVISOR, signal.SIGTERM)


def pause_and_resume(product: Installation, run: str) -> None:
    product.ask(run, "pause")
    product.wait(run, "paused")
    product.ask(run, "resume")


Fault = Callable[[Installation, str], None]


def interrupt(
    product: Installation, run: str, faults: Iterable[tuple[int, Fault]], seconds: float = 120
) -> None:
    """Cause each fault in an attempt of its own, once that has reached a generation."""
    attempt = 0
    for generation, fault in faults:
        attempt = product.reach(run, generation, after=attempt, seconds=seconds)
        fault(product, run)
