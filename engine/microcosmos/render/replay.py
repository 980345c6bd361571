"""A replay: the recorded motion of one creature over the fluid's vorticity.

The program that records rounds differently from the one that evaluates, and rollouts are
chaotic, so a replay says how far its fitness is from the recorded one.
"""

import json
import struct
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import lru_cache
from math import ceil
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array

from .. import search, world
from ..archive import creature
from ..build import build_encoding, build_stroke, build_task
from ..device import device_kind
from ..fluid import vorticity
from ..genomes import Drive
from ..spec import Gait, Scene, shape
from ..spec.estimate import placements, simulation

FORMAT = "microcosmos-replay/1"
FRAMES = 250
"""At most so many frames are kept besides the first, whatever the number of steps."""

FRAME_BYTES = 2**28
"""At most about so many bytes of vorticity are held while a replay is made."""

ROOM = (8, 8)
"""Where there is no network."""

CELL_STEPS = 3 * 10**10
"""Fluid cells times steps that a replay may take: minutes."""


def record(file: Mapping[str, Any]) -> bytes:
    """The replay of a creature file: JSON header, float32 positions, int8 vorticity.

    The layout is described in `docs/formats.md`. Raises `creature.CreatureError` for a
    file that is not sound.
    """
    file = creature.parse(file)
    scene = creature.scene_of(file)
    nodes, _ = creature.room(file) or (0, 0)
    every = interval(scene, nodes)
    program = _program(scene.model_dump_json(), every)
    positions, curl, features, present = jax.device_get(program(actuator_of(file, scene)))
    if not (np.isfinite(positions).all() and np.isfinite(curl).all()):
        needed = "a creature whose simulation stays finite"
        raise creature.CreatureError("identity", needed, "one that diverges")
    positions = np.asarray(positions[:, present], "<f4")
    replayed = {name: float(value) for name, value in features.items()}
    measured = file["measured"] or {}
    recorded = measured.get("fitness")
    fitness = creature.fitness_of(scene.task, replayed)
    scale = float(np.max(np.abs(curl))) or 1.0
    names = list(measured.get("descriptors", ())) or ["bending_effort", "stretching_effort"]
    header = {
        "format": FORMAT,
        "creature": file["sha256"],
        "frames": len(positions),
        "every": every,
        "steps": scene.task.steps,
        "nodes": positions.shape[1],
        "edges": edges_among(shape(scene.body).edges, present).tolist(),
        "size": [scene.world.width, scene.world.height],
        "vorticity": {"scale": scale},
        "fitness": {
            "recorded": recorded,
            "replayed": fitness,
            "difference": None if recorded is None else fitness - recorded,
        },
        "descriptors": {
            "recorded": measured.get("descriptors"),
            "replayed": {name: replayed[name] for name in names},
        },
        "force_free": scene.coupling.force_free,
        "device": device_kind(),
    }
    return _pack(header, positions, np.round(curl / scale * 127).astype(np.int8))


def edges_among(edges: np.ndarray, present: np.ndarray) -> np.ndarray:
    """The edges (edge, 2) between nodes that are present, as those are counted."""
    return (np.cumsum(present) - 1)[edges[present[edges].all(1)]]


def interval(scene: Scene, network_nodes: int) -> int:
    """Every how many steps a frame is kept.

    Raises `creature.CreatureError` where the simulation is too long or too large to watch.
    """
    cells = scene.world.width * scene.world.height
    several = placements(scene.world)
    lives = 1 + several if several > 1 else 1  # The one that is shown, and those of the mean.
    for field, limit, found, unit in (
        ("task.steps", CELL_STEPS, cells * scene.task.steps * lives, "cell steps"),
        ("body.nodes", 2**32, simulation(scene, network_nodes), "bytes of memory"),
    ):
        if found > limit:
            raise creature.CreatureError(
                field, f"at most {limit:.1e} {unit} for a replay", found
            )
    frames = min(FRAMES, max(2, FRAME_BYTES // (4 * cells)))
    return ceil(scene.task.steps / frames)


def actuator_of(file: Mapping[str, Any], scene: Scene) -> search.Actuator:
    """What moves the body of a parsed creature file: its genotype, or a gait's rest shapes."""
    if isinstance(scene.control, Gait):
        return build_stroke(scene.control, scene.task.steps)
    encoding = build_encoding(scene, creature.room(file) or ROOM)
    return encoding.read(file["identity"]["genome"])


@lru_cache(maxsize=16)
def _program(scene_json: str, every: int) -> Callable[[search.Actuator], tuple]:
    """From an actuator to positions (frame, node, 2), vorticity (frame, x, y), features and
    which nodes are present.

    Frames are the start and the state after each `every` steps. Compiled programs are
    kept, so that the second creature of a run is shown at once.
    """
    scene = Scene.model_validate_json(scene_json)
    task = build_task(scene)
    frames = scene.task.steps // every

    def frame(state):
        return state.positions, vorticity(world.flow(task.world, state))

    def run(actuator):
        driven = search.drive(task, actuator)

        def go_on(state, given):
            return search.simulate(replace(driven, start=state, inputs=given))

        def advance(state, given):
            end, seen = go_on(state, given)
            return end, (frame(end), seen)

        whole = jax.tree.map(
            lambda x: x[: frames * every].reshape(frames, every, *x.shape[1:]), driven.inputs
        )
        left = jax.tree.map(lambda x: x[frames * every :], driven.inputs)
        end, (shown, seen) = jax.lax.scan(advance, driven.start, whole)
        end, last = go_on(end, left)
        seen = jax.tree.map(
            lambda x, y: jnp.concatenate([x.reshape(-1, *x.shape[2:]), y]), seen, last
        )
        positions, curl = jax.tree.map(
            lambda first, rest: jnp.concatenate([first[None], rest]), frame(driven.start), shown
        )
        values = search.motion_of(task, driven, end, seen)
        if task.placements is not None:
            values = _mean_motion(task, driven)
        if task.encoding is not None:
            values["hidden_nodes"], values["connections"] = task.encoding.size(actuator)
        there = driven.world.present
        everybody = jnp.ones(positions.shape[1], bool)
        return positions, curl, values, everybody if there is None else there

    return jax.jit(run)


def _mean_motion(task: search.Task, driven: Drive) -> dict[str, Any]:
    """What is measured on the mean over all placements of energy; the first one is shown."""

    def motion(shift: Array) -> dict[str, Any]:
        moved = search.elsewhere(driven, shift)
        return search.motion_of(task, moved, *search.simulate(moved))

    found = jax.lax.map(motion, task.placements)
    return jax.tree.map(lambda x: jnp.mean(x, 0), found)


def _pack(header: Mapping[str, Any], positions: np.ndarray, curl: np.ndarray) -> bytes:
    text = json.dumps(header).encode()
    text += b" " * (-len(text) % 4)  # Aligned, so that a browser can view floats in place.
    return struct.pack("<I", len(text)) + text + positions.tobytes() + curl.tobytes()
