"""A replay: the recorded motion of one creature over the fluid's vorticity.

The program that records rounds differently from the one that evaluates, and rollouts are
chaotic, so a replay says how far its fitness is from the recorded one.
"""

import json
import struct
from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from .. import search, world
from ..archive import creature
from ..build import build_task
from ..device import device_kind
from ..fluid import vorticity
from ..genomes import CPPN, develop, from_genes
from ..spec import Spec, parse

FORMAT = "microcosmos-replay/1"
FRAMES = 250
"""About as many frames as are kept, whatever the number of steps."""


def record(file: Mapping[str, Any]) -> bytes:
    """The replay of a creature file: JSON header, float32 positions, int8 vorticity.

    The layout is described in `docs/formats.md`. Raises `creature.CreatureError` for a
    file that is not sound.
    """
    file = creature.parse(file)
    spec = creature.spec_of(file)
    network = network_of(file, spec)
    every = max(1, spec.task.steps // FRAMES)
    positions, curl, features = jax.device_get(_program(spec.model_dump_json(), every)(network))
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
        "edges": build_task(spec).controls.edges.tolist(),
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
