"""Rollouts on an accelerator by number of worlds, and evaluations by size of the block.

Prints tables and asserts nothing; on a CPU, `physics.py` and `kernel.py` measure. Programs are
compiled side by side, then timed one after the other. Without the kernel for GPUs, which has no
other accelerator, XLA alone simulates.
"""

import statistics
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import physics
import timing

from microcosmos import bodies, device, filaments, search, world
from microcosmos.build import build_task
from microcosmos.build.scene import build_layout
from microcosmos.spec import EXPERIMENTS

WORLDS = (64, 1024, 8192)
BLOCKS = (16, 64, 256, 1024, 4096)
PRESETS = ("demo", "standard")
REPEATS = 5
LARGE = 2**29
"""Values of the copied array: a copy takes far longer than its start."""


def main() -> None:
    device.prepare()
    if jax.default_backend() == "cpu":
        print("(no accelerator)")
        return
    copy = jax.jit(lambda x: x + 1)
    bandwidth = 2 * 4 * LARGE / median(copy, jnp.zeros(LARGE, jnp.float32))
    print(f"{device.device_kind()}\ncopy bandwidth {bandwidth / 1e9:.0f} GB/s", flush=True)
    print_rollouts(bandwidth)
    print_evaluations()


def print_rollouts(bandwidth: float) -> None:
    """Print the time of a step of `physics.scene`, whose body is matched."""
    ways: dict[str, Callable] = {"XLA": world.rollout}
    if device.has_gpu_kernel():
        ways["kernel"] = world.gpu.rollout
    cases = [(name, count) for name in ways for count in WORLDS]
    programs = compiled([rollouts(ways[name], count) for name, count in cases])
    rows, cells = [], physics.SIZE[0] * physics.SIZE[1]
    for (name, count), (program, given) in zip(cases, programs, strict=True):
        step = median(program, given) / physics.STEPS
        mlups = count * cells / step / 1e6
        share = 1e6 * mlups * physics.CELL_BYTES / bandwidth
        each = 1e6 * step / count
        rows.append(
            (
                name,
                f"{count:,}",
                f"{1e6 * step:.1f}",
                f"{each:.3f}",
                f"{mlups:,.0f}",
                f"{share:.0%}",
            )
        )
    columns = ("", "worlds", "µs/step", "µs/world and step", "MLUPS", "of the copy bandwidth")
    size, nodes = physics.SIZE, physics.NODES
    timing.print_table(f"{size[0]} × {size[1]} cells, {nodes} nodes", columns, rows)


def rollouts(rollout: Callable, count: int) -> tuple[Callable, Any]:
    """Return a program of rollouts in `count` worlds with one start, and its rest shapes."""
    body = bodies.chain(physics.NODES, 1.0, stretch=1.0, shear=1.0, bend=1.0)
    box, starts, rests = physics.scene()
    box = replace(box, layout=build_layout(body, jnp.float32))
    start = jax.tree.map(lambda x: x[0], starts)
    rows = np.arange(count) % physics.WORLDS
    given = filaments.Rest(rests.angle[rows], rests.length[rows])

    def positions(rest: filaments.Rest):
        end, _ = rollout(box, start, rest)
        return end.populations, end.positions

    return search.block_program(positions), given


def print_evaluations() -> None:
    """Print the creatures that are evaluated in a second, by preset and block."""
    presets: dict[str, Any] = {
        one.name: one.spec for one in EXPERIMENTS["quality-diversity"].presets
    }
    cases = [(name, block) for name in PRESETS for block in BLOCKS]
    tasks = {name: build_task(presets[name].scene) for name in PRESETS}
    programs = compiled([evaluations(tasks[name], block) for name, block in cases])
    rows = []
    for (name, block), (program, given) in zip(cases, programs, strict=True):
        seconds = median(program, given)
        rows.append((name, f"{block:,}", f"{1e3 * seconds:.1f}", f"{block / seconds:,.0f}"))
    timing.print_table("Evaluations", ("", "block", "ms/block", "creatures/s"), rows)


def evaluations(task: search.Task, block: int) -> tuple[Callable, Any]:
    """Return a program that evaluates newcomers, and the newcomers."""
    encoding = task.encoding
    assert encoding is not None
    keys = jax.random.split(jax.random.key(0), block)
    given = jax.vmap(lambda key: encoding.newcomer(key=key))(keys)
    return search.block_program(lambda one: search.evaluate(task, one)), given


def compiled(programs: list[tuple[Any, Any]]) -> list[tuple[Callable, Any]]:
    lowered = [program.lower(given) for program, given in programs]
    with ThreadPoolExecutor() as pool:
        programs_compiled = list(pool.map(lambda one: one.compile(), lowered))
    return [
        (program, given)
        for program, (_, given) in zip(programs_compiled, programs, strict=True)
    ]


def median(program: Callable, given: Any) -> float:
    """Return the seconds of a call; the first is not timed."""
    timing.seconds(program, given)
    return statistics.median(timing.seconds(program, given) for _ in range(REPEATS))


if __name__ == "__main__":
    main()
