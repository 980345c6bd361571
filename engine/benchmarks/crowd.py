"""Many creatures in one fluid: the time of a step of the kernel beside that of its fluid.

Filaments of 24 nodes with networks of their own swim in slots, in closed loop, and touch each
other; the same, with senses and food. Prints tables and asserts nothing; worlds and numbers of
threads take turns.
"""

import os
import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
import timing

from microcosmos import device, fields, genomes, spec, world
from microcosmos.build import build_task
from microcosmos.genomes.living import newborn
from microcosmos.world import slots

REPEATS = 9
CROWDS = ((256, 40, 200), (512, 167, 60), (1024, 670, 20))
"""Cells along each side, creatures, and steps of a repeat."""
THREADS = (1, 2)
EVERY, PERIOD = 4, 200.0
ROOM = (24, 64)
BIRTHS = 50
PARTS = len(world.native.PARTS)


@dataclass
class Crowd:
    """A world with slots, each of which holds a creature."""

    place: world.World
    held: slots.Slots
    living: slots.Living


def main() -> None:
    device.prepare(devices=1)
    if not timing.installed("microcosmos_kernels"):
        return
    threads = [one for one in THREADS if one <= (os.cpu_count() or 1)]
    runs = {
        (side, count, alive, number): parts_of(crowd(side, count, alive=alive), steps, number)
        for side, count, steps in CROWDS
        for alive in (False, True)
        for number in threads
    }
    rounds = [{name: run() for name, run in runs.items()} for _ in range(REPEATS + 1)]
    # The first turn compiles and does not count.
    times = {name: [1e6 * one[name] for one in rounds[1:]] for name in runs}
    print(
        f"{device.device_kind()}; load {os.getloadavg()[0]:.1f}; {REPEATS} interleaved repeats"
    )
    print_steps(times, threads)
    print_parts({name: found for name, found in times.items() if name[2]})
    print_birth(crowd(*CROWDS[0][:2], alive=True))


def crowd(side: int, count: int, *, alive: bool) -> Crowd:
    """Return filaments at random places; `alive`: they sense and eat too."""
    scene = spec.Scene.model_validate(
        {"world": {"width": side, "height": side}, "body": {"nodes": 24}}
    )
    task = build_task(scene, room=ROOM)
    senses = tuple(one for one in world.SENSES if alive)
    encoding = task.encoding
    assert isinstance(encoding, genomes.CPPNControl)
    encoding = replace(encoding, controls=replace(encoding.controls, senses=senses))
    place = replace(task.world, food=food(side) if alive else None, contact=contact())

    @jax.jit
    def made(key):
        driven = encoding.drive(task.world, task.start, encoding.newcomer(key=key), None)
        return newborn(driven, task.actuators, PERIOD, PERIOD)

    random = np.random.default_rng(0)
    held, living = slots.empty(place, task.start, made(jax.random.key(0))[0], count)
    birth = jax.jit(slots.born)
    for number in range(count):
        one, positions = made(jax.random.key(number))
        turn = random.uniform(0, 2 * np.pi)
        c, s = np.cos(turn), np.sin(turn)
        middle = random.uniform(0, side, 2)
        at = np.float32(np.asarray(positions) @ np.array([[c, s], [-s, c]]) + middle)
        held, living = birth(held, living, number, one, at, number)
    return Crowd(place, held, living)


def contact() -> fields.Contact:
    return fields.Contact(jnp.float32(4.0), jnp.float32(0.1))


def food(side: int) -> fields.Food:
    numbers = {"bite": 2e4, "regrowth": 2e-4, "decay": 0.0, "diffusion": 0.01}
    capacity = jnp.full((side, side), 2**20, jnp.int32)
    scales = {"unit": 2.0**20, "full": 2.0**26}
    given = {name: jnp.float32(value) for name, value in (numbers | scales).items()}
    return fields.Food(capacity, **given)


def parts_of(one: Crowd, steps: int, threads: int) -> Callable[[], np.ndarray]:
    """Return a program for the seconds that each part of a step takes, those of the whole call
    and, as the last, the share of creatures that touch others in a step. Each call goes on from
    the one before."""
    run = jax.jit(
        partial(world.native.part_seconds_of_slots, steps=steps, every=EVERY, threads=threads)
    )
    state = [one.living]

    def measured() -> np.ndarray:
        start = time.perf_counter()
        state[0], tally, seconds = jax.block_until_ready(run(one.place, one.held, state[0]))
        whole = time.perf_counter() - start
        # In millionths, as the times are.
        touch = 1e-6 * float(jnp.mean(tally.touched))
        return np.append(seconds, [whole, touch]) / steps

    return measured


Times = dict[tuple[int, int, bool, int], list[np.ndarray]]


def print_steps(times: Times, threads: list[int]) -> None:
    fluid, rows = world.native.PARTS.index("fluid"), []
    for (side, count, alive, number), found in times.items():
        step = statistics.median(one[:PARTS].sum() for one in found)
        whole, touch = (statistics.median(one[at] for one in found) for at in (-2, -1))
        of_fluid = statistics.median(one[fluid] for one in found)
        ratio = statistics.median(one[:PARTS].sum() / one[fluid] for one in found)
        alone = times[side, count, alive, threads[0]]
        gain = statistics.median(
            a[:PARTS].sum() / b[:PARTS].sum() for a, b in zip(alone, found, strict=True)
        )
        numbers = (f"{one:.0f}" for one in (whole, step, of_fluid))
        row = (f"{side}², {count} creatures", "all" if alive else "touch", str(number))
        rows.append((*row, *numbers, f"{ratio:.2f}", f"{gain:.2f}", f"{touch:.2f}"))
    head = ("world", "they", "threads", "call", "step", "fluid", "step / fluid", "gain")
    head = (*head, "touching")
    timing.print_table("µs a step; all: they sense and eat too", head, rows)


def print_parts(times: Times) -> None:
    head = ("", *(f"{side}², {number} threads" for side, _, _, number in times))
    medians = [np.median(found, 0) for found in times.values()]
    rows = [
        (name, *(f"{one[place]:.0f}" for one in medians))
        for place, name in enumerate(world.native.PARTS)
    ]
    timing.print_table("µs of a step, by part", head, rows)


def print_birth(one: Crowd) -> None:
    """Print the time of a birth and of a death, which compile nothing."""
    birth, death = jax.jit(slots.born), jax.jit(slots.removed)
    occupant = jax.tree.map(lambda x: x[0], one.held.occupants)
    held, living = one.held, one.living
    times: dict[str, list[float]] = {"birth": [], "death": []}
    for number in range(BIRTHS + 1):
        slot, start = number % len(held.filled), time.perf_counter()
        held = jax.block_until_ready(death(held, slot))
        between = time.perf_counter()
        held, living = jax.block_until_ready(
            birth(held, living, slot, occupant, living.positions[1], 10**6 + number)
        )
        times["death"].append(between - start)
        times["birth"].append(time.perf_counter() - between)
    rows = [(name, f"{1e6 * statistics.median(all_[1:]):.0f}") for name, all_ in times.items()]
    timing.print_table("µs of one", ("", "time"), rows)


if __name__ == "__main__":
    main()
