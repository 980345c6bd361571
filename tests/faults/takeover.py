"""How soon a run goes on after its job or its host has died, with the product's own leases."""

import time
from collections.abc import Callable
from datetime import datetime

import rich
from drive import SHORT, Installation, kill_job, running
from group import Hosts, spec
from record import load

TIMES = 5
SETTINGS = {
    name: value
    for name, value in SHORT.items()
    if name not in ("MICROCOSMOS_LEASE", "MICROCOSMOS_RECONCILE_INTERVAL")
}
LIMITS = {"job": 5.0, "host": 30.0}
"""Seconds within which the next attempt has claimed the run, on a quiet machine."""


def takeover(other: Installation) -> bool:
    """Kill the job and the host of a run several times; tell whether it goes on in time."""
    with running(other.folder.parent / "takeover", SETTINGS | {"WORKERS": "0"}) as product:
        hosts = Hosts(product)
        try:
            hosts.start()
            hosts.start()
            found = delays(product, hosts)
        finally:
            hosts.end()
    for name, seconds in found.items():
        rich.print(
            f"after the death of a {name}: median {sorted(seconds)[TIMES // 2]:.1f} s, "
            f"at most {max(seconds):.1f} s, of {TIMES} (limit {LIMITS[name]:g} s); {load()}"
        )
    return all(max(seconds) <= LIMITS[name] for name, seconds in found.items())


def delays(product: Installation, hosts: Hosts) -> dict[str, list[float]]:
    """Return the seconds from each death to the beginning of the next attempt."""

    def kill_host(product: Installation, run: str) -> None:
        product.owner(run).kill()
        hosts.start()

    kills: dict[str, Callable[[Installation, str], None]] = {
        "job": kill_job,
        "host": kill_host,
    }
    run, attempt, killed = product.submit(spec(0, 5000)), 0, []
    for _ in range(TIMES):
        for name, kill in kills.items():
            attempt = product.reach(run, 1, after=attempt)
            generation = product.read(run)["generation"]
            product.reach(run, generation + 20, after=attempt - 1)
            time.sleep(3.0)  # There is a checkpoint, and the other host is ready.
            killed.append((name, attempt, time.time()))
            kill(product, run)
    product.reach(run, 1, after=attempt)
    begun = beginnings(product, run)
    found: dict[str, list[float]] = {name: [] for name in kills}
    for name, before, at in killed:
        found[name].append(begun[before + 1] - at)
    product.ask(run, "cancel")
    return found


def beginnings(product: Installation, run: str) -> dict[int, float]:
    """Return when each attempt at a run began."""
    return {
        entry["attempt"]: datetime.fromisoformat(entry["at"]).timestamp()
        for entry in product.get(f"runs/{run}/log")["entries"]
        if entry["text"].startswith("Attempt ") and " begins " in entry["text"]
    }
