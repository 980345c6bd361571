"""A replay: the recorded motion of one creature over the fluid's vorticity.

The program that records rounds differently from the one that evaluates, and rollouts are
chaotic, so a replay says how far its fitness is from the recorded one.
"""

import json
import struct
from collections.abc import Callable, Mapping
from functools import lru_cache
from math import ceil
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from .. import search, world
from ..archive import creature
from ..build import build_body, build_task
from ..device import device_kind
from ..fluid import vorticity
from ..genomes import CPPN, develop, from_genes
from ..spec import Spec, estimate, parse

FORMAT = "microcosmos-replay/1"
FRAMES = 250
"""At most so many frames are kept besides the first, whatever the number of steps."""

FRAME_BYTES = 2**28
"""At most about so many bytes of vorticity are held while a replay is made."""

CELL_STEPS = 3 * 10**10
"""Fluid cells times steps that a replay may take: minutes."""


def record(file: Mapping[str, Any]) -> bytes:
    """The replay of a creature file: JSON header, float32 positions, int8 vorticity.

    The layout is described in `docs/formats.md`. Raises `creature.CreatureError` for a
    file that is not sound.
    """
    file = creature.parse(file)
    spec = creature.spec_of(file)
    every = interval(spec)
    program = _program(spec.model_dump_json(), every)
    positions, curl, features = jax.device_get(program(network_of(file, spec)))
    if not (np.isfinite(positions).all() and np.isfinite(curl).all()):
        needed = "a creature whose simulation stays finite"
        raise creature.CreatureError("identity", needed, "one that diverges")
    positions = np.asarray(positions, "<f4")
    replayed = dict(zip(search.FEATURES, features.tolist(), strict=True))
    measured = file["measured"] or {}
    recorded = measured.get("fitness")
    scale = float(np.max(np.abs(curl))) or 1.0
    names = list(measured.get("descriptors", ())) or ["bending_effort", "stretching_effort"]
    header = {
        "format": FORMAT,
        "creature": file["sha256"],
        "frames": len(positions),
        "every": every,
        "steps": spec.task.steps,
        "nodes": positions.shape[1],
        "edges": build_body(spec.body).edges.tolist(),
        "size": [spec.world.width, spec.world.height],
        "vorticity": {"scale": scale},
        "fitness": {
            "recorded": recorded,
            "replayed": replayed["displacement"],
            "difference": None if recorded is None else replayed["displacement"] - recorded,
        },
        "descriptors": {
            "recorded": measured.get("descriptors"),
            "replayed": {name: replayed[name] for name in names},
        },
        "device": device_kind(),
    }
    return _pack(header, positions, np.round(curl / scale * 127).astype(np.int8))


def interval(spec: Spec) -> int:
    """Every how many steps a frame is kept.

    Raises `creature.CreatureError` where the simulation is too long or too large to watch.
    """
    work = estimate(spec)
    cells = spec.world.width * spec.world.height
    for field, limit, found in (
        ("task.steps", CELL_STEPS, work.cell_steps),
        ("body.nodes", 2**32, work.memory_bytes),
    ):
        if found > limit:
            unit = "cell steps" if limit == CELL_STEPS else "bytes of memory"
            raise creature.CreatureError(
                field, f"at most {limit:.1e} {unit} for a replay", found
            )
    frames = min(FRAMES, max(2, FRAME_BYTES // (4 * cells)))
    return ceil(spec.task.steps / frames)


def network_of(file: Mapping[str, Any], spec: Spec) -> CPPN:
    """The network of a parsed creature file in the spec's room."""
    genome = file["identity"]["genome"]
    return from_genes(genome, spec.genome.max_nodes, spec.genome.max_connections)


@lru_cache(maxsize=16)
def _program(spec_json: str, every: int) -> Callable[[CPPN], tuple]:
    """From a network to positions (frame, node, 2), vorticity (frame, x, y) and features.

    Frames are the start and the state after each `every` steps. Compiled programs are
    kept, so that the second creature of a run is shown at once.
    """
    spec = parse(json.loads(spec_json))
    task = build_task(spec)
    frames = spec.task.steps // every

    def frame(state):
        return state.positions, vorticity(world.flow(task.world, state))

    def advance(state, rest):
        end, centres = world.rollout(task.world, state, rest, search.centre)
        return end, (frame(end), centres)

    def run(network):
        rest = develop(network, task.controls)
        whole = jax.tree.map(lambda x: x[: frames * every].reshape(frames, every, -1), rest)
        left = jax.tree.map(lambda x: x[frames * every :], rest)
        end, (shown, centres) = jax.lax.scan(advance, task.start, whole)
        end, last = world.rollout(task.world, end, left, search.centre)
        centres = jnp.concatenate([centres.reshape(-1, 2), last])
        positions, curl = jax.tree.map(
            lambda first, rest: jnp.concatenate([first[None], rest]), frame(task.start), shown
        )
        return positions, curl, search.measure(task, network, rest, end, centres)

    return jax.jit(run)


def _pack(header: Mapping[str, Any], positions: np.ndarray, curl: np.ndarray) -> bytes:
    text = json.dumps(header).encode()
    text += b" " * (-len(text) % 4)  # Aligned, so that a browser can view floats in place.
    return struct.pack("<I", len(text)) + text + positions.tobytes() + curl.tobytes()
