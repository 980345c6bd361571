"""Placement of bodies, and their combination into one world."""

from collections.abc import Sequence
from dataclasses import fields, replace

import numpy as np

from .graph import Body

INDEXED_BY = {"edges": "positions", "joints": "edges"}


def placed(body: Body, centre: Sequence[int | float] | np.ndarray, turned: float = 0.0) -> Body:
    """Turn a body anticlockwise about its mean node position and move that to `centre`."""
    c, s = np.cos(turned), np.sin(turned)
    arms = body.positions - body.positions.mean(0)
    rotated = arms @ np.array([[c, s], [-s, c]]) if turned else arms
    return replace(body, positions=rotated + np.asarray(centre, float))


def together(bodies: Sequence[Body]) -> Body:
    """Combine bodies into one, their creatures numbered in turn."""
    if not bodies:
        raise ValueError("`bodies` must hold at least one body, got none.")
    arrays = {}
    for name in (f.name for f in fields(Body) if f.name != "crossing"):
        parts = [getattr(body, name) for body in bodies]
        arrays[name] = np.concatenate(parts)
        if name in INDEXED_BY:
            sizes = [len(getattr(body, INDEXED_BY[name])) for body in bodies]
            arrays[name] = arrays[name] + _offsets(sizes, parts)[:, None]
    counts = [body.count for body in bodies]
    arrays["member"] = arrays["member"] + _offsets(counts, [b.member for b in bodies])
    return Body(**arrays, crossing=any(body.crossing for body in bodies))


def _offsets(sizes: list[int], parts: list[np.ndarray]) -> np.ndarray:
    """Return, for each entry of the joined parts, the sizes of the bodies before it."""
    return np.repeat(np.cumsum([0, *sizes[:-1]]), [len(part) for part in parts])
