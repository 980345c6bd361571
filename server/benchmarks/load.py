"""The server under load, with one process and with two; prints a table and asserts nothing.

Each row is measured beside an empty server, on which the same requests come one after another
and the archive has one elite. Clients run in processes of their own on the same cores.

    python server/benchmarks/load.py      # seconds for each part
    python server/benchmarks/load.py --archive 60 --posts 1000 --watch 600 --rounds 10
"""

import argparse
import os
import sys
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, field
from multiprocessing import get_context
from pathlib import Path
from typing import Any

sys.path += [str(Path(__file__).parents[2] / "tests" / name) for name in ("faults", "support")]

import clients
import numpy as np
import psutil
import reports
from drive import Installation, running
from rich.console import Console
from rich.table import Table

from microcosmos.archive import columns
from microcosmos.spec import parse
from microcosmos_server.attempts.attempt import Attempt
from microcosmos_server.attempts.claim import claim
from microcosmos_server.runs.submission import submit
from microcosmos_server.services.services import Services, connect
from microcosmos_server.settings import Settings

SIDE = 100
FILLED = 1000
"""New elites of a generation."""
RATE, BESIDE = 50.0, 10.0
"""Requests a second for the archive, and for the run beside it."""
POSTING, WATCHERS, ATTACKERS = 4, 200, 45
CONNECTED = 5.0
"""Seconds until all watchers are connected."""
PAUSE = 0.2
"""Seconds between two generations that watchers see."""
SERVERS = (1, 2)
"""Processes that answer requests, of each loaded installation."""
PROBES = 20.0
"""Requests a second for `/healthz` during the attack."""


@dataclass(frozen=True)
class Length:
    """The length of each part in seconds."""

    archive: float
    """Seconds of archives."""
    posts: int
    watch: float
    """Seconds of watchers, at least."""
    rounds: int
    """Repetitions of the attack, each about other creatures."""


SHORT = Length(archive=8.0, posts=100, watch=10.0, rounds=2)


@dataclass
class Figures:
    """The measurements of one server."""

    milliseconds: dict[str, list[float]] = field(default_factory=dict)
    notes: dict[str, str] = field(default_factory=dict)

    def add(self, name: str, seconds: list[float]) -> None:
        self.milliseconds[name] = [1000 * one for one in seconds]


@contextmanager
def serving(servers: int, elites: int) -> Iterator[tuple[Installation, Attempt]]:
    """An installation without workers, with one archive that a run still fills."""
    settings = {
        "SERVERS": str(servers),
        "WORKERS": "0",
        "MICROCOSMOS_DEMONSTRATION": "0",
        "MICROCOSMOS_LEASE": "100000",
    }
    with (
        tempfile.TemporaryDirectory() as folder,
        running(Path(folder) / "data", settings) as product,
    ):
        redis = product.named("microcosmos_server.main")[0].environ()["MICROCOSMOS_REDIS_URL"]
        services = connect(Settings(data=product.folder, redis_url=redis))
        yield product, recorded(services, elites)
        services.close()


def recorded(services: Services, elites: int) -> Attempt:
    """A run with an archive that was filled generation by generation."""
    axes = [{"name": name, "bins": SIDE} for name in reports.EFFORTS]
    spec = reports.DEMO.model_dump(mode="json") | {"archive": {"descriptors": axes}}
    spec["search"] |= {"generations": 100_000}
    attempt = claim(services, submit(services, parse(spec))[0].id, "benchmark")
    assert attempt
    draw = np.random.default_rng(0)
    generations = max(1, elites // FILLED)
    for generation in range(1, generations + 1):
        cells = range((generation - 1) * FILLED, min(generation * FILLED, elites))
        report = reports.report(generation, dict.fromkeys(cells, 0.0))
        for elite in report.elites:
            elite.fitness, *elite.descriptors = draw.random(3)
        attempt.record(report, 1.0)
    attempt.save(generations, reports.archive_file(spec))
    return attempt


def measure(servers: int, elites: int, length: Length, loaded: bool) -> Figures:
    """Carry out all parts; unless `loaded`, requests come one after another."""
    figures = Figures()
    with (
        serving(servers, elites) as (product, attempt),
        ProcessPoolExecutor(4, mp_context=get_context("spawn")) as pool,
    ):
        clients_of = Clients(product, pool, figures, loaded)
        clients_of.archive(attempt, length)
        clients_of.posts(attempt.spec, length)
        clients_of.attack(attempt, length)
        if loaded:
            clients_of.watch(attempt, length)
    return figures


@dataclass
class Clients:
    """The parts of the benchmark, over one installation."""

    product: Installation
    pool: ProcessPoolExecutor
    figures: Figures
    loaded: bool

    def archive(self, attempt: Attempt, length: Length) -> None:
        """Whole archives as columns, none of them revalidated, and the run beside them."""
        run, port = f"/api/v1/runs/{attempt.run_id}", self.product.port
        accept = {"Accept": columns.MEDIA_TYPE}
        connection = clients.http.client.HTTPConnection("127.0.0.1", port)
        begun = time.monotonic()
        size = len(clients.ask(connection, f"{run}/archive", None, accept))
        first = time.monotonic() - begun
        self.figures.notes["archive, the first time"] = f"{1000 * first:.0f} ms, {size:,} bytes"
        before = cpu_seconds(self.product)
        parts = {"archive": (f"{run}/archive", RATE), "run beside it": (run, BESIDE)}
        rates = {name: rate if self.loaded else BESIDE for name, (_, rate) in parts.items()}
        asked = {
            name: (clients.on_time, port, path, rates[name], length.archive, accept)
            for name, (path, _) in parts.items()
        }
        for name, seconds in self._carry_out(asked).items():
            self.figures.add(name, seconds)
        spent = 1000 * (cpu_seconds(self.product) - before)
        requests = sum(len(self.figures.milliseconds[name]) for name in parts)
        self.figures.notes["CPU of a request"] = f"{spent / requests:.1f} ms"

    def posts(self, spec: dict[str, Any], length: Length) -> None:
        bodies = [spec | {"seed": seed} for seed in range(length.posts)]
        threads = POSTING if self.loaded else 1
        path = "/api/v1/runs"
        found = self._carry_out(
            {"POST": (clients.post_all, self.product.port, path, bodies, threads)}
        )
        self.figures.add("POST /runs", found["POST"])

    def attack(self, attempt: Attempt, length: Length) -> None:
        """Networks of a shared archive, all at once, and `/healthz` meanwhile."""
        sent = {"run": str(attempt.run_id), "credit": ["a benchmark"]}
        share = self.product.http.post("/api/v1/shares", json=sent).raise_for_status().json()
        header = {"Microcosmos-Share": share["slug"]}
        archive = self.product.get(f"runs/{attempt.run_id}/archive")["creature"]
        probing = 2.0 * length.rounds
        asked: dict[str, tuple[Any, ...]] = {
            "healthz": (clients.on_time, self.product.port, "/healthz", PROBES, probing, {})
        }
        some = archive[: ATTACKERS * length.rounds if self.loaded else 1]
        paths = [f"/api/v1/creatures/{sha}/network.py" for sha in some]
        asked["network"] = (clients.all_of, self.product.port, paths, header, ATTACKERS)
        found = self._carry_out(asked)
        self.figures.add("healthz in the attack", found["healthz"])
        self.figures.add("network in the attack", found["network"])

    def watch(self, attempt: Attempt, length: Length) -> None:
        """Watchers in two processes, while generations are recorded."""
        before, path, port = memory(self.product), "/api/v1/events", self.product.port
        first = self.product.read(str(attempt.run_id))["generation"] + 1
        last = first + round(length.watch / PAUSE)
        asked = (clients.watch, port, path, WATCHERS // 2, last)
        waiting = [self.pool.submit(*asked) for _ in range(2)]
        time.sleep(CONNECTED)
        sizes = []
        for number in range(first, last + 1):
            attempt.record(reports.report(number, {5: 0.0}), 1.0)
            sizes.append(memory(self.product))
            time.sleep(PAUSE)
        complete = [one for part in waiting for one in part.result()]
        notes = self.figures.notes
        notes["watchers that missed nothing"] = f"{sum(complete)} of {len(complete)}"
        middle = sizes[len(sizes) // 2]
        notes["memory before, half way, at the end"] = ", ".join(
            f"{size >> 20} MiB" for size in (before, middle, sizes[-1])
        )

    def _carry_out(self, asked: dict[str, tuple[Any, ...]]) -> dict[str, list[Any]]:
        """Call functions in processes, at once if the server is to be loaded."""
        if not self.loaded:
            return {name: self.pool.submit(*one).result() for name, one in asked.items()}
        waiting = {name: self.pool.submit(*one) for name, one in asked.items()}
        return {name: one.result() for name, one in waiting.items()}


def processes(product: Installation) -> list[psutil.Process]:
    """The processes that answer requests."""
    (first,) = product.named("microcosmos_server.main")
    return [first, *first.children(recursive=True)]


def memory(product: Installation) -> int:
    return sum(one.memory_info().rss for one in processes(product))


def cpu_seconds(product: Installation) -> float:
    return sum(sum(one.cpu_times()[:2]) for one in processes(product))


def table(found: dict[str, Figures]) -> Table:
    """Milliseconds, and how many times those of the empty server they are."""
    shown = Table(
        "", *found, title=f"Milliseconds (p50, p95, longest); load {os.getloadavg()[0]:.1f}"
    )
    empty = next(iter(found.values()))
    for name, alone in empty.milliseconds.items():
        base = np.percentile(alone, 95)
        cells = []
        for one in found.values():
            p50, p95, most = np.percentile(one.milliseconds[name], (50, 95, 100))
            cells.append(f"{p50:.0f}, {p95:.0f}, {most:.0f} ({p95 / base:.1f} ×)")
        shown.add_row(f"{name}", *cells)
    for name in dict.fromkeys(name for one in found.values() for name in one.notes):
        shown.add_row(name, *(one.notes.get(name, "") for one in found.values()))
    return shown


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    for name, default in vars(SHORT).items():
        parser.add_argument(f"--{name}", type=type(default), default=default)
    length = Length(**vars(parser.parse_args()))
    found = {"empty": measure(1, 1, SHORT, loaded=False)}
    for servers in SERVERS:
        name = f"SERVERS={servers}, {SIDE * SIDE:,} cells"
        found[name] = measure(servers, SIDE * SIDE, length, loaded=True)
    Console(width=120).print(table(found))


if __name__ == "__main__":
    main()
