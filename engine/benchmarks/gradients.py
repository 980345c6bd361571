"""Time and memory of a gradient, relative to its simulation.

Prints a table and asserts nothing. Programs run interleaved in one process; memory is what
the compiled program holds beside its arguments. `autodiff` differentiates the collision
automatically, as `fluid/adjoint.py` would otherwise be.
"""

import statistics
from collections.abc import Callable
from functools import partial
from math import isqrt
from typing import Any

import jax
import loops
from rich.console import Console
from rich.table import Table

from microcosmos import build, device, fluid, search, spec
from microcosmos.fluid import surroundings
from microcosmos.search import folding, gradients

SIZES = ((64, 32), (128, 128))
"""Cells along a side, and nodes."""
STEPS, REPEATS = 200, 5
ROOM = (8, 8)


def main() -> None:
    device.prepare()
    for size, nodes in SIZES:
        compare(size, nodes)
    fold()


def compare(size: int, nodes: int) -> None:
    """A row for the simulation and for each way to differentiate it."""
    scene = spec.Scene.model_validate(
        {
            "world": {"width": size, "height": size},
            "body": {"nodes": nodes, "spacing": 0.5},
            "task": {"steps": STEPS},
        }
    )
    task = build.build_task(scene)
    encoding = build.build_encoding(scene, ROOM)
    creature = encoding.newcomer(key=jax.random.key(0))
    values = gradients.parts(task, creature, ("genes", "viscosity"))
    few = isqrt(STEPS)

    def forward(values):
        return gradients.measures(task, creature, values)

    def backward(segment=None):
        return lambda values: gradients.value_and_jacobian(
            task, creature, values, segment=segment
        )

    ways = {
        "simulation": compiled(forward, values),
        "gradient, autodiff": compiled(backward(), values, fluid.collide),
        "gradient": compiled(backward(), values),
        f"gradient, segments of {few}": compiled(backward(few), values),
    }
    seconds: dict[str, list[float]] = {name: [] for name in ways}
    for _ in range(REPEATS):
        for name, program in ways.items():
            seconds[name].append(loops.seconds(program, values))
    table = Table(
        "",
        "ms",
        "× the simulation",
        "MiB",
        title=f"{STEPS} steps of {nodes} nodes in {size} × {size} cells",
    )
    first = statistics.median(seconds["simulation"])
    for name, program in ways.items():
        median = statistics.median(seconds[name])
        memory = program.memory_analysis().temp_size_in_bytes / 2**20
        table.add_row(name, f"{1e3 * median:.0f}", f"{median / first:.1f}", f"{memory:.0f}")
    Console().print(table)


def fold() -> None:
    """A row for an update of one filament of the presets `digits` and `digits-fluid`."""
    presets = {preset.name: preset.spec for preset in spec.EXPERIMENTS["folding"].presets}
    few = {"memory": 0.1, "updates": 1}
    ways = {
        "without a fluid": (presets["digits"], {}, surroundings.collision),
        "in a fluid, autodiff": (presets["digits-fluid"], {}, fluid.collide),
        "in a fluid": (presets["digits-fluid"], {}, surroundings.collision),
        "in a fluid, in segments": (presets["digits-fluid"], few, surroundings.collision),
    }
    table = Table("", "s", "MiB", title="One update of 1,000 nodes through 250 steps")
    for name, (chosen, changes, collision) in ways.items():
        assert isinstance(chosen, spec.Folding)
        chosen = chosen.model_copy(update=changes)
        descent = build.build_descent(chosen)
        first = folding.start(descent, build.build_pictures(chosen)[:1])
        program = compiled(
            lambda block, d=descent: search.mapped(partial(folding.update, d), block),
            first,
            collision,
        )
        seconds = [loops.seconds(program, first) for _ in range(3)]
        memory = program.memory_analysis().temp_size_in_bytes / 2**20
        table.add_row(name, f"{statistics.median(seconds):.2f}", f"{memory:.0f}")
    Console().print(table)


def compiled(
    function: Callable, values: Any, collision: Callable = surroundings.collision
) -> Any:
    """The program, with such a collision."""
    own, surroundings.collision = surroundings.collision, collision
    try:
        program = jax.jit(function, compiler_options=device.compiler_options())
        return program.lower(values).compile()
    finally:
        surroundings.collision = own


if __name__ == "__main__":
    main()
