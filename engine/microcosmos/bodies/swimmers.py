"""The five swimmers of the Microcosmos paper and their hand-made gaits; free of JAX."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Unpack

import numpy as np

from ..invalid import InvalidField
from .builders import arc, chain, ring
from .graph import Body
from .shape import Stiffness, from_edges

Gait = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]
"""A function from times in periods to deviations of the rest shape.

It returns deviations (time, joint) of rest angles in rad, and relative deviations (time, edge)
of rest lengths.
"""


@dataclass(frozen=True)
class Swimmer:
    """A body at rest, and the deviation of its rest shape over time.

    The rest angle is `body.rest_angle + angle`, the rest length `body.rest_length * (1 +
    length)`. The gait repeats every period; a ramp that multiplies it starts it from rest.
    """

    name: str
    body: Body
    gait: Gait


def worm(
    nodes: int = 32,
    spacing: float = 1.0,
    amplitude: float = 0.15,
    waves: float = 1.0,
    **stiffness: Unpack[Stiffness],
) -> Swimmer:
    """Return a filament with a bending wave from its first node to its last.

    The joint at share s of the way bends by `amplitude` sin 2π (`waves` s − t) radians. The
    worm swims against the wave, its first node ahead. "A similar sinusoidal wave propagation
    along a soft filament" (Microcosmos paper, hand-designed locomotion).
    """
    body = chain(nodes, spacing, **stiffness)
    share = np.linspace(0, 1, len(body.joints))

    def gait(time):
        return _wave(time, share, amplitude, waves), _still(time, body.edges)

    return Swimmer("worm", body, gait)


def tadpole(
    head_nodes: int = 14,
    tail_nodes: int = 24,
    spacing: float = 1.0,
    amplitude: float = 0.18,
    waves: float = 1.0,
    **stiffness: Unpack[Stiffness],
) -> Swimmer:
    """Return a ring with a tail, along which a bending wave runs away from the ring.

    Joints between edges of the tail bend like a worm's; the others keep their angle. The
    tadpole swims head first, "reaching lower speeds because of the drag caused by its head"
    (Microcosmos paper).
    """
    body = _ring_with_hairs(head_nodes, np.array([0]), tail_nodes, spacing, **stiffness)
    bends = np.all(body.joints >= head_nodes, 1)
    share = (np.cumsum(bends) - 1) / max(bends.sum() - 1, 1)

    def gait(time):
        return bends[None] * _wave(time, share, amplitude, waves), _still(time, body.edges)

    return Swimmer("tadpole", body, gait)


def ray(
    nodes: int = 31,
    spacing: float = 1.0,
    offset: float = 0.5,
    amplitude: float = 0.8,
    **stiffness: Unpack[Stiffness],
) -> Swimmer:
    """Return a filament whose middle joint bends by `offset` + `amplitude` sin 2π t radians.

    The motion is reciprocal: without inertia the ray must not move (Purcell 1977, the scallop
    theorem). "Beating via a single time-dependent angle constraint" (Microcosmos paper).
    """
    body = chain(nodes, spacing, **stiffness)
    middle = np.arange(len(body.joints)) == len(body.joints) // 2

    def gait(time):
        beat = offset + amplitude * np.sin(2 * np.pi * _column(time))
        return beat * middle[None], _still(time, body.edges)

    return Swimmer("ray", body, gait)


def jellyfish(
    nodes: int = 32,
    spacing: float = 1.0,
    gap: float = 0.25,
    bending: float = 0.25,
    stretching: float = 0.08,
    phase: float = 0.25,
    **stiffness: Unpack[Stiffness],
) -> Swimmer:
    """Return an open circle that bends and stretches uniformly.

    Angles deviate by `bending` sin 2π t of themselves, lengths by `stretching`
    sin 2π (t + `phase`); at a quarter of a period the motion is not reciprocal. The opening is
    at +x; with inertia the jellyfish swims away from it. "Contractile movement via uniform
    distance and bending constraints on an open circle" (Microcosmos paper).
    """
    body = arc(nodes, spacing, gap, **stiffness)

    def gait(time):
        close = bending * np.sin(2 * np.pi * _column(time))
        lengthen = stretching * np.sin(2 * np.pi * (_column(time) + phase))
        return close * body.rest_angle[None], lengthen * np.ones((1, len(body.edges)))

    return Swimmer("jellyfish", body, gait)


def cilia(
    body_nodes: int = 40,
    hairs: int = 6,
    hair_nodes: int = 8,
    spacing: float = 1.0,
    amplitude: float = 1.0,
    curl: float = -0.35,
    power: float = 0.75,
    **stiffness: Unpack[Stiffness],
) -> Swimmer:
    """Return a ring with hairs on both flanks that beat together, mirrored about the x axis.

    In the share `power` of a period each hair swings stiffly at its root from `amplitude`
    radians forward (to +x) to as much backward. Then it returns while its joints bend by up
    to `curl` forward; with a negative one the tip lags behind. The body swims forward.
    "Asymmetrical movement of short filaments attached around a stiff spherical body": "a
    stiff stroke sweeps fluid broadside while the recovery stroke curls tightly" (Microcosmos
    paper).
    """
    roots = _roots(body_nodes, hairs)
    body = _ring_with_hairs(body_nodes, roots, hair_nodes, spacing, **stiffness)
    flank = np.where(roots < body_nodes / 2, 1, -1)
    swings, curls = _signs(body, body_nodes, hair_nodes, flank)

    def gait(time):
        swing, bent = _stroke(time, amplitude, curl, power)
        return swing * swings[None] + bent * curls[None], _still(time, body.edges)

    return Swimmer("cilia", body, gait)


SWIMMERS = {one.__name__: one for one in (worm, tadpole, ray, cilia, jellyfish)}


def _stroke(time, amplitude: float, curl: float, power: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the backward lean of hairs and the forward curl of joints over time."""
    t = _column(time) % 1
    back = np.clip((t - power) / (1 - power), 0, 1)
    swing = np.where(t < power, -np.cos(np.pi * t / power), np.cos(np.pi * back))
    return amplitude * swing, curl * np.sin(np.pi * back)


def _roots(body_nodes: int, hairs: int) -> np.ndarray:
    if hairs < 2 or hairs % 2:
        raise InvalidField("hairs", f"must be an even number from 2 on, got {hairs}.")
    flank = np.arange(1, hairs // 2 + 1) / (hairs // 2 + 1)
    nodes = np.round(flank * body_nodes / 2).astype(int)
    return np.concatenate([nodes, (body_nodes - nodes)[::-1]])


def _signs(body: Body, body_nodes: int, hair_nodes: int, flank: np.ndarray):
    """Return the sign of every joint in the swing, and in the curl.

    On the upper flank a hair that swings backward turns anticlockwise, one that curls
    forward clockwise.
    """
    hair = (body.joints - body_nodes) // hair_nodes
    inside = body.joints >= body_nodes
    upward = np.where(inside, flank[np.maximum(hair, 0)], 0)
    curls = np.where(inside.all(1), -upward[:, 1], 0.0)
    swings = np.where(inside.all(1), 0.0, upward[:, 1] - upward[:, 0])
    return swings, curls


def _ring_with_hairs(
    ring_nodes: int,
    roots: np.ndarray,
    hair_nodes: int,
    spacing: float,
    **stiffness: Unpack[Stiffness],
) -> Body:
    """Build a ring with a straight hair outward from each of its nodes `roots`.

    Nodes and edges of the ring come first, `ring_nodes` of both; those of each hair follow,
    from its root to its tip.
    """
    whole = ring(ring_nodes, spacing)
    base = whole.positions[roots]
    away = base / np.hypot(base[:, 0], base[:, 1])[:, None]
    along = spacing * np.arange(1, hair_nodes + 1)
    hairs = base[:, None] + along[None, :, None] * away[:, None]
    outer = ring_nodes + np.arange(len(roots) * hair_nodes).reshape(-1, hair_nodes)
    inner = np.concatenate([roots[:, None], outer[:, :-1]], 1)
    edges = np.stack([inner.reshape(-1), outer.reshape(-1)], 1)
    return from_edges(
        np.concatenate([whole.positions, hairs.reshape(-1, 2)]),
        np.concatenate([whole.edges, edges]),
        **stiffness,
    )


def _wave(time, share: np.ndarray, amplitude: float, waves: float) -> np.ndarray:
    return amplitude * np.sin(2 * np.pi * (waves * share[None] - _column(time)))


def _column(time: np.ndarray) -> np.ndarray:
    return np.asarray(time, float)[:, None]


def _still(time: np.ndarray, items: np.ndarray) -> np.ndarray:
    return np.zeros((len(time), len(items)))
