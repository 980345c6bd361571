"""What must hold in the record of a group's runs: log, curves, archives, and what was told."""

import os
from collections import defaultdict
from collections.abc import Iterator
from datetime import datetime
from typing import Any

import rich
from drive import Installation, wait_until
from webhook import Receiver


def load() -> str:
    return f"load {os.getloadavg()[0]:.1f}"


def left(product: Installation, waiting: int) -> list[str]:
    """Return what is wrong with the runs that nobody may take."""
    queue = product.get("queue", limit=200)
    reasons = {one["waiting_reason"].partition(";")[0] for one in queue["items"]}
    if queue["total"] == waiting and reasons == {"Waits for a worker with the label nowhere"}:
        return []
    return [f"{queue['total']} of {waiting} runs wait, for {reasons}"]


def faults(
    product: Installation, runs: list[tuple[str, int]], expected: dict[int, Any]
) -> list[str]:
    """Return what is wrong with the record of runs."""
    found, again = [], []
    for run, seed in runs:
        record = product.get(f"runs/{run}")
        curves = product.get(f"runs/{run}/generations")["generation"]
        log = product.get(f"runs/{run}/log")["entries"]
        attempts = [one["attempt"] for one in log]
        if curves != list(range(1, record["generations"] + 1)):
            found.append(f"{run}: generations {curves}")
        if attempts != sorted(attempts):
            found.append(f"{run}: attempts {attempts}")
        if product.results(run) != expected[seed]:
            found.append(f"{run}: it differs from the undisturbed one")
        if record["error"] or any("Failed" in one["text"] for one in log):
            found.append(f"{run}: it has failed: {record['error']}")
        again += resumptions(log)
    attempts = [product.get(f"runs/{run}")["attempt"] for run, _ in runs]
    median = sorted(again)[len(again) // 2] if again else 0.0
    rich.print(
        f"  {len(runs)} runs, {sum(attempts)} attempts; {len(again)} resumed after a median of "
        f"{median:.1f} s, at most {max(again, default=0.0):.1f} s; {load()}"
    )
    return found


def resumptions(log: list[dict[str, Any]]) -> Iterator[float]:
    """Yield the seconds from the end of an attempt to the beginning of the next."""
    ended: float | None = None
    for entry in log:
        at = datetime.fromisoformat(entry["at"]).timestamp()
        if entry["text"].startswith("Attempt ") and " begins " in entry["text"]:
            if ended is not None:
                yield at - ended
            ended = None
        elif " failed" in entry["text"] or entry["text"].startswith("Worker stopped"):
            ended = at


def told(product: Installation, runs: list[str], receiver: Receiver) -> list[str]:
    """Return what is wrong with what was told: each run has ended, once.

    The same event may arrive twice, if the answer to the first was lost: both have one id, by
    which a receiver knows that nobody is to be paged again.
    """

    def arrived() -> dict[str, dict[str, str]]:
        found: dict[str, dict[str, str]] = defaultdict(dict)
        for name, event in receiver.events():
            found[event["data"]["run"]][name] = event["type"]
        return found

    wait_until(lambda: set(runs) <= arrived().keys(), 120, "all ends of runs were told")
    found = arrived()
    repeated = len(receiver.got) - sum(map(len, found.values()))
    rich.print(f"  {len(receiver.got)} events were told, {repeated} of them twice")
    once = ["run.finished"]
    return [
        f"{run}: {found[run]} were told" for run in runs if list(found[run].values()) != once
    ]
