"""Time of a NEAT generation, relative to neat-python's, and of evaluating networks.

Prints tables and asserts nothing. `make peers` installs neat-python. Both libraries run
interleaved in one process; the time of compilation is printed apart.
"""

import importlib
import statistics
from functools import partial
from types import ModuleType
from typing import Any

import jax
import neat_python
import timing
from populations import INPUTS, OUTPUTS, OurPopulation, grown

from microcosmos import device, genomes, search

POINTS = 64
HIDDEN = (10, 30)
SIZES = ((1_000, 11, 3), (10_000, 5, 1))
"""Networks, repeats of ours, and fewer repeats of neat-python, which is slow."""
FORWARD = 1_000


def main() -> None:
    device.prepare()
    peer = importlib.import_module("neat") if timing.installed("neat") else None
    for size, *repeats in SIZES:
        for hidden in HIDDEN:
            compare(peer, size, hidden, *repeats)
    for hidden in HIDDEN:
        forward(hidden)


def compare(peer: ModuleType | None, size: int, hidden: int, repeats: int, theirs: int) -> None:
    """Print a row for each library: the median time of a generation, and its ratio."""
    ours = OurPopulation(size, hidden)
    libraries: dict[str, tuple[Any, int]] = {"ours": (ours, repeats)}
    if peer:
        libraries["neat-python"] = (neat_python.NeatPython(peer, size, hidden), theirs)
    seconds: dict[str, list[float]] = {name: [] for name in libraries}
    for repeat in range(repeats):
        for name, (population, count) in libraries.items():
            if repeat < count:
                seconds[name].append(population.advance())
    rows, first = [], statistics.median(seconds["ours"])
    for name, (population, _) in libraries.items():
        nodes, connections, species = population.sizes()
        median = statistics.median(seconds[name])
        sizes = (f"{nodes:.1f}", f"{connections:.1f}", f"{species}")
        rows.append((name, f"{1e3 * median:.1f}", f"{median / first:.1f}", *sizes))
    title = f"Next generation of {size:,} networks, {repeats} and {theirs} repeats, interleaved"
    columns = ("", "ms", "× ours", "hidden nodes", "connections", "species")
    timing.print_table(f"{title}; compilation {ours.compilation:.1f} s", columns, rows)


def forward(hidden: int) -> None:
    """Print the networks per second on a batch of points, evaluated as creatures are."""
    networks, _ = grown(FORWARD, hidden)
    points = jax.random.normal(jax.random.key(1), (INPUTS, POINTS))
    evaluate = partial(search.mapped, lambda n: genomes.evaluate(n, points, OUTPUTS))
    program = jax.jit(evaluate, compiler_options=device.compiler_options())
    jax.block_until_ready(program(networks))
    rate = FORWARD / statistics.median(timing.seconds(program, networks) for _ in range(11))
    print(f"forward, {hidden} hidden nodes: {rate:,.0f} networks × {POINTS} points a second")


if __name__ == "__main__":
    main()
