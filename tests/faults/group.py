"""A drill for a group: many hosts, many queued runs, and everything around them fails.

Hosts are worker processes with settings of their own. What must hold is read from the record
alone: the log, the curves and the archives.
"""

import signal
import sqlite3
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack, closing, contextmanager, suppress
from pathlib import Path
from typing import Any, NamedTuple
from urllib.parse import urlsplit

import httpx
import psycopg
import record
import redis
import rich
from databases import POSTGRES, Missing, service_settings
from drive import ROOT, SHORT, Installation, kill_job, running, wait_until
from relay import Relay
from small_spec import SMALL_SCENE
from sqlalchemy import make_url
from webhook import SECRET, Receiver

from microcosmos_server.core.database import SILENT_SECONDS

FAKETIME = sorted(Path("/usr/lib").glob("*/faketime/libfaketime.so.1"))


class Drill(NamedTuple):
    """The size of a drill."""

    hosts: int
    queued: int
    """Runs, with those that finish."""
    finishing: int
    different: int
    """Number of specs among them; runs of one end alike."""
    generations: int
    outage: float
    """Seconds without the database, more than a lease, and of errors of the store."""
    patience: float
    """Seconds within which all of them finish after the bad night."""


SMALL = Drill(4, 10, 4, 1, 12, outage=5.0, patience=300.0)
FULL = Drill(20, 500, 40, 4, 40, outage=60.0, patience=3600.0)


def spec(seed: int, generations: int) -> dict[str, Any]:
    search = {"generations": generations, "batch": 16, "block": 8}
    return SMALL_SCENE | {"seed": seed, "search": search}


class Hosts:
    """The workers of an installation, each as if it had a machine of its own."""

    def __init__(self, product: Installation):
        server, *_ = product.named("microcosmos_server.main")
        self.environment = server.environ() | {"WORKERS": "1"}
        self.processes: list[subprocess.Popen[bytes]] = []

    def start(self, **settings: str) -> subprocess.Popen[bytes]:
        command = [sys.executable, "-m", "microcosmos_worker.supervisor"]
        environment = self.environment | settings
        log = Path(environment["MICROCOSMOS_DATA"]) / f"host-{len(self.processes)}.log"
        with log.open("ab") as output:
            started = subprocess.Popen(command, cwd=ROOT, env=environment, stderr=output)
        self.processes.append(started)
        return started

    @property
    def alive(self) -> list[subprocess.Popen[bytes]]:
        return [one for one in self.processes if one.poll() is None]

    def end(self) -> None:
        for one in self.alive:
            one.kill()
        for one in self.processes:
            one.wait()

    def restart_each(self) -> None:
        """Stop one host after the other as for an upgrade, and start another in its place."""
        for one in self.alive:
            one.send_signal(signal.SIGTERM)
            one.wait(60)
            self.start()


@contextmanager
def no_database(product: Installation) -> Iterator[None]:
    """Refuse connections (PostgreSQL) or keep every writer out (SQLite)."""
    url = product.environment.get("MICROCOSMOS_DATABASE_URL")
    if url is None:
        file = product.folder / "microcosmos.sqlite"
        with closing(sqlite3.connect(file, timeout=30, isolation_level=None)) as connection:
            connection.execute("BEGIN IMMEDIATE")
            yield
        return
    name = url.rpartition("/")[2]
    with psycopg.connect(f"{POSTGRES}/postgres", autocommit=True) as admin:
        admin.execute(f"ALTER DATABASE {name} ALLOW_CONNECTIONS false")
        admin.execute(
            "SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE datname = %s", [name]
        )
        try:
            yield
        finally:
            admin.execute(f"ALTER DATABASE {name} ALLOW_CONNECTIONS true")


@contextmanager
def no_store(product: Installation) -> Iterator[None]:
    """Make every read and write of files fail."""
    store = product.folder / "artifacts"
    away = store.rename(store.with_name("away"))
    store.write_text("not a folder")
    try:
        yield
    finally:
        store.unlink()
        away.rename(store)


def flush(product: Installation) -> None:
    server, *_ = product.named("microcosmos_server.main")
    with redis.Redis.from_url(server.environ()["MICROCOSMOS_REDIS_URL"]) as client:
        client.flushdb()


@contextmanager
def frozen_redis(product: Installation) -> Iterator[bool]:
    """Freeze the Redis of the installation; yield False if it has none of its own."""
    found = product.named("redis-server") + product.named("valkey-server")
    for one in found:
        one.suspend()
    try:
        yield bool(found)
    finally:
        for one in found:
            one.resume()


def frozen_database(product: Installation, database: Relay, seconds: float) -> Iterator[str]:
    """Let nothing through to PostgreSQL for a while, and yield what should not follow."""
    slowest, until = 0.0, time.monotonic() + seconds
    database.going.clear()
    try:
        while time.monotonic() < until:
            began = time.monotonic()
            product.http.get("/healthz").raise_for_status()
            slowest = max(slowest, time.monotonic() - began)
            time.sleep(1.0)
    finally:
        database.going.set()
    began = time.monotonic()
    wait_until(lambda: answers(product), 120, "the database is used again")
    back = time.monotonic() - began
    say(f"database frozen {seconds:g} s: slowest answer {slowest:.2f} s, back in {back:.1f} s")
    if slowest > FROZEN_SECONDS:
        yield f"the server was silent for {slowest:.1f} s while the database was frozen"
    if back > FROZEN_SECONDS:
        yield f"the server needed {back:.1f} s once the database went on"


def answers(product: Installation) -> bool:
    with suppress(httpx.HTTPError):
        return product.http.get("/api/v1/runs", timeout=5).status_code == 200
    return False


def silences(product: Installation, runs: list[str]) -> int:
    """Count the attempts that ended because their worker did not report."""
    logs = [product.get(f"runs/{run}/log")["entries"] for run in runs]
    return sum("has not reported for" in one["text"] for log in logs for one in log)


def disturb(
    product: Installation,
    hosts: Hosts,
    size: Drill,
    runs: list[str],
    database: Relay | None,
) -> Iterator[str]:
    """Do everything that goes wrong in a bad night, and yield what should not follow."""
    kill_job(product, "")
    say("jobs killed")
    hosts.alive[0].kill()
    hosts.start()
    say("a host killed")
    hosts.restart_each()
    say("hosts restarted one after another")
    flush(product)
    say("Redis emptied")
    with no_store(product):
        time.sleep(size.outage)
    say(f"{size.outage:g} s without the store")
    before = silences(product, runs)
    with no_database(product):
        time.sleep(size.outage)
    say(f"{size.outage:g} s without the database")
    if database:
        yield from frozen_database(product, database, SILENT_SECONDS + size.outage)
    time.sleep(HEARTBEATS)
    if after := silences(product, runs) - before:
        yield f"the database was away, and {after} attempts failed for it"
    with frozen_redis(product) as own:
        began = time.monotonic()
        for number in range(10):
            changed = product.http.patch(f"/api/v1/runs/{runs[0]}", json={"note": f"{number}"})
            changed.raise_for_status()
        seconds = time.monotonic() - began
    if not own:
        rich.print("  NOT SHOWN: a frozen Redis: it is not the installation's own")
        return
    say(f"Redis frozen: 10 changes in {seconds:.2f} s")
    if seconds > FROZEN_SECONDS:
        yield f"10 changes took {seconds:.1f} s while Redis was frozen"


HEARTBEATS = 3.0
"""Seconds in which the reconciler takes several passes after an outage."""
FROZEN_SECONDS = 10.0
"""Most seconds, on a busy machine, for ten changes while Redis is frozen, for an answer without
the database while that is frozen, and for one with it afterwards."""


def say(what: str) -> None:
    rich.print(f"  {what}, {record.load()}")


def queue_others(product: Installation, size: Drill) -> None:
    """Queue runs that nobody may take: no worker has their label."""
    for seed in range(size.queued - size.finishing):
        document = spec(1000 + seed, size.generations)
        answer = product.http.post(
            "/api/v1/runs", json=document, params={"labels": "nowhere", "priority": "high"}
        )
        answer.raise_for_status()


def drill(
    product: Installation, size: Drill, told: Receiver, database: Relay | None = None
) -> list[str]:
    """Carry out a drill, and return what is wrong in its record.

    `told` receives what the installation tells about its runs; the installation reaches a
    PostgreSQL through `database`.
    """
    hosts = Hosts(product)
    try:
        hosts.start()
        expected = {}
        for seed in range(size.different):
            run = product.submit(spec(seed, size.generations))
            product.wait(run, "finished", seconds=300)
            expected[seed] = product.results(run)
        queue_others(product, size)
        runs = [
            (
                product.submit(spec(number % size.different, size.generations)),
                number % size.different,
            )
            for number in range(size.finishing)
        ]
        empty = product.folder / "no mount"
        empty.mkdir()
        hosts.start(JAX_PLATFORMS="cuda")  # There is none.
        hosts.start(MICROCOSMOS_ARTIFACTS_URL=str(empty))
        wrong_clock = {"LD_PRELOAD": str(FAKETIME[0]), "FAKETIME": "+1h"} if FAKETIME else {}
        hosts.start(**wrong_clock)
        for _ in range(size.hosts - 4):
            hosts.start()
        wait_until(lambda: is_under_way(product), 300, "runs are computed", every=0.3)
        wrong = list(disturb(product, hosts, size, [run for run, _ in runs], database))
        wait_finished(product, [run for run, _ in runs], size.patience)
        if not FAKETIME:
            rich.print("  NOT SHOWN: a host with a wrong clock: no libfaketime on this machine")
        return [
            *wrong,
            *record.faults(product, runs, expected),
            *record.left(product, size.queued - size.finishing),
            *record.told(product, [run for run, _ in runs], told),
        ]
    finally:
        hosts.end()


def wait_finished(product: Installation, runs: list[str], seconds: float) -> None:
    """Wait until runs have finished; raise with what holds one up."""
    deadline = time.monotonic() + seconds
    for run in runs:
        try:
            left = max(deadline - time.monotonic(), 1.0)
            if product.wait(run, "finished", "paused", seconds=left)["status"] == "paused":
                raise AssertionError(f"run {run} waits for a person")
        except (AssertionError, TimeoutError) as error:
            log = product.get(f"runs/{run}/log")["entries"][-20:]
            error.add_note(f"{product.read(run)}\n{log}\n{product.get('workers')}")
            raise


def is_under_way(product: Installation) -> bool:
    found = product.get("runs", status="running", limit=200)["items"]
    return any(one["generation"] >= 2 for one in found)


def telling(url: str) -> dict[str, str]:
    """The settings with which an installation tells a receiver about its runs."""
    return {"MICROCOSMOS_WEBHOOK_URL": url, "MICROCOSMOS_WEBHOOK_SECRET": SECRET}


@contextmanager
def relayed(settings: dict[str, str]) -> Iterator[Relay]:
    """Put a relay before the PostgreSQL of settings, which name the relay then."""
    url = make_url(settings["MICROCOSMOS_DATABASE_URL"])
    relay = Relay(f"http://{url.host}:{url.port or 5432}")
    through = url.set(host="127.0.0.1", port=urlsplit(relay.url).port)
    settings["MICROCOSMOS_DATABASE_URL"] = through.render_as_string(hide_password=False)
    try:
        yield relay
    finally:
        relay.close()


def group(_: Installation) -> bool:
    """Tell whether a group's runs survive a bad night, on both stacks."""
    good = []
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        try:
            elsewhere = stack.enter_context(service_settings())
        except Missing as missing:
            rich.print(f"NOT SHOWN: {missing}")
            return False
        database = stack.enter_context(relayed(elsewhere))
        for name, services, relay in (
            ("SQLite", {}, None),
            ("PostgreSQL and a Redis server", elsewhere, database),
        ):
            rich.print(f"group drill on {name}: {FULL}")
            settings = SHORT | {"MICROCOSMOS_LEASE": "20", "WORKERS": "0"} | services
            settings["SERVERS"] = "3"
            receiver = Receiver()
            with (
                receiver.serve() as url,
                running(folder / name, settings | telling(url)) as product,
            ):
                wrong = drill(product, FULL, receiver, relay)
            print(*wrong, sep="\n")
            good.append(not wrong)
    return all(good)
