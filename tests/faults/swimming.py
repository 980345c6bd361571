"""Whether what evolves truly swims: presets over five seeds, and variants of 50 elites each.

The variants change what should not matter: limits, the grid, the step and the heading. The best
travelling wave is printed beside them: the delta function resolves its small amplitude worse
than the strokes that evolve, so on half the grid spacing it goes much further.
"""

import statistics
from dataclasses import replace
from itertools import product as combinations
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import rich
from drive import Installation
from scipy.stats import spearmanr
from searches import SEEDS, carry_out, summary

from microcosmos import search, spec, world
from microcosmos.archive import creature
from microcosmos.audit import variants
from microcosmos.build import build_task
from microcosmos.filaments import Rest
from microcosmos.genomes import Drive, carried_out
from microcosmos.search.evaluation import FEASIBLE
from microcosmos.spec import Scene, parse
from microcosmos.spec.quality_diversity import PRESETS
from microcosmos.viz.replay import actuator_of
from microcosmos.world import Measures, State

EXAMINED = ("demo", "standard")
"""Presets."""
ELITES = {"fittest": 5, "others": 5}
"""Elites of each seed that are examined."""
BARS = {
    "doubled": (0.98, 1.02),
    "off": (0.95, 1.05),
    "fine": (0.85, 1.15),
    "turned": (0.85, 1.15),
}
"""Displacement relative to the recorded one."""
FEASIBLE_SHARE = 0.7
"""Least share of feasible evaluations in the second half of a run."""
FASTER = 1.3
"""Least ratio of the fittest to the best travelling wave of the same body, for `standard`."""
SPEED = 0.4
"""Least speed of the fittest of `standard`, in body lengths in 1,000 steps."""
WAVES = {
    "amplitude": (0.2, 0.4, 0.6, 0.7, 0.8, 0.9, 1.0),
    "number": (0.25, 0.4, 0.5, 0.6, 0.7, 0.75, 0.85, 1.0, 1.25, 1.5, 2.0),
    "period": (200.0, 400.0),
}
"""Amplitude as a share of the controller's largest, waves along the body, period in steps."""


def swimming(product: Installation) -> bool:
    """Tell whether the elites of `demo` and `standard` truly swim, and fast."""
    return all([examine(product, name) for name in EXAMINED])


def examine(product: Installation, preset: str) -> bool:
    """Carry out a preset with all seeds, and print what its elites are worth."""
    document = PRESETS[preset][1].model_dump(mode="json")
    runs = [
        carry_out(product, {**document, "seed": seed}, f"{preset}, seed {seed}")
        for seed in SEEDS
    ]
    shares = [feasible_share(product, run["id"]) for run in runs]
    rich.print(f"{preset}: feasible in the second half {summary(shares)}")
    best = [run["best"] for run in runs]
    rich.print(f"{preset}: fittest, lengths in 1,000 steps {summary(best)}")
    for figure in ("motion_distance", "nearest_motion", "kinds"):
        rich.print(f"{preset}: {figure} {summary([run['summary'][figure] for run in runs])}")
    scene = parse(document).scene
    elites = [file for run in runs for file in chosen(product, run["id"])]
    waves = wave_speeds(scene)
    wave = max(waves, key=waves.__getitem__)
    ratio = statistics.median(best) / waves[wave]
    named = ", ".join(f"{name} {value:g}" for name, value in zip(WAVES, wave, strict=True))
    rich.print(
        f"{preset}: best travelling wave {waves[wave]:.3f} ({named}); "
        f"the median fittest is {ratio:.2f} × as fast"
    )
    good = [min(shares) >= FEASIBLE_SHARE, *agree(preset, scene, elites)]
    handmade(scene, wave)
    if preset == "standard":
        good += [statistics.median(best) >= SPEED, ratio >= FASTER]
    return all(good)


def feasible_share(product: Installation, run: str) -> float:
    """The share of feasible evaluations in the second half of a run."""
    found = product.get(f"runs/{run}/generations")
    counts = np.array([found["evaluations"], found["infeasible"]], float)
    evaluations, infeasible = counts[:, -1] - counts[:, counts.shape[1] // 2 - 1]
    return float(1 - infeasible / evaluations)


def chosen(product: Installation, run: str) -> list[dict[str, Any]]:
    """The fittest elites of a run, and others drawn at random."""
    archive = product.get(f"runs/{run}/archive")
    order = np.argsort(archive["fitness"])[::-1]
    rest = np.random.default_rng(0).permutation(order[ELITES["fittest"] :])
    names = [*order[: ELITES["fittest"]], *rest[: ELITES["others"]]]
    return [product.get(f"creatures/{archive['creature'][i]}") for i in names]


def agree(preset: str, scene: Scene, elites: list[dict[str, Any]]) -> list[bool]:
    """Print how far elites go in each variant, relative to the recorded distance."""
    rests = [rest_of(scene, file) for file in elites]
    speeds = np.array([file["measured"]["fitness"] for file in elites])
    plain = displacements(build_task(scene), rests)
    good = []
    for name, (found, turn) in in_variants(scene, rests).items():
        shares = along(found, plain, turn)
        low, high = BARS[name]
        inside = np.mean((shares >= low) & (shares <= high))
        middle = float(np.median(shares))
        rich.print(
            f"{preset}, {len(elites)} elites, {name}: median {middle:.4f} "
            f"({shares.min():.4f}–{shares.max():.4f}), {inside:.0%} within {low:g} to {high:g}"
        )
        good.append(low <= middle <= high if name == "fine" else inside >= needed(name))
        if name == "fine":
            fine = speeds * shares
            top = np.argsort(speeds)[::-1][: 2 * len(SEEDS)]
            ranks = spearmanr(speeds, fine)[0], spearmanr(speeds[top], fine[top])[0]
            rich.print(f"{preset}: rank correlation {ranks[0]:.3f}, top ten {ranks[1]:.3f}")
            good += [ranks[0] >= 0.9, ranks[1] >= 0.6]
    kinks = zigzags(scene, rests)
    rich.print(f"{preset}: zigzag at most {max(kinks):.1e} rad")
    return [*good, float(max(kinks)) <= 0.01]


def needed(variant: str) -> float:
    return 0.9 if variant == "turned" else 0.99


Variants = dict[str, tuple[np.ndarray, float]]


def in_variants(scene: Scene, rests: list[Rest]) -> Variants:
    """Displacements (elite, 2) in each variant in the scene's cells, and the turn, in rad."""
    tasks = {"doubled": variants.with_limits(scene, None, 2.0)}
    tasks |= {"off": variants.with_limits(scene, None, None)}
    found: Variants = {n: (displacements(one, rests), 0.0) for n, one in tasks.items()}
    eighth = np.pi / 4
    found["turned"] = displacements(variants.turned(scene, None, eighth), rests), eighth
    found["fine"] = on_fine_grid(scene, rests), 0.0
    return found


def on_fine_grid(scene: Scene, rests: list[Rest]) -> np.ndarray:
    refined = [variants.refine(scene, rest) for rest in rests]
    return displacements(refined[0][0], [shapes for _, shapes in refined]) / 2


def displacements(task: search.Task, rests: list[Rest]) -> np.ndarray:
    """Displacement (gait, 2) in cells of a body that follows rest shapes."""

    def one(rest: Rest) -> jax.Array:
        driven = search.drive(task, rest)
        end, _ = search.simulate(driven, lambda state, measures: None)
        return jnp.mean(world.unwrapped(driven.world, end) - driven.start.positions, 0)

    return np.asarray(search.block_program(one)(stacked(rests)), float)


def stacked(rests: list[Rest]) -> Rest:
    return jax.tree.map(lambda *rows: jnp.stack(rows), *rests)


def along(found: np.ndarray, plain: np.ndarray, turn: float) -> np.ndarray:
    """The displacement along the recorded one, turned, as a share of it."""
    c, s = np.cos(turn), np.sin(turn)
    expected = plain @ np.array([[c, s], [-s, c]])
    return np.sum(found * expected, 1) / np.sum(expected * expected, 1)


def rest_of(scene: Scene, file: dict[str, Any]) -> Rest:
    """The rest shapes that a creature's actuators carry out."""
    task = build_task(scene, room=creature.room(file))
    actuator = jax.tree.map(jnp.asarray, actuator_of(creature.parse(file), scene))
    return search.drive(task, actuator).inputs


def travelling(scene: Scene, task: search.Task, point: jax.Array) -> Drive:
    """A travelling wave of bending, by `WAVES`, that the scene's actuators carry out."""
    amplitude, number, period = point
    lengths = jnp.asarray(spec.shape(scene.body).rest_length, jnp.float32)
    times, joints = jnp.arange(float(scene.task.steps)), jnp.arange(len(lengths) - 1)
    phase = times[:, None] / period - number * joints[None] / len(joints)
    lengths = jnp.broadcast_to(lengths, (len(times), len(lengths)))
    amplitude = amplitude * scene.control.angle_scale
    rise = amplitude * jnp.minimum(1.0, times / period)[:, None]  # As controllers begin.
    rest = Rest(rise * jnp.sin(2 * jnp.pi * phase), lengths)
    driven = carried_out(Drive(task.world, task.start, rest), task.actuators)
    # The task's strokes are of another period.
    return replace(driven, clock=driven.clock * task.period / period)


def wave_speeds(scene: Scene) -> dict[tuple[float, ...], float]:
    """The speed of every feasible travelling wave, by amplitude, wave number and period."""
    task = build_task(scene)
    names = ["speed", *(name for name, _ in FEASIBLE.values())]

    def one(point: jax.Array) -> jax.Array:
        driven = travelling(scene, task, point)
        end, observed = search.simulate(driven)
        values = search.motion_of(task, driven, end, observed)
        shown = search.poses_of(task, driven, observed)
        values["crossing"] = search.crossing(shown, driven.start.positions)
        return jnp.stack([values[name] for name in names])

    grid = list(combinations(*WAVES.values()))
    found = np.asarray(search.block_program(one)(jnp.asarray(grid, jnp.float32)))
    most = np.array([limit for _, limit in FEASIBLE.values()])
    feasible = np.all(found[:, 1:] <= most, axis=1)
    return {grid[i]: float(found[i, 0]) for i in np.flatnonzero(feasible)}


def handmade(scene: Scene, point: tuple[float, ...]) -> None:
    """Print how much further a travelling wave goes on the fine grid."""
    task = build_task(scene)
    made = jax.jit(lambda point: travelling(scene, task, point).inputs)
    rests = [made(jnp.asarray(point, jnp.float32))]
    share = along(on_fine_grid(scene, rests), displacements(task, rests), 0.0)
    rich.print(f"on the fine grid the best travelling wave goes {share[0]:.3f} times as far")


def zigzags(scene: Scene, rests: list[Rest]) -> np.ndarray:
    """Rms, over joints and steps, of the part of bends beside the commanded that alternates
    from joint to joint, for each gait, in rad."""
    task = build_task(scene)
    edges = task.world.rods.edges

    def bends(state: State, measures: Measures) -> jax.Array:
        v = state.positions[edges[:, 1]] - state.positions[edges[:, 0]]
        turned = jnp.diff(jnp.arctan2(v[:, 1], v[:, 0]))
        return (turned + jnp.pi) % (2 * jnp.pi) - jnp.pi

    def one(rest: Rest) -> jax.Array:
        _, seen = search.simulate(search.drive(task, rest), bends)
        off = seen - rest.angle
        return jnp.sqrt(jnp.mean(((off[:, 2:] - 2 * off[:, 1:-1] + off[:, :-2]) / 4) ** 2))

    return np.asarray(search.block_program(one)(stacked(rests)))
