"""Time of a NEAT generation, relative to neat-python's, and of evaluating networks.

Prints tables and asserts nothing. neat-python is compared with where it is installed: `make
peers`. Both run interleaved in one process; compilation is printed and not counted.
"""

import importlib
import importlib.util
import statistics
from types import ModuleType

import jax
import loops
import neat_python
from populations import INPUTS, OUTPUTS, Ours, grown

from microcosmos import device, genomes, search

POINTS = 64
HIDDEN = (10, 30)
SIZES = ((1_000, 11, 3), (10_000, 5, 1))
"""Networks, and how often ours and neat-python are timed, which is slow."""
FORWARD = 1_000


def main() -> None:
    device.prepare()
    peer = installed()
    for size, *repeats in SIZES:
        for hidden in HIDDEN:
            compare(peer, size, hidden, *repeats)
    for hidden in HIDDEN:
        forward(hidden)


def installed() -> ModuleType | None:
    """neat-python, or None if it is not installed."""
    if importlib.util.find_spec("neat"):
        return importlib.import_module("neat")
    print("neat-python is not installed: make peers\n")
    return None


def compare(peer: ModuleType | None, size: int, hidden: int, repeats: int, slow: int) -> None:
    """A row each: the median time of a generation, and its ratio."""
    ours = Ours(size, hidden)
    theirs = neat_python.Theirs(peer, size, hidden) if peer else None
    seconds: dict[str, list[float]] = {"ours": [], "neat-python": []}
    for repeat in range(repeats):
        seconds["ours"].append(ours.advance())
        if theirs and repeat < slow:
            seconds["neat-python"].append(theirs.advance())
    print(f"next generation of {size:,} networks, {repeats} and {slow} repeats, interleaved")
    for name, population in (("ours", ours), ("neat-python", theirs)):
        if population:
            nodes, connections, species = population.sizes()
            print(
                f"  {name:12} {1e3 * statistics.median(seconds[name]):9.1f} ms"
                f"   hidden {nodes:5.1f}  connections {connections:5.1f}  species {species}"
            )
    if theirs:
        ratio = statistics.median(seconds["neat-python"]) / statistics.median(seconds["ours"])
        print(
            f"  neat-python takes {ratio:.1f} times as long; compilation {ours.compiling:.1f} s"
        )
    print(flush=True)


def forward(hidden: int) -> None:
    """Networks a second on a batch of points, as creatures are evaluated."""
    networks, _ = grown(FORWARD, hidden)
    points = jax.random.normal(jax.random.key(1), (INPUTS, POINTS))
    program = jax.jit(
        lambda networks: search.mapped(
            lambda n: genomes.evaluate(n, points, OUTPUTS), networks
        ),
        compiler_options=device.compiler_options(),
    )
    jax.block_until_ready(program(networks))
    seconds = [loops.seconds(program, networks) for _ in range(11)]
    rate = FORWARD / statistics.median(seconds)
    print(f"forward, {hidden} hidden nodes: {rate:,.0f} networks × {POINTS} points a second")


if __name__ == "__main__":
    main()
