"""Time of a step of physics, relative to the machine's bandwidth, and of its parts.

Prints tables and asserts nothing. All programs run interleaved in one process, as
`search.block_program` runs them: on a CPU each world by itself and one device per core,
elsewhere all worlds as one batch. The cost of a part is the difference between programs with
and without it.
"""

import statistics
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import timing

from microcosmos import bodies, coupling, device, filaments, fluid, groups, search, world
from microcosmos.build import build_rods

WORLDS, SIZE, NODES, STEPS, REPEATS = 64, (64, 64), 32, 100, 15
VISCOSITY, AMPLITUDE, PERIOD = 0.05, 0.25, 100
LARGE = 2**25
"""Values of the copied array: more than any cache holds."""
CELL_BYTES = 72
"""The least memory traffic of a step per cell: nine float32 populations, read and written."""

Step = Callable[[world.World, world.State, filaments.Rest], world.State]


def main() -> None:
    device.prepare()
    box, starts, rests = scene()
    parts = split(starts, rests)
    steps = {
        "fluid alone: moments, collision, streaming": fluid_step,
        "+ windows, interpolation, one spread": carried_step,
        f"+ forcing, {box.form.forcing_iterations} iterations": unconstrained_step,
        f"+ {box.form.constraint_iterations} sweeps: the coupled step": coupled_step,
    }
    programs = {name: rollout_program(box, step, parts) for name, step in steps.items()}
    for program in programs.values():
        timing.seconds(program)  # Compiles.
    seconds = timing.interleaved({"copy": copier(), **programs}, REPEATS)
    medians = {name: statistics.median(times) for name, times in seconds.items()}
    print_tables(2 * 4 * LARGE / medians.pop("copy"), medians)


def scene() -> tuple[world.World, world.State, filaments.Rest]:
    """Return one world's parameters, and the start and the rest shapes of every world."""
    body = bodies.chain(NODES, 1.0, stretch=1.0, shear=1.0, bend=1.0)
    limits = world.Limits(jnp.float32(0.1), jnp.float32(0.1))
    rods, viscosity = build_rods(body, jnp.float32), jnp.float32(VISCOSITY)
    box = world.World(viscosity, rods, groups.single(NODES), SIZE, limits=limits)
    middle = jnp.asarray(body.positions - body.positions.mean(0) + np.array(SIZE) / 2)
    start = world.at_rest(box, middle.astype(jnp.float32))
    starts = jax.tree.map(lambda x: jnp.broadcast_to(x, (WORLDS, *x.shape)), start)
    phase = np.arange(WORLDS)[:, None, None] / WORLDS
    time = np.arange(STEPS)[None, :, None] / PERIOD
    joint = np.arange(len(body.joints))[None, None] / len(body.joints)
    wave = AMPLITUDE * time * np.sin(2 * np.pi * (joint - time + phase))
    length = np.ones((WORLDS, STEPS, len(body.edges)))
    return box, starts, filaments.Rest(jnp.float32(wave), jnp.float32(length))


def split(starts: world.State, rests: filaments.Rest) -> list[Any]:
    """Distribute the worlds over all devices."""
    devices = jax.local_devices()
    shares = np.array_split(np.arange(WORLDS), len(devices))
    return [
        jax.device_put(jax.tree.map(lambda x, rows=rows: x[rows], (starts, rests)), d)
        for rows, d in zip(shares, devices, strict=True)
    ]


def rollout_program(box: world.World, step: Step, parts: list[Any]) -> Callable[[], Any]:
    """Return a function that carries all worlds through all steps, on all devices at once."""

    def rollout(args):
        state, rest = args
        return jax.lax.scan(lambda s, r: (step(box, s, r), None), state, rest)[0]

    program = search.block_program(rollout)
    return lambda: [program(part) for part in parts]


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
    loose = replace(box, form=replace(box.form, constraint_iterations=0))
    return coupled_step(loose, state, rest)


def coupled_step(box: world.World, state: world.State, rest: filaments.Rest) -> world.State:
    return world.step(box, state, rest)[0]


def advance(box: world.World, state: world.State, force: fluid.Vectors) -> fluid.Populations:
    f, rates = state.populations, fluid.rates(box.viscosity, box.form.magic)
    return fluid.stream(fluid.collide(f, fluid.density(f), fluid.momentum(f), force, rates))


def interpolate(state: world.State, at: coupling.Windows) -> jax.Array:
    rho, momentum = fluid.density(state.populations), fluid.momentum(state.populations)
    return coupling.interpolate(momentum, coupling.divided(at, rho))


def copier() -> Callable[[], Any]:
    """Return a function that copies an array, on a CPU one on each core."""
    if jax.default_backend() != "cpu":
        copy = partial(jax.jit(lambda x: x + 1), jnp.zeros(LARGE, jnp.float32))
        copy().block_until_ready()
        return copy
    cores = len(jax.local_devices())
    # Write once, so that no page fault is timed.
    arrays = [(np.ones(LARGE, np.float32), np.ones(LARGE, np.float32)) for _ in range(cores)]
    pool = ThreadPoolExecutor(cores)
    return lambda: list(pool.map(lambda pair: np.copyto(*pair), arrays))


def print_tables(bandwidth: float, medians: dict[str, float]) -> None:
    """Print the bandwidth in bytes a second, the seconds of every program, and the bars."""
    devices, unit = len(jax.local_devices()), "accelerator"
    if jax.default_backend() == "cpu":
        unit = "core"
    limit = bandwidth / CELL_BYTES / 1e6
    print(
        f"{device.device_kind()}; {devices} × {unit}; float32\n"
        f"{WORLDS} worlds of {SIZE[0]} × {SIZE[1]} cells, {NODES} nodes each, {STEPS} steps; "
        f"medians of {REPEATS} interleaved repeats\n\n"
        f"copy bandwidth {bandwidth / 1e9:.1f} GB/s a {unit}, at {CELL_BYTES} B a cell "
        f"{limit:.0f} MLUPS\n"
    )
    # Microseconds of one core or accelerator for one step of one world.
    times = [1e6 * seconds * devices / (WORLDS * STEPS) for seconds in medians.values()]
    mlups = [SIZE[0] * SIZE[1] / time for time in times]
    rows = [
        (name, f"{t:.1f}", f"{t - before:.1f}", f"{speed:.0f}", f"{t / times[0]:.2f}")
        for name, t, before, speed in zip(medians, times, [0, *times], mlups, strict=False)
    ]
    columns = ("", "µs/step", "part", "MLUPS", "× fluid")
    timing.print_table(f"One world on one {unit}", columns, rows)
    print(
        f"fluid: {mlups[0]:.0f} MLUPS a {unit} (bar 100), "
        f"{100 * mlups[0] / limit:.0f} % of the copy bandwidth (bar 20)\n"
        f"coupled step: {times[-1] / times[0]:.2f} × the fluid (bar 3)"
    )


if __name__ == "__main__":
    main()
