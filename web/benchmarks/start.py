"""Seconds from the start of what `make run` starts, in a new data folder; prints a table.

The checkout is installed. A new data folder has no compiled programs.
"""

import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "faults"))

from drive import Installation, running, wait_until
from rich.console import Console
from rich.table import Table

TIMES = 3
PHASES = ("server ready", "demonstration running", "first elites")


def seconds_to_each_phase() -> tuple[float, ...]:
    with tempfile.TemporaryDirectory() as folder:
        begun = time.monotonic()
        with running(Path(folder) / "data", {"MICROCOSMOS_DEMONSTRATION": "1"}) as product:
            ready = time.monotonic() - begun
            wait_until(lambda: run_of(product)["started_at"], 60, "the run starts", 0.02)
            started = time.monotonic() - begun
            wait_until(lambda: run_of(product)["coverage"], 60, "elites are found", 0.02)
            return ready, started, time.monotonic() - begun


def run_of(product: Installation) -> dict:
    """The demonstration; what is not known before it is submitted is None."""
    runs = product.get("runs")["items"]
    return runs[0] if runs else dict.fromkeys(("started_at", "coverage"))


def main() -> None:
    table = Table("", *(f"start {i + 1}" for i in range(TIMES)), title="Seconds of make run")
    starts = [seconds_to_each_phase() for _ in range(TIMES)]
    for phase, seconds in zip(PHASES, zip(*starts, strict=True), strict=True):
        table.add_row(phase, *(f"{one:.1f}" for one in seconds))
    Console().print(table)


if __name__ == "__main__":
    main()
