"""Acceptance checks: `make acceptance` repeats tests of `make test` at full size.

Presets over five seeds, whose elites are simulated again in variants that should not matter;
bodies that evolve, against frozen plans and chains, in a channel and past posts;
five searches at equal evaluations, five seeds each, submitted over HTTP; a run that is
killed, stopped, paused and resumed, whose archive has to be byte for byte the undisturbed
one, as has that of a second installation, on PostgreSQL and a Redis server; creatures that
sense and collect energy; searches with derivatives and without; a page that is left open for
half an hour, or for as many minutes as `MINUTES` says; thousands of malformed files; a
search on an emulated older processor; deaths of jobs and hosts; twenty hosts with 500 runs in a
bad night; the native kernel beside JAX in 200 random specs; and crowds of creatures in both,
with a ledger of their energy over 100,000 windows.
Names of parts choose some.
"""

import os
import random
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import malformed_hdf5
import rich
from cluster import cluster
from crowds_at_length import crowds
from databases import Missing, service_settings
from drive import (
    ROOT,
    Installation,
    interrupt,
    kill_job,
    pause_and_resume,
    running,
    stop_worker,
)
from group import group
from left_open import leave_open
from processors import processors
from searches import HOURS, METHODS, SEEDS, carry_out, compare, forage, spec
from slopes import compare_slopes
from swimming import swimming
from takeover import takeover
from uploads import all_cases, send, watched
from zoo import bodies

from microcosmos.spec.quality_diversity import PRESETS

FAULTS = (kill_job, stop_worker, kill_job, pause_and_resume, kill_job)
LATEST = 44
"""The last generation in which a fault may come."""
SETTINGS = {"MICROCOSMOS_DEMONSTRATION": "0", "MICROCOSMOS_CHECKPOINT_INTERVAL": "5"}


CONTAINERS = ("fronts", "dominated-novelty", "learned")


def contained(kind: str) -> dict[str, Any]:
    """A small search with a container."""
    document = PRESETS["demo"][1].model_dump(mode="json")
    document["archive"]["container"] = {"kind": kind}
    document["search"]["generations"] = 60
    return document


DOCUMENTS = {
    "chains": spec(SEEDS[0], "MAP-Elites, NEAT"),
    "zoo-demo": PRESETS["zoo-demo"][1].model_dump(mode="json"),
    **{kind: contained(kind) for kind in CONTAINERS},
}
"""Runs whose archives are compared byte for byte."""


def disturb(product: Installation, document: dict, undisturbed: bytes) -> bool:
    """Tell whether a run disturbed at random moments ends with the same bytes."""
    run = product.submit(document)
    moments = sorted(random.choices(range(1, LATEST + 1), k=len(FAULTS)))
    faults = list(zip(moments, FAULTS, strict=True))
    interrupt(product, run, faults, seconds=2 * HOURS)
    attempts = product.wait(run, "finished", seconds=2 * HOURS)["attempt"]
    names = ", ".join(f"{fault.__name__} at {moment}" for moment, fault in faults)
    return identical(product.archive(run), undisturbed, f"{names}: {attempts} attempts")


def identical(archive: bytes, expected: bytes, title: str) -> bool:
    same = archive == expected
    rich.print(f"{title}, {len(expected)} bytes {'identical' if same else 'DIFFERENT'}")
    return same


def searches(product: Installation) -> bool:
    """Tell whether searches beat random search, and a disturbed run ends as an undisturbed."""
    runs = {
        name: [carry_out(product, spec(s, name), f"{name}, seed {s}") for s in SEEDS]
        for name in METHODS
    }
    good = compare(product, runs)
    undisturbed = product.archive(runs["MAP-Elites, NEAT"][0]["id"])
    return disturb(product, DOCUMENTS["chains"], undisturbed) and good


def databases(product: Installation) -> bool:
    """Tell whether the same runs end with the same bytes on SQLite with the embedded Redis and,
    with faults, on PostgreSQL with a Redis server."""
    embedded = {
        name: product.archive(carry_out(product, document, f"{name}, SQLite")["id"])
        for name, document in DOCUMENTS.items()
    }
    good = []
    try:
        with (
            service_settings() as settings,
            running(product.folder.parent / "elsewhere", SETTINGS | settings) as other,
        ):
            for name, document in DOCUMENTS.items():
                title = f"{name}, PostgreSQL and a Redis server"
                archive = other.archive(carry_out(other, document, title)["id"])
                good.append(identical(archive, embedded[name], title))
                good.append(disturb(other, document, embedded[name]))
    except Missing as missing:
        rich.print(f"NOT SHOWN: {missing}")
        return False
    return all(good)


def uploads(product: Installation) -> bool:
    """Tell whether thousands of malformed files are refused in time, and no other is read."""
    canary = product.folder / "canary.h5"
    canary.write_bytes(malformed_hdf5.valid_file())
    with watched(canary) as readings:
        found = send(product, all_cases(canary))
    rich.print(
        f"{found.refused} malformed files: {len(found.wrong)} not refused as they should be, "
        f"the slowest in {found.slowest:.2f} s, {found.growth >> 20} MiB more memory at most, "
        f"{len(readings)} readings of other files"
    )
    print(*found.wrong, sep="\n")
    in_time, little = found.slowest < 2, found.growth < 300 << 20
    return found.refused >= 1000 and in_time and little and not found.wrong and not readings


def specs(_: Installation) -> bool:
    """Tell whether the native kernel finds in every random spec what JAX finds."""
    file = "tests/engine/search/test_native_specs.py"
    command = [sys.executable, "-m", "pytest", "-n", "auto", "--dist", "worksteal", file]
    environment = os.environ | {"MICROCOSMOS_TEST_ALL_SPECS": "1"}
    return subprocess.run(command, env=environment, cwd=ROOT).returncode == 0


PARTS = {
    "swimming": swimming,
    "bodies": bodies,
    "searches": searches,
    "databases": databases,
    "takeover": takeover,
    "group": group,
    "cluster": cluster,
    "foraging": forage,
    "slopes": compare_slopes,
    "page": leave_open,
    "uploads": uploads,
    "processors": processors,
    "specs": specs,
    "crowd": lambda _: crowds(),
}


def main(names: list[str]) -> None:
    if unknown := set(names) - PARTS.keys():
        sys.exit(f"parts must be of {', '.join(PARTS)}, got {', '.join(sorted(unknown))}")
    rich.reconfigure(width=110)
    with (
        tempfile.TemporaryDirectory() as folder,
        running(Path(folder) / "data", SETTINGS) as product,
    ):
        good = [PARTS[name](product) for name in names or PARTS]
    sys.exit(not all(good))


if __name__ == "__main__":
    main(sys.argv[1:])
