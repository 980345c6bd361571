"""Wall time against the number of nodes: the Microcosmos paper's figure, part by part."""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .. import coupling, device, filaments, fluid, world
from ..archive.report import Report, Row, Value
from ..search import Stopped
from .table_file import Table

# The part that depends on nodes grows as n^0.88 from there to 500,000 (docs/reproduction.md).
LINEAR_FROM = 16_000
"""Least number of nodes in the fit of the exponent; below it fixed costs of a call count."""

MIN_POINTS = 3
"""Minimum number of points of a fit; smaller counts of nodes are added if needed."""


def report(state: Table, rows: tuple[Row, ...]) -> Report:
    """Return the report with the exponents so far. Times depend on the machine."""
    return Report(
        generation=state.generation,
        evaluations=state.generation,
        infeasible=sum(row.values["status"] != "ok" for row in state.rows),
        rows=rows,
        summary=summary([row.values for row in state.rows]),
    )


def summary(rows: Sequence[Mapping[str, Any]]) -> dict[str, float | None]:
    """Return exponents of the time that depends on nodes, and the most memory.

    The part that depends on nodes is all but the fluid, whose cells do not change. Rows that
    did not stay finite are left out.
    """
    finite = [row for row in rows if row["status"] == "ok"]
    ours = [row for row in finite if row["method"] == "microcosmos"]
    pairs = [row for row in finite if row["method"] == "all-pairs"]
    memory = [row["memory_bytes"] for row in ours if row["memory_bytes"] is not None]
    counts = sorted(row["nodes"] for row in ours)
    start = min(LINEAR_FROM, counts[-MIN_POINTS]) if len(counts) >= MIN_POINTS else LINEAR_FROM
    largest_pairs = [(r["nodes"], r["seconds"]) for r in pairs[-MIN_POINTS:]]
    large = [(r["nodes"], r["seconds"] - r["fluid"]) for r in ours if r["nodes"] >= start]
    return {
        "exponent": _exponent(large),
        "exponent_from": start,
        "exponent_all_pairs": _exponent(largest_pairs),
        "peak_memory_bytes": max(memory, default=None),
    }


def _exponent(points: list[tuple[float, float]]) -> float | None:
    points = [(n, t) for n, t in points if t > 0]
    if len(points) < 2:
        return None
    nodes, seconds = np.log(np.array(points)).T
    return float(np.polyfit(nodes, seconds, 1)[0])


REPORTED = 1000
"""Steps that reported times are for."""

CHUNK = 10
"""Steps of one call of a program; a run can stop between calls."""

NATIVE_CHUNK = 100
"""Most steps in one call of the native kernel; each call lays out its arrays anew."""

NATIVE_PARTS = {
    "fluid": ("moments", "fluid"),
    "coupling": ("windows", "interpolation", "forcing", "spreading"),
    "constraints": ("constraints",),
    "steric": ("repulsion",),
}
"""The kernel's parts of a step in each of ours."""

REPEATS = 3
"""Repeats of each part; the median counts."""


class Scene(eqx.Module):
    """The constants of a step, as an argument, so that the compiler does not fold them."""

    box: world.World
    rest: filaments.Rest


Step = Callable[[Scene, world.State], world.State]
Measured = tuple[dict[str, Value], world.State]
"""Columns of a row, and the state at the end."""


@dataclass(frozen=True)
class Timing:
    """The length of the measurement."""

    steps: int
    part_steps: int
    options: Mapping[str, object]
    stop: Callable[[], bool]


def step_row(scene: Scene, start: world.State, plan: Timing) -> dict[str, Value]:
    """Measure one number of nodes, with the native kernel or JAX, as `device.kernel` chooses.

    Times are seconds for 1,000 steps. `memory_bytes` counts arguments, results and temporaries
    of the compiled program, and with the kernel all arrays that it holds during the steps.
    """
    measured = _native if world.native.chosen(scene.box, start) else _jax
    columns, end = measured(scene, start, plan)
    finite = all(bool(jnp.all(jnp.isfinite(x))) for x in jax.tree.leaves(end))
    return {
        "method": "microcosmos",
        "nodes": len(start.positions),
        **columns,
        "status": "ok" if finite else "non-finite",
    }


def _native(scene: Scene, start: world.State, plan: Timing) -> Measured:
    """Measure the native kernel with a thread for each core; it takes the time of each part."""
    # The kernel has at most 1,024 threads.
    steps, threads = min(NATIVE_CHUNK, plan.steps), min(device.cores(), 1024)
    spent = []

    def advance(scene: Scene, state: world.State) -> tuple:
        return world.native.advance(scene.box, state, scene.rest, steps, threads)

    program = (
        jax.jit(advance, compiler_options=dict(plan.options)).lower(scene, start).compile()
    )
    *_, held = jax.block_until_ready(program(scene, start))

    def kept(scene: Scene, state: world.State) -> world.State:
        state, seconds, _ = jax.block_until_ready(program(scene, state))
        spent.append(seconds)
        return state

    calls = max(1, plan.steps // steps)
    seconds, end = _time(kept, scene, start, calls, plan)
    times = dict(zip(world.native.PARTS, np.mean(spent, 0), strict=True))
    parts = {part: sum(times[one] for one in ones) for part, ones in NATIVE_PARTS.items()}
    memory = _memory(program)
    return {
        "kernel": "native",
        "steps": steps * calls,
        "seconds": seconds * REPORTED / steps,
        **{name: float(one) * REPORTED / steps for name, one in parts.items()},
        "memory_bytes": None if memory is None else memory + int(held),
    }, end


def _jax(scene: Scene, start: world.State, plan: Timing) -> Measured:
    """Measure JAX, then each part by itself."""
    whole = _compile(_step, scene, start, CHUNK, plan)
    calls = max(1, plan.steps // CHUNK)
    seconds, end = _time(whole, scene, start, calls, plan)
    parts = (("fluid", _fluid), ("coupling", _couple))
    parts += (("constraints", _constrain), ("steric", _repel))
    return {
        "kernel": "jax",
        "steps": CHUNK * calls,
        "seconds": seconds * REPORTED / CHUNK,
        **{name: _median(part, scene, start, plan) for name, part in parts},
        "memory_bytes": _memory(whole),
    }, end


def pairs_row(positions: Float[Array, "node 2"], size: tuple[int, int], plan: Timing) -> dict:
    """Measure a repulsion between all pairs of nodes, without fluid or constraints."""

    def step(scene: None, x: Array) -> Array:
        return x + 1e-3 * _all_pairs(x, size)

    program = _compile(step, None, positions, 1, plan)
    seconds, _ = _time(program, None, positions, REPEATS, plan)
    return {
        "method": "all-pairs",
        "nodes": len(positions),
        "kernel": "jax",
        "steps": REPEATS,
        "seconds": seconds * REPORTED,
        "fluid": None,
        "coupling": None,
        "constraints": None,
        "steric": None,
        "memory_bytes": _memory(program),
        "status": "ok",
    }


def _all_pairs(positions, size: tuple[int, int]):
    """Return the gradient of a Gaussian repulsion of width one cell, summed over all others."""

    def away(one, others, length):
        distance = one - others
        return distance - length * jnp.round(distance / length)

    def pushed(one):
        dx = away(one[0], positions[:, 0], size[0])
        dy = away(one[1], positions[:, 1], size[1])
        weight = jnp.exp(-0.5 * (dx * dx + dy * dy))
        return jnp.stack([jnp.sum(weight * dx), jnp.sum(weight * dy)])

    return jax.lax.map(pushed, positions, batch_size=16)


def _step(scene: Scene, state: world.State) -> world.State:
    return world.step(scene.box, state, scene.rest)[0]


def _fluid(scene: Scene, state: world.State) -> world.State:
    box, f = scene.box, state.populations
    none = jnp.zeros((2, *box.size), f[0].dtype)
    rates = fluid.rates(box.viscosity, box.form.magic)
    rho, momentum = fluid.density(f), fluid.momentum(f)
    moved = fluid.advance(f, rho, momentum, none, rates, box.surroundings)
    return replace(state, populations=moved)


def _couple(scene: Scene, state: world.State) -> world.State:
    """Interpolate, force and spread towards a velocity that nodes do not have."""
    box = scene.box
    rho, momentum = fluid.density(state.populations), fluid.momentum(state.populations)
    at = coupling.windows(state.positions, box.size, box.form.kernel)
    velocity = coupling.interpolate(momentum, coupling.divided(at, rho))
    forced = coupling.multi_direct_forcing(
        velocity,
        velocity + 1e-3,
        state.positions,
        rho,
        at,
        groups=box.groups,
        iterations=box.form.forcing_iterations,
        projection=box.form.projection,
        limit=box.limits.force,
    )
    force = coupling.spread(forced.forcing, at, box.size)
    # Every step depends on the one before, so that the compiler drops none.
    return replace(state, positions=state.positions + 1e-6 * forced.target + force[0, 0, 0])


def _constrain(scene: Scene, state: world.State) -> world.State:
    box = scene.box
    positions, angles = filaments.project(
        state.positions,
        state.angles,
        box.rods,
        scene.rest,
        iterations=box.form.constraint_iterations,
    )
    return replace(state, positions=positions, angles=angles)


def _repel(scene: Scene, state: world.State) -> world.State:
    found = world.repel(scene.box, state.positions)
    return replace(state, positions=state.positions + 1e-3 * (found.push + found.drift))


def _median(part: Step, scene: Scene, start: world.State, plan: Timing) -> float:
    program = _compile(part, scene, start, plan.part_steps, plan)
    seconds = [_time(program, scene, start, 1, plan)[0] for _ in range(REPEATS)]
    return float(np.median(seconds)) * REPORTED / plan.part_steps


def _compile(step: Callable, scene: Any, start: Any, steps: int, plan: Timing) -> Any:
    def run(scene, state):
        return jax.lax.scan(lambda s, _: (step(scene, s), None), state, None, length=steps)[0]

    program = jax.jit(run, compiler_options=dict(plan.options)).lower(scene, start).compile()
    # The first call allocates, which is no part of a step.
    jax.block_until_ready(program(scene, start))
    return program


def _time(program: Any, scene: Any, start: Any, calls: int, plan: Timing) -> tuple[float, Any]:
    state, seconds = start, 0.0
    for _ in range(calls):
        if plan.stop():
            raise Stopped
        begun = time.perf_counter()
        state = jax.block_until_ready(program(scene, state))
        seconds += time.perf_counter() - begun
    return seconds / calls, state


def _memory(program: Any) -> int | None:
    """Return the bytes of a program's arguments, results and temporaries, if known."""
    analysis = program.memory_analysis()
    if analysis is None:
        return None
    sizes = ("argument_size_in_bytes", "output_size_in_bytes", "temp_size_in_bytes")
    return int(sum(getattr(analysis, name) for name in sizes))
