"""Recording of replays: the motion of one creature, its drive, and the fluid around it.

The program that records rounds differently from the one that evaluates, and rollouts are
chaotic, so a replay states the difference of its fitness from the recorded one.
"""

import json
import struct
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import lru_cache
from math import ceil
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array

from .. import genomes, plugins, search, world
from ..archive import creature
from ..build import build_encoding, build_measures, build_stroke, build_task
from ..device import device_kind
from ..filaments import Rest
from ..fluid import vorticity
from ..genomes import Drive
from ..search.evaluation import FEASIBLE
from ..spec import Gait, Scene, Task, solid_runs
from ..spec.creature import fitness_of
from ..spec.estimate import placements, simulation_bytes
from .replay_file import REPLAY_FORMAT

FRAMES = 250
"""Largest number of frames besides the first."""

FRAME_BYTES = 2**28
"""Limit of the memory for planes during recording, in bytes."""

LEVELS = {"vorticity": np.int8, "velocity": np.int8, "energy": np.uint8}
"""Planes of the fluid with their types, in the order of the file."""

ROOM = (8, 8)
"""Nodes and connections for a creature without a network."""

CELL_STEPS = 3 * 10**10
"""Limit of fluid cells times steps: minutes."""


def record(file: Mapping[str, Any]) -> bytes:
    """Return the replay of a creature file: a JSON header, then motion, rest shapes and planes.

    The layout is described in `docs/formats.md`. Raises `creature.CreatureError` for an
    invalid file.
    """
    file = creature.parse(file)
    scene = without_missing_plugins(creature.scene_of(file))
    nodes, _ = creature.room(file) or (0, 0)
    every = interval(scene, nodes)
    program = _program(scene.model_dump_json(), every)
    film, measures = jax.device_get(program(actuator_of(file, scene)))
    # JSON and int8 have no NaN, and a player could not draw it.
    if not all(np.isfinite(x).all() for x in (film.positions, film.vorticity)):
        needed = "a creature whose simulation stays finite"
        raise creature.CreatureError("identity", needed, "one that diverges")
    present = film.present
    edges, joints = graph_among(film.edges, film.joints, present)
    planes = {name: getattr(film, name) for name in LEVELS}
    scales = {n: float(np.max(np.abs(x), initial=0.0)) or 1.0 for n, x in planes.items()}
    header = {
        "format": REPLAY_FORMAT,
        "creature": file["sha256"],
        "frames": len(film.positions),
        "every": every,
        "steps": scene.task.steps,
        "nodes": int(present.sum()),
        "edges": edges.tolist(),
        "joints": joints.tolist(),
        "size": [scene.world.width, scene.world.height],
        "vorticity": {"scale": scales["vorticity"]},
        "velocity": {"scale": scales["velocity"]},
        "energy": {"scale": scales["energy"], "frames": len(film.energy)},
        **_comparison(file, scene, measures),
        "force_free": scene.coupling.force_free,
        "device": device_kind(),
    }
    if (solid := scene.world.solid) is not None:
        header["solid"] = solid_runs(solid)
    edges_present = present_parts(film.edges, film.joints, present)
    if (copies := scene.world.copies) is not None:
        member = np.repeat(np.arange(copies.count), len(present) // copies.count)
        header["member"] = member[present].tolist()
    return _pack(
        header,
        np.asarray(film.positions[:, present], "<f4"),
        np.asarray(film.rest.angle[:, edges_present[1]], "<f4"),
        np.asarray(film.rest.length[:, edges_present[0]], "<f4"),
        *(_levels(planes[name], scales[name], kind) for name, kind in LEVELS.items()),
    )


def _comparison(
    file: Mapping[str, Any], scene: Scene, measures: Mapping[str, Any]
) -> dict[str, Any]:
    replayed = {name: float(value) for name, value in measures.items()}
    measured = file["measured"] or {}
    recorded = measured.get("fitness")
    task = creature.scene_of(file).task
    fitness = fitness_of(task, replayed) if task == scene.task else None
    names = list(measured.get("descriptors", ())) or ["bending_effort", "stretching_effort"]
    return {
        "fitness": {
            "recorded": recorded,
            "replayed": fitness,
            "difference": None if recorded is None or fitness is None else fitness - recorded,
        },
        "descriptors": {
            "recorded": measured.get("descriptors"),
            "replayed": {name: replayed.get(name) for name in names},
        },
    }


def without_missing_plugins(scene: Scene) -> Scene:
    """Return the scene, without plug-in measures if these are missing: motion needs none."""
    try:
        build_measures(scene)
    except plugins.Missing:
        return unmeasured(scene)
    return scene


def unmeasured(scene: Scene) -> Scene:
    """Return the scene without plug-in measures."""
    task = Task(steps=scene.task.steps) if scene.task.plugin else scene.task
    return scene.model_copy(update={"task": task, "plugins": {}})


def present_parts(
    edges: np.ndarray, joints: np.ndarray, present: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return masks of the edges and joints whose nodes are all present."""
    edges_present = np.all(present[edges], axis=1)
    return edges_present, np.all(edges_present[joints], axis=1)


def graph_among(
    edges: np.ndarray, joints: np.ndarray, present: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return edges (edge, 2) and joints (joint, 2) that are present, renumbered."""
    edges_present, bending = present_parts(edges, joints, present)
    return (
        (np.cumsum(present) - 1)[edges[edges_present]],
        (np.cumsum(edges_present) - 1)[joints[bending]],
    )


def interval(scene: Scene, network_nodes: int) -> int:
    """Return the number of steps between frames.

    Raises `creature.CreatureError` if the simulation is too long or too large.
    """
    cells = scene.world.width * scene.world.height
    several = placements(scene.world) * scene.task.trials
    simulations = 1 + several if several > 1 else 1  # The recorded one, and those averaged.
    for field, limit, found, unit in (
        ("task.steps", CELL_STEPS, cells * scene.task.steps * simulations, "cell steps"),
        ("body.nodes", 2**32, simulation_bytes(scene, network_nodes), "bytes of memory"),
    ):
        if found > limit:
            raise creature.CreatureError(
                field, f"at most {limit:.1e} {unit} for a replay", found
            )
    planes = 3 + energy_changes(scene)
    frames = min(FRAMES, max(2, FRAME_BYTES // (4 * cells * planes)))
    return ceil(scene.task.steps / frames)


def energy_changes(scene: Scene) -> bool:
    """Return whether the energy changes during the simulation."""
    energy = scene.world.energy
    return energy is not None and (energy.consume or energy.diffusion > 0)


def actuator_of(file: Mapping[str, Any], scene: Scene) -> search.Actuator:
    """Return the genotype, or the gait's rest shapes, of a parsed creature file."""
    if isinstance(scene.control, Gait):
        return build_stroke(scene.control, scene.task.steps)
    encoding = build_encoding(scene, creature.room(file) or ROOM)
    return genomes.read(file["identity"]["genome"], encoding)


class Recording(eqx.Module):
    """The start and the state after each `every` steps, one entry a frame."""

    positions: Array
    vorticity: Array
    velocity: Array
    """(frame, 2, x, y). Not derivable from the vorticity: sound is a large part of it."""
    energy: Array
    """(frame, x, y); one plane if nothing changes it, none without energy."""
    rest: Rest
    """Rest shapes of the step before each frame; for the first frame, of the first step."""
    present: Array
    """Nodes that have grown."""
    edges: Array
    joints: Array


@lru_cache(maxsize=16)
def _program(scene_json: str, every: int) -> Callable[[search.Actuator], tuple]:
    """Return the program from an actuator to the film and the measures.

    The cache of programs spares the second creature of a run the compilation.
    """
    scene = Scene.model_validate_json(scene_json)
    task = build_task(scene)
    changes = energy_changes(scene)

    def run(actuator):
        driven = search.drive(task, actuator)
        film, end, seen = _filmed(task, driven, scene.task.steps // every, every, changes)
        values = search.motion_of(task, driven, end, seen)
        if task.placements is not None or task.trials > 1:
            values = _mean_motion(task, actuator)
        if task.encoding is not None:
            values["hidden_nodes"], values["connections"] = task.encoding.size(actuator)
        return film, values

    return jax.jit(run)


def _filmed(
    task: search.Task, driven: Drive, frames: int, every: int, changes: bool
) -> tuple[Recording, world.State, world.Measures]:
    def frame(state):
        u = world.flow(task.world, state)
        positions = world.unwrapped(driven.world, state)
        return positions, vorticity(u), u, state.energy if changes else None

    def advance(state, given):
        end, seen = search.simulate(replace(driven, start=state, inputs=given))
        return end, (frame(end), seen)

    # Steps behind the last frame are simulated too, since measures are over all steps.
    whole = jax.tree.map(
        lambda x: x[: frames * every].reshape(frames, every, *x.shape[1:]), driven.inputs
    )
    left = jax.tree.map(lambda x: x[frames * every :], driven.inputs)
    end, (shown, seen) = jax.lax.scan(advance, driven.start, whole)
    end, last = search.simulate(replace(driven, start=end, inputs=left))
    seen = jax.tree.map(
        lambda x, y: jnp.concatenate([x.reshape(-1, *x.shape[2:]), y]), seen, last
    )
    positions, curl, velocity, energy = jax.tree.map(
        lambda first, rest: jnp.concatenate([first[None], rest]), frame(driven.start), shown
    )
    if energy is None:
        start = driven.start.energy
        energy = jnp.zeros((0, *task.world.size)) if start is None else start[None]
    before = np.maximum(np.arange(frames + 1) * every - 1, 0)
    rest = jax.tree.map(lambda x: x[before], seen.rest)
    present = world.grown_nodes(driven.world)
    rods = driven.world.rods
    assert rods.joints is not None
    parts = rest, present, rods.edges, rods.joints
    return Recording(positions, curl, velocity, energy, *parts), end, seen


def _mean_motion(task: search.Task, actuator: search.Actuator) -> dict[str, Any]:
    """Combine measures over all trials and placements of energy, as an evaluation does; the
    film shows the first."""
    limits = {name for name, _ in FEASIBLE.values()}

    def measured(one: search.Task, driven: Drive) -> dict[str, Any]:
        return search.motion_of(one, driven, *search.simulate(driven))

    def in_placements(one: search.Task) -> dict[str, Any]:
        driven = search.drive(one, actuator)
        if task.placements is None:
            return measured(one, driven)
        shifted = jax.lax.map(
            lambda shift: measured(one, search.shift_energy(driven, shift)), task.placements
        )
        return mean(shifted)

    def mean(measures: dict[str, Any]) -> dict[str, Any]:
        return {
            name: (jnp.max if name in limits else jnp.mean)(values, 0)
            for name, values in measures.items()
        }

    return (
        in_placements(task) if task.trials == 1 else mean(search.in_trials(task, in_placements))
    )


def _levels(values: np.ndarray, scale: float, kind: type[np.integer]) -> np.ndarray:
    return np.round(values / scale * np.iinfo(kind).max).astype(kind)


def _pack(header: Mapping[str, Any], *arrays: np.ndarray) -> bytes:
    text = json.dumps(header).encode()
    text += b" " * (-len(text) % 4)  # Aligned, so that a browser can view floats in place.
    return struct.pack("<I", len(text)) + text + b"".join(x.tobytes() for x in arrays)
