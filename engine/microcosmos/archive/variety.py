"""Variety: motion distances among the elites of an archive.

The motion distance of two creatures is the root mean square distance of their bodies over one
stroke, in body lengths, after the best rotation and the best shift of phase. Mirror images are
equal, and so are chains with their ends exchanged.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .file import load
from .poses import PoseStream, streams

POINTS = 64
"""Points on each body, at equal arc length along its edges."""
PHASES = 32
"""Poses of a stroke."""
KIND = 0.1
"""Motion distance beyond which two creatures are of different kinds, in body lengths."""
MOST = 512
"""Largest number of creatures that are compared with each other."""
BLOCK = 16
"""Creatures whose correlations with all others are in memory at a time; they fit in a cache."""


@dataclass(frozen=True)
class Variety:
    """Motion distances among creatures, in body lengths."""

    motion_distance: float
    """Mean over pairs."""
    nearest_motion: float
    """Median, over creatures, of the distance to the nearest other one."""
    motion_alone: float
    """Mean over pairs of the distance of poses less their mean over the stroke."""
    kinds: int
    """Creatures that are more than `KIND` from every kind before; the first is one."""
    creatures: int
    compared: int
    """Creatures that were compared: all, or `MOST` at equal intervals in the given order."""


def of(data: bytes) -> Variety:
    """Compare the elites of an archive file, sampled and counted from the fittest.

    Raises `ValueError` for any other file, and for fewer than two elites.
    """
    tree, attributes = load(data)
    fittest_first = np.argsort(-tree["archive"]["fitness"], kind="stable")
    recorded = streams(tree, attributes)
    return variety([recorded[i] for i in fittest_first])


def variety(creatures: Sequence[PoseStream]) -> Variety:
    """Compare creatures, given from the fittest. Raises `ValueError` for fewer than two."""
    if len(creatures) < 2:
        raise ValueError(f"variety needs at least two creatures, got {len(creatures)}")
    chosen = [creatures[i] for i in sample(len(creatures))]
    strokes, chains = _strokes(chosen)
    found = distances(strokes, chains)
    alone = distances(strokes - strokes.mean(1, keepdims=True), chains)
    pairs = np.triu_indices(len(chosen), 1)
    others = np.where(np.eye(len(chosen), dtype=bool), np.inf, found)
    return Variety(
        motion_distance=float(found[pairs].mean(dtype=float)),
        nearest_motion=float(np.median(others.min(1))),
        motion_alone=float(alone[pairs].mean(dtype=float)),
        kinds=len(kinds(found)),
        creatures=len(creatures),
        compared=len(chosen),
    )


def exemplars(creatures: Sequence[PoseStream], most: int) -> list[int]:
    """Return a creature of each kind, at most `most`, given and counted from the fittest.

    All creatures are compared, however many.
    """
    strokes, chains = _strokes(creatures)
    chosen: list[int] = []
    for i in range(len(creatures)):
        if len(chosen) == most:
            break
        compared = [*chosen, i]
        found = distances(strokes[compared], chains[compared])[-1, :-1]
        if np.all(found > KIND):
            chosen.append(i)
    return chosen


def _strokes(creatures: Sequence[PoseStream]) -> tuple[np.ndarray, np.ndarray]:
    """Return strokes, and which creatures are chains."""
    strokes = np.stack([stroke(stream) for stream in creatures])
    return strokes, np.array([is_chain(stream.edges) for stream in creatures])


def sample(count: int) -> np.ndarray:
    """Return the indices of the creatures to compare: at most `MOST`, at equal intervals."""
    return np.arange(min(count, MOST)) * count // min(count, MOST)


def stroke(stream: PoseStream) -> np.ndarray:
    """Return the last stroke as complex places in body lengths: complex64 (phase, point).

    A creature that did not complete two strokes has all recorded frames instead, thinned. Each
    phase is about its mean.
    """
    cells = stream.cells
    every = len(cells) // PHASES
    cells = cells[-PHASES:] if stream.strokes else cells[every - 1 :: every]
    points = along(cells, stream.edges)
    points -= points.mean(1, keepdims=True)
    return (points[..., 0] + 1j * points[..., 1]).astype(np.complex64) / stream.length


def along(positions: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """Return `POINTS` points (phase, point, 2) on edges, at equal arc length in their order.

    Lengths are means over phases of positions (phase, node, 2), so that each point stays at
    one place of the body while edges stretch.
    """
    first, second = edges.T
    steps = positions[:, second] - positions[:, first]
    ends = np.cumsum(np.linalg.norm(steps, axis=2).mean(0))
    places = (np.arange(POINTS) + 0.5) / POINTS * ends[-1]
    edge = np.minimum(np.searchsorted(ends, places), len(edges) - 1)
    starts = np.concatenate([[0], ends[:-1]])
    part = (places - starts[edge]) / np.maximum(ends - starts, 1e-12)[edge]
    return positions[:, first[edge]] + part[None, :, None] * steps[:, edge]


def is_chain(edges: np.ndarray) -> bool:
    """Return whether each edge begins where the one before ends, without a loop."""
    connected = bool(np.all(edges[1:, 0] == edges[:-1, 1]))
    return connected and len(np.unique(edges)) == len(edges) + 1


def distances(strokes: np.ndarray, chains: np.ndarray) -> np.ndarray:
    """Return motion distances (creature, creature) of strokes (creature, phase, point).

    `chains` marks creatures whose ends may be exchanged. The correlation at all shifts of
    phase is a product for each temporal frequency; its modulus is that after the best rotation.
    """
    power = (np.abs(strokes) ** 2).sum((1, 2))
    spectrum = _spectrum(strokes).conj()
    plain = [_spectrum(form) for form in (strokes, strokes.conj())]
    exchanged = [np.ascontiguousarray(other[..., ::-1]) for other in plain if chains.any()]
    squared = np.zeros((len(strokes),) * 2, np.float32)
    for start in range(0, len(strokes), BLOCK):
        rows = slice(start, start + BLOCK)
        best = _correlation(spectrum[:, rows], [other[:, start:] for other in plain])
        if exchanged:
            allowed = chains[rows, None] | chains[None, start:]
            more = _correlation(spectrum[:, rows], [other[:, start:] for other in exchanged])
            best = np.where(allowed, np.maximum(best, more), best)
        squared[rows, start:] = power[rows, None] + power[None, start:] - 2 * best
    found = np.sqrt(np.maximum(squared, 0) / strokes[0].size)
    upper = np.triu(found, 1)
    return upper + upper.T


def _correlation(spectrum: np.ndarray, others: list[np.ndarray]) -> np.ndarray:
    """Return the largest correlation of each pair over shifts of phase and over `others`."""
    products = (spectrum @ other.swapaxes(1, 2) for other in others)
    shifted = [np.abs(np.fft.ifft(product, axis=0)).max(0) for product in products]
    return np.maximum.reduce(shifted)


def _spectrum(strokes: np.ndarray) -> np.ndarray:
    """Return the Fourier transform over phases: complex64 (frequency, creature, point)."""
    return np.ascontiguousarray(np.fft.fft(strokes, axis=1).swapaxes(0, 1), np.complex64)


def kinds(found: np.ndarray) -> list[int]:
    """Return the creatures that are more than `KIND` from each kind before them."""
    chosen: list[int] = []
    for i, row in enumerate(found):
        if np.all(row[chosen] > KIND):
            chosen.append(i)
    return chosen
