"""The main job at full size: `make acceptance` prints what `make test` shows small.

Four searches at equal evaluations, five seeds each, submitted over HTTP; a run that is
killed, stopped, paused and resumed, whose archive has to be byte for byte the undisturbed
one, as has that of a second installation, on PostgreSQL and a Redis server; creatures that
sense and collect energy; searches with derivatives and without; a page that is left open for
half an hour, or for as many minutes as `MINUTES` says; and thousands of files that are none.
Names of parts choose some.
"""

import os
import random
import sys
import tempfile
import time
from pathlib import Path

import malformed_hdf5
from databases import Missing, services
from drive import Installation, interrupt, kill_job, pause_and_resume, running, stop_worker
from left_open import leave_open
from rich.console import Console
from searches import METHODS, SEEDS, compare, compare_slopes, draw, forage, sinusoidal, spec
from uploads import all_cases, send, watched

FAULTS = (kill_job, stop_worker, kill_job, pause_and_resume, kill_job)
SETTINGS = {"MICROCOSMOS_DEMONSTRATION": "0", "MICROCOSMOS_CHECKPOINT_INTERVAL": "5"}
PICTURES = Path(__file__).parents[2] / "docs" / "pictures"
HOURS = 3600
MINUTES = float(os.environ.get("MINUTES", "30"))

console = Console(width=110)


def carry_out(place: Installation, document: dict, title: str) -> dict:
    """Carry out a run, print a line about it and return it from the API."""
    began = time.monotonic()
    run = place.submit(document)
    found = place.wait(run, "finished", seconds=2 * HOURS)
    seconds = time.monotonic() - began
    console.print(
        f"{title}: QD score {found['qd_score']:.1f}, coverage {found['coverage']:.3f}, best "
        f"{found['best']:.2f}, diverged {found['diverged']}, {seconds / 60:.1f} min, "
        f"{found['evaluations'] / seconds:.1f} evaluations/s"
    )
    return found


def disturb(place: Installation, undisturbed: bytes) -> bool:
    """Tell whether a run disturbed at random moments ends with the same bytes."""
    run = place.submit(spec(SEEDS[0], "MAP-Elites, NEAT"))
    moments = sorted(random.choices(range(1, 45), k=len(FAULTS)))
    interrupt(place, run, FAULTS, moments, seconds=2 * HOURS)
    attempts = place.wait(run, "finished", seconds=2 * HOURS)["attempt"]
    same = place.archive(run) == undisturbed
    names = ", ".join(f"{f.__name__} at {m}" for f, m in zip(FAULTS, moments, strict=True))
    console.print(
        f"{names}: {attempts} attempts, archive {'identical' if same else 'DIFFERENT'}"
    )
    return same


def searches(place: Installation) -> bool:
    """Tell whether searches beat random search by enough, and a disturbed run ends with the
    bytes of an undisturbed one."""
    runs = {
        name: [carry_out(place, spec(s, name), f"{name}, seed {s}") for s in SEEDS]
        for name in METHODS
    }
    good = compare(runs, console)
    draw(runs, PICTURES / "searches.png")
    good &= disturb(place, place.archive(runs["MAP-Elites, NEAT"][0]["id"]))
    sinusoidal(place, runs, console)
    return good


def slopes(place: Installation) -> bool:
    """Print searches with derivatives and without; either may win."""
    compare_slopes(place, carry_out, console, PICTURES / "slopes.png")
    return True


def databases(place: Installation) -> bool:
    """Tell whether the same run ends with the same bytes on SQLite with the embedded Redis and,
    with faults, on PostgreSQL with a Redis server."""
    document = spec(SEEDS[0], "MAP-Elites, NEAT")
    embedded = place.archive(carry_out(place, document, "SQLite, embedded Redis")["id"])
    try:
        with services() as settings:
            return elsewhere(place.folder.parent / "elsewhere", settings, document, embedded)
    except Missing as missing:
        console.print(f"NOT SHOWN: {missing}")
        return False


def elsewhere(folder: Path, settings: dict[str, str], document: dict, embedded: bytes) -> bool:
    """Tell whether an installation on other services gives these bytes, disturbed or not."""
    with running(folder, SETTINGS | settings) as other:
        found = carry_out(other, document, "PostgreSQL, Redis server")
        same = other.archive(found["id"]) == embedded
        console.print(f"{len(embedded)} bytes: {'identical' if same else 'DIFFERENT'}")
        return same and disturb(other, embedded)


def uploads(place: Installation) -> bool:
    """Tell whether thousands of malformed files are refused in time, and no other is read."""
    canary = place.folder / "canary.h5"
    canary.write_bytes(malformed_hdf5.whole())
    with watched(canary) as readings:
        found = send(place, all_cases(canary))
    console.print(
        f"{found.refused} malformed files: {len(found.wrong)} not refused as they should be, "
        f"the slowest in {found.slowest:.2f} s, {found.growth >> 20} MiB more memory at most, "
        f"{len(readings)} readings of other files"
    )
    console.print("\n".join(found.wrong))
    in_time, little = found.slowest < 2, found.growth < 300 << 20
    return found.refused >= 1000 and in_time and little and not found.wrong and not readings


PARTS = {
    "searches": searches,
    "databases": databases,
    "foraging": lambda place: forage(place, carry_out, console),
    "slopes": slopes,
    "page": lambda place: leave_open(place, console, MINUTES),
    "uploads": uploads,
}


def main(names: list[str]) -> None:
    if unknown := set(names) - PARTS.keys():
        sys.exit(f"parts must be of {', '.join(PARTS)}, got {', '.join(sorted(unknown))}")
    with (
        tempfile.TemporaryDirectory() as folder,
        running(Path(folder) / "data", SETTINGS) as place,
    ):
        good = [PARTS[name](place) for name in names or PARTS]
    sys.exit(not all(good))


if __name__ == "__main__":
    main(sys.argv[1:])
