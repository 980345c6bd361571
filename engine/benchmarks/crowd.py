"""Many creatures in one fluid: the time of a step of the kernel beside that of its fluid.

Filaments of 24 nodes without senses bend in travelling waves and repel each other. Prints
tables and asserts nothing; worlds and numbers of threads take turns.
"""

import os
import statistics
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import jax.numpy as jnp
import numpy as np
import timing
from kernel import STIFF, Scene, program, scene

from microcosmos import bodies, device, fields, filaments, groups, world

REPEATS = 9
NODES = 24
CROWDS = ((256, 40, 200), (512, 167, 60), (1024, 670, 20))
"""Cells along each side, bodies, and steps of a repeat."""
THREADS = (1, 2)
STRENGTH, LIMIT = 4.0, 0.1


def main() -> None:
    device.prepare(devices=1)
    if not timing.installed("microcosmos_kernels"):
        return
    threads = [one for one in THREADS if one <= (os.cpu_count() or 1)]
    runs = {
        (side, count, number): parts_of(crowd(side, count, steps), number)
        for side, count, steps in CROWDS
        for number in threads
    }
    rounds = [{name: run() for name, run in runs.items()} for _ in range(REPEATS + 1)]
    # The first turn compiles and does not count.
    times = {name: [1e6 * one[name] for one in rounds[1:]] for name in runs}
    print(
        f"{device.device_kind()}; load {os.getloadavg()[0]:.1f}; {REPEATS} interleaved repeats"
    )
    print_steps(times, threads)
    print_parts(times)


def crowd(side: int, count: int, steps: int) -> Scene:
    """Return filaments in rows and columns, each turned at random, that repel each other."""
    one, random = bodies.chain(NODES, 1.0, **STIFF), np.random.default_rng(0)
    columns = int(np.ceil(np.sqrt(count)))
    places = (np.stack(np.divmod(np.arange(count), columns), 1) + 0.5) * side / columns
    turns = random.uniform(0, 2 * np.pi, count)
    body = bodies.combined(
        [bodies.placed(one, tuple(at), turn) for at, turn in zip(places, turns, strict=True)]
    )
    made = scene(body, (side, side), steps)
    angles, nothing = (
        filaments.edge_angles(made.start.positions, made.box.rods),
        jnp.zeros((0, 0)),
    )
    # The kernel needs no matrices, which would have the square of all nodes.
    layout = filaments.Layout(
        angle=angles,
        rest_angle=jnp.asarray(body.rest_angle, jnp.float32),
        turned=nothing,
        placed=nothing,
        pieces=groups.Groups(made.box.groups.member, body.count),
    )
    steric = fields.Steric(jnp.float32(STRENGTH), jnp.float32(LIMIT), fields.binomial)
    return replace(made, box=replace(made.box, layout=layout, steric=steric))


def parts_of(one: Scene, threads: int) -> Callable[[], np.ndarray]:
    """Return a program for the seconds that each part of a step takes."""
    run = program(one, partial(world.native.part_seconds, threads=threads))
    return lambda: np.asarray(run()) / len(one.rest.angle)


Times = dict[tuple[int, int, int], list[np.ndarray]]


def print_steps(times: Times, threads: list[int]) -> None:
    fluid, rows = world.native.PARTS.index("fluid"), []
    for (side, count, number), found in times.items():
        step = statistics.median(one.sum() for one in found)
        of_fluid = statistics.median(one[fluid] for one in found)
        ratio = statistics.median(one.sum() / one[fluid] for one in found)
        alone = times[side, count, threads[0]]
        gain = statistics.median(a.sum() / b.sum() for a, b in zip(alone, found, strict=True))
        row = (f"{side}², {count} bodies", str(number), f"{step:.0f}", f"{of_fluid:.0f}")
        rows.append((*row, f"{ratio:.2f}", f"{gain:.2f}"))
    head = ("world", "threads", "step", "fluid", "step / fluid", "gain by threads")
    timing.print_table("µs a step", head, rows)


def print_parts(times: Times) -> None:
    head = ("", *(f"{side}², {number} threads" for side, _, number in times))
    medians = [np.median(found, 0) for found in times.values()]
    rows = [
        (name, *(f"{one[place]:.0f}" for one in medians))
        for place, name in enumerate(world.native.PARTS)
    ]
    timing.print_table("µs of a step, by part", head, rows)


if __name__ == "__main__":
    main()
