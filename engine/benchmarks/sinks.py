"""The time of a run with sinks, beside that without: in turns, so that all see one machine.

`python engine/benchmarks/sinks.py [--rounds N] [--generations N]`
"""

import argparse
import os
import statistics
import sys
import tempfile
import time
from pathlib import Path
from typing import Any, NamedTuple

from microcosmos import spec
from microcosmos.archive.report import Report
from microcosmos.build.local import evolve
from microcosmos.device import prepare
from microcosmos.sinks import delivery

HANGS = (sys.executable, "-c", "import time; time.sleep(60)")
SINKS = {
    "none": (),
    "TensorBoard": ("tensorboard:events",),
    "hanging": ("tensorboard:events",),
}


class Times(NamedTuple):
    """From the first report until the archive is written, without the last deliveries."""

    wall: float
    cpu: float
    """Processor time of the run's own process."""
    calls: float
    """Spent in calls of the sinks, which is all that the run waits for."""


def measured(name: str, chosen: spec.Spec, folder: Path) -> Times:
    at: list[tuple[float, float]] = []
    calls: list[float] = []
    close, reported = delivery.Sinks.close, delivery.Sinks.report

    def timed(self: delivery.Sinks, report: Report) -> None:
        began = time.perf_counter()
        reported(self, report)
        calls.append(time.perf_counter() - began)

    def note(*given: Any, **options: Any) -> None:
        at.append((time.perf_counter(), time.process_time()))

    def note_and_close(*given: Any, **options: Any) -> None:
        note()
        close(*given, **options)

    command, patience = delivery.COMMAND, delivery.PATIENCE
    delivery.Sinks.close, delivery.Sinks.report = note_and_close, timed
    if name == "hanging":
        delivery.COMMAND, delivery.PATIENCE = HANGS, 0.0
    try:
        place = folder / f"{name}-{time.time()}.h5"
        evolve(chosen, place, sinks=SINKS[name], tell=lambda report: None if at else note())
    finally:
        delivery.Sinks.close, delivery.Sinks.report = close, reported
        delivery.COMMAND, delivery.PATIENCE = command, patience
    (wall, cpu), (end, last) = at[0], at[1]
    return Times(end - wall, last - cpu, sum(calls))


def main() -> None:
    options = argparse.ArgumentParser()
    options.add_argument("--rounds", type=int, default=7)
    options.add_argument("--generations", type=int, default=200)
    given = options.parse_args()
    prepare(cache=Path.home() / ".cache" / "microcosmos")
    preset = spec.EXPERIMENTS["quality-diversity"].presets[0].spec
    document = preset.model_dump(mode="json")
    document["search"]["generations"] = given.generations
    chosen = spec.parse(document)
    times: dict[str, list[Times]] = {name: [] for name in SINKS}
    with tempfile.TemporaryDirectory() as place:
        os.chdir(place)
        names = list(SINKS)
        for turn in range(given.rounds):
            for name in names[turn % len(names) :] + names[: turn % len(names)]:
                times[name].append(measured(name, chosen, Path(place)))
            said = (f"{name} {found[-1].wall:.2f} s" for name, found in times.items())
            print(*said, sep="  ", flush=True)
    for name, found in times.items():
        for kind in ("wall", "cpu"):
            pairs = [
                (getattr(one, kind), getattr(plain, kind))
                for one, plain in zip(found, times["none"], strict=True)
            ]
            ratios, fastest = (
                [one / plain for one, plain in pairs],
                map(min, zip(*pairs, strict=True)),
            )
            one, plain = fastest
            print(
                f"{name}: {kind} ratio {statistics.median(ratios):.3f} "
                f"({min(ratios):.3f} to {max(ratios):.3f} in {given.rounds} rounds), "
                f"of the fastest {one:.2f} s / {plain:.2f} s = {one / plain:.3f}"
            )
        shares = [one.calls / one.wall for one in found]
        print(f"{name}: {statistics.median(shares):.5f} of the time in calls of sinks")


if __name__ == "__main__":
    main()
