"""Epochs of a search along learned axes: when they were learned, and what became of elites."""

from dataclasses import replace
from typing import Any

import equinox as eqx
import numpy as np
from jaxtyping import Float, Int

from .. import search


class Epochs(eqx.Module):
    """A row for each time that axes were learned, in NumPy arrays."""

    generation: Int[np.ndarray, "epoch"]
    explained: Float[np.ndarray, "epoch axis"]
    """Share of the variance of all measures along each axis."""
    before: Int[np.ndarray, "epoch"]
    """Elites before this generation's insertion."""
    after: Int[np.ndarray, "epoch"]
    displaced: Int[np.ndarray, "epoch"]
    """Elites that lost their place in it."""


def no_epochs(container: search.Container) -> Epochs | None:
    """Return the record before the first epoch; None for axes that are not learned."""
    if not isinstance(container, search.LearnedAxes):
        return None
    shares = np.zeros((0, container.dimensions), np.float32)
    return Epochs(none := np.zeros(0, np.int32), shares, none, none, none)


def recorded(
    epochs: Epochs | None,
    container: search.Container,
    generation: int,
    before: search.Elites,
    after: search.Elites,
) -> Epochs | None:
    """Return the record after the insertion of a generation; a new epoch adds a row."""
    if epochs is None or not isinstance(container, search.LearnedAxes):
        return None
    if container.epoch == len(epochs.generation):
        return epochs
    there, here = np.asarray(before.occupied), np.asarray(after.occupied)
    same = here & (np.asarray(before.generation) == np.asarray(after.generation))
    same &= np.asarray(before.slot) == np.asarray(after.slot)
    row = {
        "generation": generation,
        "explained": np.asarray(container.learned.explained),
        "before": np.count_nonzero(there),
        "after": np.count_nonzero(here),
        "displaced": np.count_nonzero(there & ~same),
    }
    columns = vars(epochs).items()
    grown = {n: np.concatenate([x, np.asarray(row[n], x.dtype)[None]]) for n, x in columns}
    return replace(epochs, **grown)


def summary(epochs: Epochs | None, generation: int) -> dict[str, Any]:
    """Return the figures of a generation in which axes were learned; else nothing."""
    if epochs is None or generation not in epochs.generation[-1:]:
        return {}
    return {
        "epoch": len(epochs.generation),
        "explained variance": float(np.add.accumulate(epochs.explained[-1])[-1]),
        "displaced": int(epochs.displaced[-1]),
    }
