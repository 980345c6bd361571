"""The cost of a step of the native kernel, beside the least that this machine needs.

Prints tables and asserts nothing; `--picture FILE` also draws the step over sizes of worlds and
numbers of nodes. `machine.cpp`, built here with the C++ compiler of the system, measures the
machine: the bandwidth of the cache, and a fluid by the usual method with two copies. Everything
runs on one core and takes turns.
"""

import argparse
import ctypes
import os
import shutil
import statistics
import subprocess
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import timing
from kernel import STIFF, Scene, in_jax, program, scene, shoal

from microcosmos import bodies, device, world

REPEATS = 7
CELLS = 2**25
"""Cells that a pass over the populations reads and writes in a repeat; steps update fewer."""
SIDES = (32, 64, 128, 256, 512, 1024)
CROWDS = (20, 80, 320, 1_280, 5_120, 16_000)
CROWDED = 256
"""Cells along each side of the box of `CROWDS`."""
WINDOW, DESCRIBED = 16, 40
"""Cells of a point's window, and the bytes that describe it: eight weights and two places."""
PAIR = 8
"""Bytes of a vector of a cell or a node."""


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--picture", type=Path)
    picture = options.parse_args().picture
    device.prepare(devices=1)
    if not timing.installed("microcosmos_kernels"):
        return
    compiler = shutil.which(os.environ.get("CXX") or "c++")
    if compiler is None:
        print("SKIPPED: the budget of a step, since there is no C++ compiler")
        return
    with tempfile.TemporaryDirectory() as folder:
        machine = Machine(compiler, Path(folder))
        sizes = over_sizes(machine)
        budget("64 × 64 cells, 32 nodes, matched", alone(64), machine)
        budget(
            "256 × 256 cells, 980 nodes, swept", scene(shoal(7, 20), (256, 256), 100), machine
        )
    crowds = over_nodes()
    if picture:
        draw(sizes, crowds, picture)


class Machine:
    """Times of `machine.cpp`, in seconds."""

    def __init__(self, compiler: str, folder: Path):
        library = folder / "machine.so"
        source = Path(__file__).with_name("machine.cpp")
        options = ["-std=c++17", "-O3", "-march=native", "-ffast-math", "-shared", "-fPIC"]
        subprocess.run([compiler, *options, source, "-o", library], check=True)
        self._library = ctypes.CDLL(str(library))
        self._library.in_place.argtypes = [ctypes.c_size_t, ctypes.c_int]
        for one in (self._library.in_place, self._library.lattice):
            one.restype = ctypes.c_double

    def pass_over_populations(self, side: int) -> float:
        """Return the time to read and write the nine populations of a box once."""
        return self._library.in_place(9 * side * side, max(1, CELLS // side**2))

    def two_copies(self, side: int) -> float:
        """Return the time of a step of the fluid by two copies of its populations."""
        return self._library.lattice(side, side, max(1, CELLS // side**2 // 8))


def alone(side: int) -> Scene:
    """Return the scene of one filament in a box."""
    steps = max(50, CELLS // side**2 // 16)
    return scene(bodies.chain(32, 1.0, **STIFF), (side, side), min(steps, 1_000), matched=True)


def part_seconds(one: Scene) -> Callable[[], np.ndarray]:
    """Return a program for the time of each part of a step."""
    run = program(one, world.native.part_seconds)
    return lambda: np.asarray(run()) / len(one.rest.angle)


def fluid_seconds(one: Scene) -> Callable[[], float]:
    run, fluid = part_seconds(one), world.native.PARTS.index("fluid")
    return lambda: float(run()[fluid])


def over_sizes(machine: Machine) -> dict[str, list[float]]:
    """Print and return µs a step over the sizes of a box with one filament."""
    times: dict[str, list[float]] = {}
    for side in SIDES:
        one = alone(side)
        measured: dict[str, Callable[[], float]] = {
            "one pass": partial(machine.pass_over_populations, side),
            "two copies": partial(machine.two_copies, side),
            "fluid of the kernel": fluid_seconds(one),
            "step of the kernel": stepping(one, world.native.rollout),
            "step of JAX": stepping(one, in_jax),
        }
        for name, values in taking_turns(measured).items():
            times.setdefault(name, []).append(1e6 * statistics.median(values))
    rows = [
        (f"{side}²", *(f"{times[name][n]:.1f}" for name in times), *speeds(times, n, side))
        for n, side in enumerate(SIDES)
    ]
    head = ("cells", *times, "pass, GB/s", "two copies, MLUPS", "kernel's fluid, MLUPS")
    timing.print_table("µs, one filament of 32 nodes", head, rows)
    return times


def speeds(times: dict[str, list[float]], n: int, side: int) -> list[str]:
    bandwidth = 2 * 4 * 9 * side**2 / times["one pass"][n] / 1e3
    updates = [side**2 / times[name][n] for name in ("two copies", "fluid of the kernel")]
    return [f"{one:.0f}" for one in (bandwidth, *updates)]


def stepping(one: Scene, step: Callable) -> Callable[[], float]:
    run = program(one, step)
    return lambda: timing.seconds(run) / len(one.rest.angle)


def taking_turns(measured: dict[str, Callable[[], Any]]) -> dict[str, list[Any]]:
    """Return what programs measure; the first turn compiles and does not count."""
    rounds = [{name: one() for name, one in measured.items()} for _ in range(REPEATS + 1)]
    return {name: [one[name] for one in rounds[1:]] for name in measured}


def budget(title: str, one: Scene, machine: Machine) -> None:
    """Print the time of each part of a step, and that of moving its data through the cache."""
    side = one.box.size[0]
    measured = {
        "pass": partial(machine.pass_over_populations, side),
        "parts": part_seconds(one),
    }
    times = taking_turns(measured)
    parts: dict[str, float] = dict(
        zip(world.native.PARTS, np.median(times["parts"], 0), strict=True)
    )
    bandwidth = 2 * 4 * 9 * side**2 / statistics.median(times["pass"])
    rows, sums = [], [0.0, 0.0]
    for name, moved in moved_bytes(one).items():
        least, spent = 1e6 * moved / bandwidth, 1e6 * parts[name]
        sums = [sums[0] + spent, sums[1] + least]
        rows.append((name, f"{spent:.2f}", f"{moved / 1e3:.0f}", f"{least:.2f}"))
    rows.append(("together", f"{sums[0]:.2f}", "", f"{sums[1]:.2f}"))
    head = ("part", "µs", "kB moved", f"µs at {bandwidth / 1e9:.0f} GB/s")
    timing.print_table(title, head, rows)


def moved_bytes(one: Scene) -> dict[str, int]:
    """Return the bytes that each part of a step reads and writes at least."""
    nodes, cells = len(one.start.positions), one.box.size[0] * one.box.size[1]
    form, window = one.box.form, WINDOW * PAIR
    scalar = window // 2
    spread = DESCRIBED + PAIR + 2 * window
    interpolate = DESCRIBED + window + PAIR
    improve = 6 * PAIR + 4  # Target and force both ways, velocity, what is reached; beta.
    more = form.forcing_iterations - 1
    first = 2 * DESCRIBED + 4 * scalar + 4  # Coverage, and beta from it and the density.
    again = more * (spread + interpolate + scalar)
    return {
        "windows": nodes * (PAIR + DESCRIBED),
        "moments": touched_cells(one) * (9 * 4 + PAIR + 4),
        "interpolation": nodes * interpolate,
        "constraints": nodes * 5 * PAIR,  # Velocity, both positions, rest shape, target.
        "forcing": nodes * (first + again + form.forcing_iterations * improve + 2 * PAIR),
        "spreading": nodes * spread,
        "measures": nodes * 5 * PAIR,
        "fluid": cells * 2 * 9 * 4,
    }


def touched_cells(one: Scene) -> int:
    """Return the number of cells in windows at the start."""
    first = np.floor(np.asarray(one.start.positions) - 0.5).astype(int)
    offsets = np.stack(np.meshgrid(range(4), range(4)), -1).reshape(-1, 2)
    every = (first[:, None] + offsets) % np.array(one.box.size)
    return len(np.unique(every.reshape(-1, 2), axis=0))


def over_nodes() -> dict[str, list[float]]:
    """Print and return µs a step over numbers of nodes."""
    times: dict[str, list[float]] = {}
    for nodes in CROWDS:
        one = scene(rows_of_filaments(nodes // 20), (CROWDED, CROWDED), 50)
        measured = {
            "step of the kernel": stepping(one, world.native.rollout),
            "step of JAX": stepping(one, in_jax),
        }
        for name, values in taking_turns(measured).items():
            times.setdefault(name, []).append(1e6 * statistics.median(values))
    ratios = np.divide(times["step of JAX"], times["step of the kernel"])
    rows = [
        (f"{nodes:,}", *(f"{times[name][n]:.0f}" for name in times), f"{ratios[n]:.1f}")
        for n, nodes in enumerate(CROWDS)
    ]
    title = f"µs, filaments of 20 nodes in {CROWDED} × {CROWDED} cells, swept"
    timing.print_table(title, ("nodes", *times, "ratio"), rows)
    return times


def rows_of_filaments(count: int) -> bodies.Body:
    """Return filaments of 20 nodes in up to ten columns, at equal distances."""
    one, columns = bodies.chain(20, 1.0, **STIFF), min(count, 10)
    rows = -(-count // columns)
    places = [
        (CROWDED * (n // columns + 0.5) / rows, CROWDED * (n % columns + 0.5) / columns)
        for n in range(count)
    ]
    return bodies.combined([bodies.placed(one, place, np.pi / 2) for place in places])


def draw(sizes: dict[str, list[float]], crowds: dict[str, list[float]], file: Path) -> None:
    """Draw the time of a step over sizes of boxes and over numbers of nodes."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10, 4), layout="constrained")
    left, right = figure.subplots(1, 2)
    looks = {
        "one pass": (":", "one pass over the populations"),
        "two copies": ("--", "fluid with two copies of its populations"),
    }
    for name, values in sizes.items():
        look, label = looks.get(name, ("o-", name))
        left.plot(SIDES, values, look, label=label)
    for name, values in crowds.items():
        colour = next(line.get_color() for line in left.lines if line.get_label() == name)
        right.plot(CROWDS, values, "o-", color=colour, label=name)
    for panel, what in ((left, "cells along a side"), (right, f"nodes in {CROWDED}² cells")):
        panel.set(xscale="log", yscale="log", xlabel=what, ylabel="time of a step [µs]")
        panel.spines[["top", "right"]].set_visible(False)
        panel.legend(frameon=False, fontsize=8)
    left.set_xticks(SIDES, [str(side) for side in SIDES])
    left.minorticks_off()
    figure.savefig(file, dpi=150)


if __name__ == "__main__":
    main()
