"""The main job at full size: `make acceptance` prints what `make test` shows small.

A quality-diversity run against random search over the same genomes at equal evaluations,
three seeds, submitted over HTTP; and the same run killed, stopped, paused and resumed,
whose archive has to be byte for byte the undisturbed one.
"""

import random
import statistics
import sys
import tempfile
import time
from pathlib import Path

from drive import Installation, interrupt, kill_job, pause_and_resume, stop_worker
from rich.console import Console
from rich.table import Table

from microcosmos.spec import QualityDiversity, Search

SEEDS = (0, 1, 2)
FAULTS = (kill_job, stop_worker, kill_job, pause_and_resume, kill_job)
SETTINGS = {"MICROCOSMOS_DEMONSTRATION": "0", "MICROCOSMOS_CHECKPOINT_INTERVAL": "5"}
BARS = {"qd_score": 1.3, "best": 1.2}
HOURS = 3600

console = Console()


def spec(seed: int, variation: str) -> dict:
    """32 nodes, 64 × 64 cells, 500 steps, batch 64, 20 × 20 cells, 50 generations."""
    whole = QualityDiversity(seed=seed, search=Search(variation=variation))
    return whole.model_dump(mode="json")


def carry_out(place: Installation, seed: int, variation: str) -> tuple[str, dict]:
    began = time.monotonic()
    run = place.submit(spec(seed, variation))
    found = place.wait(run, "finished", seconds=2 * HOURS)
    seconds = time.monotonic() - began
    console.print(
        f"seed {seed} {variation:>6}: QD score {found['qd_score']:.1f}, coverage "
        f"{found['coverage']:.3f}, best {found['best']:.2f}, diverged {found['diverged']}, "
        f"{seconds / 60:.1f} min, {found['evaluations'] / seconds:.1f} evaluations/s"
    )
    return run, found


def compare(found: dict[str, list[dict]]) -> bool:
    """Print medians and spreads; whether the ratios of medians reach their bars."""
    table = Table("", "neat: median (range)", "random: median (range)", "ratio", "bar")
    good = True
    for name, bar in BARS.items():
        values = {kind: [run[name] for run in runs] for kind, runs in found.items()}
        middle = {kind: statistics.median(v) for kind, v in values.items()}
        ratio = middle["neat"] / middle["random"]
        good &= ratio >= bar
        cells = [f"{middle[k]:.2f} ({min(values[k]):.2f}–{max(values[k]):.2f})" for k in values]
        table.add_row(name, *cells, f"{ratio:.2f}", f"{bar}")
    console.print(table)
    return good


def disturb(place: Installation, undisturbed: bytes) -> bool:
    """Whether a run disturbed at random moments ends with the same bytes."""
    run = place.submit(spec(SEEDS[0], "neat"))
    moments = sorted(random.choices(range(1, 45), k=len(FAULTS)))
    interrupt(place, run, FAULTS, moments, seconds=2 * HOURS)
    attempts = place.wait(run, "finished", seconds=2 * HOURS)["attempt"]
    same = place.archive(run) == undisturbed
    names = ", ".join(f"{f.__name__} at {m}" for f, m in zip(FAULTS, moments, strict=True))
    console.print(
        f"{names}: {attempts} attempts, archive {'identical' if same else 'DIFFERENT'}"
    )
    return same


def main() -> None:
    with tempfile.TemporaryDirectory() as folder:
        place = Installation(Path(folder) / "data", SETTINGS)
        place.start()
        try:
            runs = {k: [carry_out(place, s, k) for s in SEEDS] for k in ("neat", "random")}
            good = compare({k: [found for _, found in v] for k, v in runs.items()})
            good &= disturb(place, place.archive(runs["neat"][0][0]))
        finally:
            place.end()
            place.close()
    sys.exit(not good)


if __name__ == "__main__":
    main()
