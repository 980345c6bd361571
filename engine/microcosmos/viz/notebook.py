"""Films of creatures in a notebook, and replays of simulations by hand."""

from base64 import b64encode
from collections.abc import Mapping
from typing import Any

import numpy as np

from .film import gif
from .replay_file import Replay, read_replay

SMALL = {"width": 280, "frames": 60}
"""Size of a film in a notebook: a few hundred kB."""


class Film:
    """A GIF that a notebook plays."""

    def __init__(self, data: bytes):
        self.data = data

    def _repr_html_(self) -> str:
        return (
            f'<img alt="A replay" src="data:image/gif;base64,{b64encode(self.data).decode()}">'
        )


def show(creature: Mapping[str, Any] | bytes | Replay, **options: Any) -> Film:
    """Return the film of a creature file, the bytes of a replay, or a replay.

    `options` are those of `film.gif`: `width`, `frames`, `rate`, `theme`, `follow` ...
    """
    if isinstance(creature, Mapping):
        from .replay import record  # Loads JAX.

        creature = record(creature)
    replay = read_replay(creature) if isinstance(creature, bytes) else creature
    return Film(gif(replay, **SMALL | options))


def filmed(positions: Any, edges: Any, vorticity: Any, *, every: int = 1) -> Replay:
    """Return a replay of frames from your own simulation, `every` steps apart.

    `positions` are (frame, node, 2) in cells, unwrapped, `edges` (edge, 2) node numbers and
    `vorticity` (frame, x, y) in 1/step.
    """
    positions, vorticity = np.asarray(positions, np.float32), np.asarray(vorticity)
    if positions.ndim != 3 or len(positions) != len(vorticity):
        raise ValueError(
            "`positions` must be (frame, node, 2) with a frame for each of `vorticity`, got "
            f"shapes {positions.shape} and {vorticity.shape}."
        )
    scale = float(np.abs(vorticity).max()) or 1.0
    header = {
        "frames": len(positions),
        "every": every,
        "nodes": positions.shape[1],
        "edges": np.asarray(edges).tolist(),
        "size": list(vorticity.shape[1:]),
        "vorticity": {"scale": scale},
    }
    return Replay(header, positions, np.round(vorticity / scale * 127).astype(np.int8))
