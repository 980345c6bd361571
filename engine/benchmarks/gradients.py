"""Time and memory of a gradient, relative to its simulation.

Prints tables and asserts nothing. Programs run interleaved in one process; memory is what the
compiled program holds beside its arguments. `autodiff` replaces `fluid/adjoint.py` by automatic
differentiation of the collision.
"""

import statistics
from collections.abc import Callable
from functools import partial
from math import isqrt
from typing import Any

import jax
import timing

from microcosmos import build, device, fluid, search, spec
from microcosmos.fluid import surroundings
from microcosmos.search import folding, gradients

SIZES = ((64, 32), (128, 128))
"""Cells along a side, and nodes."""
STEPS, REPEATS = 200, 5
FOLDING: dict[str, Any] = {}
"""Changes to the presets of folding, which make a test of this file small."""
ROOM = (8, 8)


def main() -> None:
    device.prepare()
    for size, nodes in SIZES:
        compare(size, nodes)
    fold()


def compare(size: int, nodes: int) -> None:
    """Print a row for the simulation and for each way to differentiate it."""
    scene = spec.Scene(
        world=spec.World(width=size, height=size),
        body=spec.Chain(nodes=nodes, spacing=0.5),
        task=spec.Task(steps=STEPS),
    )
    task = build.build_task(scene)
    encoding = build.build_encoding(scene, ROOM)
    creature = encoding.newcomer(key=jax.random.key(0))
    values = gradients.parts(task, creature, ("genes", "viscosity"))
    few = isqrt(STEPS)

    forward = partial(gradients.measures, task, creature)
    backward = partial(gradients.value_and_jacobian, task, creature)
    programs = {
        "simulation": compiled(forward, values),
        "gradient, autodiff": compiled(backward, values, fluid.collide),
        "gradient": compiled(backward, values),
        f"gradient, segments of {few}": compiled(partial(backward, segment=few), values),
    }
    calls = {name: partial(program, values) for name, program in programs.items()}
    seconds = timing.interleaved(calls, REPEATS)
    first, rows = statistics.median(seconds["simulation"]), []
    for name, program in programs.items():
        median = statistics.median(seconds[name])
        rows.append((name, f"{1e3 * median:.0f}", f"{median / first:.1f}", mebibytes(program)))
    title = f"{STEPS} steps of {nodes} nodes in {size} × {size} cells"
    timing.print_table(title, ("", "ms", "× the simulation", "MiB"), rows)


def fold() -> None:
    """Print a row for an update of one filament of the presets `digits` and `digits-fluid`."""
    presets = {preset.name: preset.spec for preset in spec.EXPERIMENTS["folding"].presets}
    few = {"memory": 0.1, "updates": 1}
    ways = {
        "without a fluid": (presets["digits"], {}, surroundings.collision),
        "in a fluid, autodiff": (presets["digits-fluid"], {}, fluid.collide),
        "in a fluid": (presets["digits-fluid"], {}, surroundings.collision),
        "in a fluid, in segments": (presets["digits-fluid"], few, surroundings.collision),
    }
    rows, nodes, steps = [], 0, 0
    for name, (chosen, changes, collision) in ways.items():
        chosen = spec.parse(chosen.model_dump(mode="json") | FOLDING)
        assert isinstance(chosen, spec.Folding)
        chosen = chosen.model_copy(update=changes)
        nodes, steps = len(spec.shape(chosen.body).positions), chosen.steps
        descent = build.build_descent(chosen)
        first = folding.start(descent, build.build_pictures(chosen)[:1])
        update = partial(search.mapped, partial(folding.update, descent))
        program = compiled(update, first, collision)
        median = statistics.median(timing.seconds(program, first) for _ in range(3))
        rows.append((name, f"{median:.2f}", mebibytes(program)))
    title = f"One update of {nodes:,} nodes through {steps} steps"
    timing.print_table(title, ("", "s", "MiB"), rows)


def mebibytes(program: Any) -> str:
    return f"{program.memory_analysis().temp_size_in_bytes / 2**20:.0f}"


def compiled(function: Callable, values: Any, collision: Any = surroundings.collision) -> Any:
    """Compile a function with `collision` in place of the engine's."""
    own, surroundings.collision = surroundings.collision, collision
    try:
        program = jax.jit(function, compiler_options=device.compiler_options())
        return program.lower(values).compile()
    finally:
        surroundings.collision = own


if __name__ == "__main__":
    main()
