"""Cilia: "asymmetrical movement of short filaments attached around a stiff spherical body";
"a stiff stroke sweeps fluid broadside while the recovery stroke curls tightly" (Microcosmos
paper).
"""

import numpy as np

from ... import bodies
from .swimmer import Swimmer, column, still
from .tufted import tufted


def cilia(
    body_nodes: int = 40,
    hairs: int = 6,
    hair_nodes: int = 8,
    spacing: float = 1.0,
    amplitude: float = 1.0,
    curl: float = -0.35,
    power: float = 0.75,
    *,
    stretch: float = 1.0,
    shear: float = 1.0,
    bend: float = 1.0,
) -> Swimmer:
    """A ring with hairs on both flanks that beat together, mirrored about the x axis.

    In the share `power` of a period each hair swings stiffly at its root from `amplitude`
    radians forward (to +x) to as much backward; in the rest it comes back, and its joints
    bend by up to `curl` forward: a negative one lets the tip lag behind.
    It swims forward.
    """
    roots = _roots(body_nodes, hairs)
    body = tufted(
        body_nodes, roots, hair_nodes, spacing, stretch=stretch, shear=shear, bend=bend
    )
    flank = np.where(roots < body_nodes / 2, 1, -1)
    swings, curls = _senses(body, body_nodes, hair_nodes, flank)

    def gait(time):
        swing, bent = stroke(time, amplitude, curl, power)
        return swing * swings[None] + bent * curls[None], still(time, body.edges)

    return Swimmer("cilia", body, gait)


def stroke(time, amplitude: float, curl: float, power: float) -> tuple[np.ndarray, np.ndarray]:
    """How far hairs lean backward and their joints curl forward, as columns over time."""
    t = column(time) % 1
    back = np.clip((t - power) / (1 - power), 0, 1)
    swing = np.where(t < power, -np.cos(np.pi * t / power), np.cos(np.pi * back))
    return amplitude * swing, curl * np.sin(np.pi * back)


def _roots(body_nodes: int, hairs: int) -> np.ndarray:
    """Nodes of the ring with hairs, as many on one flank as on the other."""
    if hairs < 2 or hairs % 2:
        raise ValueError(f"`hairs` must be an even number from 2 on, got {hairs}.")
    flank = np.arange(1, hairs // 2 + 1) / (hairs // 2 + 1)
    nodes = np.round(flank * body_nodes / 2).astype(int)
    return np.concatenate([nodes, (body_nodes - nodes)[::-1]])


def _senses(body: bodies.Body, body_nodes: int, hair_nodes: int, flank: np.ndarray):
    """For every joint, the sign with which it takes part in the swing, and in the curl.

    On the upper flank a hair that swings backward turns anticlockwise, one that curls
    forward clockwise.
    """
    hair = (body.joints - body_nodes) // hair_nodes
    inside = body.joints >= body_nodes
    upward = np.where(inside, flank[np.maximum(hair, 0)], 0)
    curls = np.where(inside.all(1), -upward[:, 1], 0.0)
    swings = np.where(inside.all(1), 0.0, upward[:, 1] - upward[:, 0])
    return swings, curls
