"""Time of a step of physics, relative to the machine's bandwidth, and of its parts.

Prints tables and asserts nothing. All programs run interleaved in one process: on a CPU
each world by itself and one device a core, elsewhere all worlds as one batch, which is how
`search.block_program` does it. The cost of a part is the difference between
programs with and without it.
"""

import statistics
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from typing import Any

import jax
import jax.numpy as jnp
import loops
import numpy as np

from microcosmos import bodies, coupling, device, filaments, fluid, groups, search, world
from microcosmos.build import build_rods

WORLDS, SIZE, NODES, STEPS, REPEATS = 64, (64, 64), 32, 100, 15
VISCOSITY, AMPLITUDE, PERIOD = 0.05, 0.25, 100
LARGE = 2**25
"""Values in the array that is copied: more than any cache holds."""
MINIMUM = 72
"""Bytes a step moves for a cell at least: nine float32 populations, read and written."""

Step = Callable[[world.World, world.State, filaments.Rest], world.State]


@dataclass
class Program:
    """A rollout of all worlds with one form of the step, and how long each repeat took."""

    name: str
    step: Step
    compiled: Callable = field(init=False)
    seconds: list[float] = field(default_factory=list)

    @property
    def median(self) -> float:
        return statistics.median(self.seconds)

    @property
    def microseconds(self) -> float:
        """Time of one core (or accelerator) for one step of one world."""
        return 1e6 * self.median * len(jax.local_devices()) / (WORLDS * STEPS)

    @property
    def mlups(self) -> float:
        """Million cells a second and core (or accelerator)."""
        return SIZE[0] * SIZE[1] / self.microseconds


def main() -> None:
    device.prepare()
    box, starts, rests = scene()
    programs = [
        Program("fluid alone: moments, collision, streaming", fluid_step),
        Program("+ windows, interpolation, one spread", carried_step),
        Program(f"+ forcing, {box.form.forcing_iterations} iterations", unconstrained_step),
        Program(f"+ {box.form.constraint_iterations} sweeps: the coupled step", coupled_step),
    ]
    parts = [jax.device_put(part, d) for part, d in split(starts, rests)]
    for program in programs:
        program.compiled = compile_rollout(box, program.step)
        run(program, parts)
    copy, bandwidths = copier(), []
    for _ in range(REPEATS):
        bandwidths.append(copy())
        for program in programs:
            program.seconds.append(run(program, parts))
    print_tables(programs, statistics.median(bandwidths))


def scene() -> tuple[world.World, world.State, filaments.Rest]:
    """One world's parameters, the start of every world, and what every body does."""
    body = bodies.chain(NODES, 1.0, stretch=1.0, shear=1.0, bend=1.0)
    limits = world.Limits(jnp.float32(0.1), jnp.float32(0.1))
    alone = groups.one(NODES)
    box = world.World(
        jnp.float32(VISCOSITY), build_rods(body, jnp.float32), alone, SIZE, limits=limits
    )
    middle = jnp.asarray(body.positions - body.positions.mean(0) + np.array(SIZE) / 2)
    start = world.at_rest(box, middle.astype(jnp.float32))
    starts = jax.tree.map(lambda x: jnp.broadcast_to(x, (WORLDS, *x.shape)), start)
    phase = np.arange(WORLDS)[:, None, None] / WORLDS
    time = np.arange(STEPS)[None, :, None] / PERIOD
    joint = np.arange(len(body.joints))[None, None] / len(body.joints)
    wave = AMPLITUDE * time * np.sin(2 * np.pi * (joint - time + phase))
    length = np.ones((WORLDS, STEPS, len(body.edges)))
    return box, starts, filaments.Rest(jnp.float32(wave), jnp.float32(length))


def split(starts: world.State, rests: filaments.Rest) -> list[tuple[Any, Any]]:
    """Shares of the worlds, each with the device that it belongs on."""
    devices = jax.local_devices()
    shares = np.array_split(np.arange(WORLDS), len(devices))
    return [
        (jax.tree.map(lambda x, rows=rows: x[rows], (starts, rests)), d)
        for rows, d in zip(shares, devices, strict=True)
    ]


def compile_rollout(box: world.World, step: Step) -> Callable:
    """A program that carries a share of the worlds through all steps."""

    def rollout(args):
        state, rest = args
        return jax.lax.scan(lambda s, r: (step(box, s, r), None), state, rest)[0]

    return search.block_program(rollout)


def run(program: Program, parts: list[Any]) -> float:
    """Wall seconds of one run on all devices at once."""
    return loops.seconds(lambda: [program.compiled(part) for part in parts])


def fluid_step(box: world.World, state: world.State, rest: filaments.Rest) -> world.State:
    return replace(state, populations=advance(box, state, jnp.zeros((2, *SIZE))))


def carried_step(box: world.World, state: world.State, rest: filaments.Rest) -> world.State:
    at = coupling.windows(state.positions, SIZE)
    velocity = interpolate(state, at)
    force = coupling.spread(1e-6 * velocity, at, SIZE)
    populations = advance(box, state, force)
    return replace(state, populations=populations, positions=state.positions + velocity)


def unconstrained_step(
    box: world.World, state: world.State, rest: filaments.Rest
) -> world.State:
    return coupled_step(
        replace(box, form=replace(box.form, constraint_iterations=0)), state, rest
    )


def coupled_step(box: world.World, state: world.State, rest: filaments.Rest) -> world.State:
    return world.step(box, state, rest)[0]


def advance(box: world.World, state: world.State, force: fluid.Vectors) -> fluid.Populations:
    f, rates = state.populations, fluid.rates(box.viscosity, box.form.magic)
    return fluid.stream(fluid.collide(f, fluid.density(f), fluid.momentum(f), force, rates))


def interpolate(state: world.State, at: coupling.Windows) -> jax.Array:
    rho, momentum = fluid.density(state.populations), fluid.momentum(state.populations)
    return coupling.interpolate(momentum, coupling.divided(at, rho))


def copier() -> Callable[[], float]:
    """A function that measures the bytes a second, read and written, of a plain copy."""
    if jax.default_backend() != "cpu":
        source = jnp.zeros(LARGE, jnp.float32)
        copy = jax.jit(lambda x: x + 1)
        copy(source).block_until_ready()
        return lambda: bandwidth(source.nbytes, lambda: copy(source).block_until_ready())
    cores = len(jax.local_devices())
    # Written to once, so that no page is new while the clock runs.
    arrays = [(np.ones(LARGE, np.float32), np.ones(LARGE, np.float32)) for _ in range(cores)]
    pool = ThreadPoolExecutor(cores)
    return lambda: bandwidth(
        arrays[0][0].nbytes, lambda: list(pool.map(lambda pair: np.copyto(*pair), arrays))
    )


def bandwidth(size: int, copy: Callable[[], Any]) -> float:
    start = time.perf_counter()
    copy()
    return 2 * size / (time.perf_counter() - start)


def print_tables(programs: list[Program], bandwidth: float) -> None:
    """The machine's roof, every program beside it, and the bars."""
    unit = "core" if jax.default_backend() == "cpu" else "accelerator"
    alone, coupled = programs[0], programs[-1]
    roof = bandwidth / MINIMUM / 1e6
    print(
        f"{device.device_kind()}; {len(jax.local_devices())} × {unit}; float32\n"
        f"{WORLDS} worlds of {SIZE[0]} × {SIZE[1]} cells, {NODES} nodes each, {STEPS} steps; "
        f"medians of {REPEATS} interleaved repeats\n\n"
        f"copy bandwidth {bandwidth / 1e9:.1f} GB/s a {unit}, at {MINIMUM} B a cell "
        f"{roof:.0f} MLUPS\n"
    )
    heads = f"{'µs/step':>9}{'part':>8}{'MLUPS':>8}{'× fluid':>9}"
    print(f"{'one world on one ' + unit:46}{heads}")
    before = 0.0
    for p in programs:
        part, before = p.microseconds - before, p.microseconds
        ratio = p.microseconds / alone.microseconds
        print(f"{p.name:46}{p.microseconds:9.1f}{part:8.1f}{p.mlups:8.0f}{ratio:9.2f}")
    print(
        f"\nfluid: {alone.mlups:.0f} MLUPS a {unit} (bar 100), "
        f"{100 * alone.mlups / roof:.0f} % of the copy bandwidth (bar 20)\n"
        f"coupled step: {coupled.median / alone.median:.2f} × the fluid (bar 3)"
    )


if __name__ == "__main__":
    main()
