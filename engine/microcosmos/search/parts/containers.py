"""Figures of containers: of Pareto fronts, and of axes when they are learned anew."""

from dataclasses import replace

import equinox as eqx
import numpy as np
from jaxtyping import Float, Int

from ..containers import Container, FrontFigures, Fronts, LearnedAxes, front_figures
from ..insertion import Elites
from ..loop import Leaf, Part, Turn
from .records import Curves, columns_of

FRONT_FIGURES = FrontFigures._fields


def fronts() -> Part:
    """Return the part that measures the Pareto fronts of each generation."""
    return Part(
        name="fronts",
        begin=lambda plan: Curves(np.zeros((0, len(FRONT_FIGURES)))),
        leaves={"rows": columns_of("fronts", FRONT_FIGURES)},
        learn=_with_fronts,
        figures=lambda own, turn: dict(zip(FRONT_FIGURES, own.rows[-1].tolist(), strict=True)),
    )


def _with_fronts(own: Curves, turn: Turn) -> tuple[Curves, Turn]:
    container, elites = turn.after.container, turn.after.elites
    assert isinstance(container, Fronts)
    occupied = np.asarray(elites.occupied)
    rows = np.asarray(elites.fitness)[occupied], np.asarray(elites.measures)[occupied]
    row = np.array(front_figures(*rows, container))
    return Curves(np.concatenate([own.rows, row[None]])), turn


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


def epochs(dimensions: int) -> Part:
    """Return the part that records the elites displaced by newly learned axes."""
    none = np.zeros(0, np.int32)
    shares = np.zeros((0, dimensions), np.float32)
    return Part(
        name="epochs",
        begin=lambda plan: Epochs(none, shares, none, none, none),
        leaves={
            name: Leaf("row", f"learned/{name}")
            for name in ("generation", "explained", "before", "after", "displaced")
        },
        placed=lambda own, turn: (_with_epoch(own, turn), turn),
        figures=_epoch_figures,
    )


def _with_epoch(own: Epochs, turn: Turn) -> Epochs:
    """Return the record after an insertion; a new epoch adds a row."""
    container: Container = turn.settled.container
    assert isinstance(container, LearnedAxes)
    if container.epoch == len(own.generation):
        return own
    before, after = turn.before.elites, turn.settled.elites
    row = {
        "generation": turn.number,
        "explained": np.asarray(container.learned.explained),
        "before": np.count_nonzero(np.asarray(before.occupied)),
        "after": np.count_nonzero(np.asarray(after.occupied)),
        "displaced": _displaced(before, after),
    }
    columns = vars(own).items()
    return replace(
        own,
        **{n: np.concatenate([x, np.asarray(row[n], x.dtype)[None]]) for n, x in columns},
    )


def _displaced(before: Elites, after: Elites) -> int:
    """Return the number of elites that lost their place."""
    occupied, still = np.asarray(before.occupied), np.asarray(after.occupied)
    same = still & (np.asarray(before.generation) == np.asarray(after.generation))
    same &= np.asarray(before.slot) == np.asarray(after.slot)
    return int(np.count_nonzero(occupied & ~same))


def _epoch_figures(own: Epochs, turn: Turn) -> dict[str, int | float]:
    """Return the figures of a generation in which axes were learned; else nothing."""
    if turn.number not in own.generation[-1:]:
        return {}
    return {
        "epoch": len(own.generation),
        "explained_variance": float(np.add.accumulate(own.explained[-1])[-1]),
        "displaced": int(own.displaced[-1]),
    }
