"""The native kernel beside JAX: whole rollouts of the same worlds, and the parts of a step.

Prints tables and asserts nothing. Every program runs on one core; those of a table take turns.
"""

import importlib
import os
import statistics
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import timing

from microcosmos import bodies, device, filaments, groups, search, world
from microcosmos.build import build_rods, build_task
from microcosmos.build.experiments import build_crowd, room_of
from microcosmos.build.scene import build_layout
from microcosmos.spec import EXPERIMENTS, QualityDiversity, Scaling

REPEATS, CREATURES = 9, 8
STEPS = 1_000
"""Steps of a small world; larger ones take fewer."""
CROWDS = (16_000, 128_000, 500_000)
"""Nodes in the box of `scaling/paper`."""
PRESETS = tuple(
    one.name for one in EXPERIMENTS["quality-diversity"].presets if one.name != "paper"
)
STIFF = {"stretch": 1.0, "shear": 1.0, "bend": 1.0}


@dataclass(frozen=True)
class Scene:
    box: world.World
    start: world.State
    rest: filaments.Rest


def main() -> None:
    device.prepare(devices=1)
    if not timing.installed("microcosmos_kernels"):
        return
    print(f"{device.device_kind()}; one core; medians of {REPEATS} interleaved repeats\n")
    body = bodies.chain(32, 1.0, **STIFF)
    scenes = {
        "64 × 64, a filament of 32 nodes, matched": scene(body, (64, 64), STEPS, matched=True),
        "64 × 64, the same swept 10 times": scene(body, (64, 64), STEPS),
        "64 × 64, a star of 33 nodes, matched": scene(
            bodies.star(4, 8, 1.0, **STIFF), (64, 64), STEPS, matched=True
        ),
        "64 × 64, the same swept": scene(bodies.star(4, 8, 1.0, **STIFF), (64, 64), STEPS),
        "128 × 128, 9 filaments of 20 nodes, swept": scene(
            shoal(3, 20), (128, 128), STEPS * 3 // 10
        ),
        "256 × 256, 49 filaments of 20 nodes, swept": scene(
            shoal(7, 20), (256, 256), STEPS // 10
        ),
    }
    rollouts(scenes)
    parts(scenes)
    crowds()
    evaluations()


def scene(
    body: bodies.Body, size: tuple[int, int], steps: int, *, matched: bool = False
) -> Scene:
    """Return a world with bodies that bend in a travelling wave."""
    limits = world.Limits(jnp.float32(0.1), jnp.float32(0.1))
    box = world.World(
        jnp.float32(0.05),
        build_rods(body),
        groups.Groups(jnp.asarray(body.member, jnp.int32), body.count),
        size,
        limits=limits,
        layout=build_layout(body) if matched else None,
    )
    middle = body.positions - body.positions.mean(0) + np.array(size) / 2
    time = np.arange(steps)[:, None] / 200
    joint = np.arange(len(body.joints))[None] / len(body.joints)
    wave = 0.15 * np.minimum(time, 1) * np.sin(2 * np.pi * (joint - time))
    angle = jnp.asarray(body.rest_angle[None] + wave, jnp.float32)
    length = jnp.asarray(np.tile(body.rest_length, (steps, 1)), jnp.float32)
    start = world.at_rest(box, jnp.asarray(middle, jnp.float32))
    return Scene(box, start, filaments.Rest(angle, length))


def shoal(side: int, nodes: int) -> bodies.Body:
    """Return filaments in rows and columns, each turned at random."""
    one, rng = bodies.chain(nodes, 1.0, **STIFF), np.random.default_rng(0)
    places = [(36.0 * (i + 0.5), 36.0 * (j + 0.5)) for i in range(side) for j in range(side)]
    return bodies.combined([bodies.placed(one, p, rng.uniform(0, 6.28)) for p in places])


def program(one: Scene, step: Callable) -> Callable[[], Any]:
    compiled = jax.jit(
        lambda start, rest: step(one.box, start, rest),
        compiler_options=device.compiler_options(),
    )
    return lambda: compiled(one.start, one.rest)


def in_jax(box: world.World, start: world.State, rest: filaments.Rest) -> Any:
    return world.rollout(box, start, rest, search.measures.observe)


def rollouts(scenes: dict[str, Scene]) -> None:
    """Print the time of a step by JAX and by the kernel with each instruction set."""
    kernels: Any = importlib.import_module("microcosmos_kernels")
    sets, rows = kernels.instruction_sets(), []
    for name, one in scenes.items():
        programs = {"JAX": program(one, in_jax)}
        for chosen in sets:
            native = partial(world.native.rollout, instruction_set=chosen)
            programs[chosen] = program(one, native)
        for run in programs.values():
            timing.seconds(run)  # Compiles.
        times = timing.interleaved(programs, REPEATS)
        micro = {
            key: 1e6 * statistics.median(values) / len(one.rest.angle)
            for key, values in times.items()
        }
        ratio = f"{micro['JAX'] / micro[sets[-1]]:.1f}"
        rows.append((name, *(f"{value:.1f}" for value in micro.values()), ratio))
    timing.print_table("µs a step", ("", "JAX", *sets, f"JAX / {sets[-1]}"), rows)


def parts(scenes: dict[str, Scene]) -> None:
    """Print the time that the kernel spends in each part of a step."""
    rows = []
    for name, one in scenes.items():
        run = program(one, world.native.part_seconds)
        found = np.median([np.asarray(run()) for _ in range(REPEATS)], 0) / len(one.rest.angle)
        rows.append((name, *(f"{1e6 * part:.2f}" for part in found)))
    timing.print_table("µs a step, by part", ("", *world.native.PARTS), rows)


def crowds() -> None:
    """Print the time of a step of the scene of `scaling/paper` by one thread and by more."""
    cores, steps, rows = device.cores(), 10, []
    for nodes in CROWDS:
        crowd, start = build_crowd(Scaling(), nodes)

        def advance(threads: int, crowd: Any = crowd, start: Any = start) -> Callable[[], Any]:
            compiled = jax.jit(
                lambda box, state, rest: world.native.advance(box, state, rest, steps, threads)
            )
            return lambda: compiled(crowd.box, start, crowd.rest)

        programs = {str(threads): advance(threads) for threads in {1, cores}}
        for run in programs.values():
            timing.seconds(run)  # Compiles.
        times = timing.interleaved(programs, 3)
        ms = [1e3 * statistics.median(times[key]) / steps for key in sorted(programs, key=int)]
        spent = 1e3 * np.asarray(programs[str(cores)]()[1]) / steps
        rows.append((f"{nodes:,}", *(f"{one:.1f}" for one in (*ms, *spent))))
    head = ("nodes", *(f"× {n}" for n in sorted({1, cores})), *world.native.PARTS)
    timing.print_table("ms a step in 256 × 256 cells, and by part with all threads", head, rows)


def evaluations() -> None:
    """Print the time to evaluate a creature of a preset, from its genes to its measures."""
    rows = []
    for preset in EXPERIMENTS["quality-diversity"].presets:
        if preset.name not in PRESETS or not isinstance(preset.spec, QualityDiversity):
            continue
        task = build_task(preset.spec.scene, room=room_of(preset.spec))
        encoding: Any = task.encoding
        keys = jax.random.split(jax.random.key(0), CREATURES)
        genotypes = jax.vmap(lambda key, one=encoding: one.newcomer(key=key))(keys)
        times = timing.interleaved(
            {name: evaluation(name, task, genotypes) for name in ("jax", "native")}, REPEATS
        )
        jax_ms, native_ms = (1e3 * statistics.median(t) / CREATURES for t in times.values())
        rows.append(
            (preset.name, f"{jax_ms:.1f}", f"{native_ms:.1f}", f"{jax_ms / native_ms:.1f}")
        )
    timing.print_table("ms an evaluation", ("", "JAX", "native", "ratio"), rows)


def evaluation(kernel: str, task: search.Task, genotypes: Any) -> Callable[[], Any]:
    """Compile the evaluation of a block by one kernel."""
    os.environ[device.KERNEL_VARIABLE] = kernel  # Read when a program is traced.
    compiled = search.block_program(lambda genotype: search.evaluate(task, genotype))
    jax.block_until_ready(compiled(genotypes))
    return lambda: compiled(genotypes)


if __name__ == "__main__":
    main()
