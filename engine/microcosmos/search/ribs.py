"""Evaluation of creatures for pyribs' schedulers (Tjanaka et al., GECCO 2023)."""

from collections.abc import Callable
from typing import Any

import jax.numpy as jnp
import numpy as np

from ..genomes import Vector
from .cells import Cells, places
from .evaluation import Evaluation


def ribs_function(
    evaluate: Callable[[Vector], Evaluation], cells: Cells, worst: float
) -> Callable[[Any], tuple[np.ndarray, np.ndarray]]:
    """Wrap an evaluation of a batch: from solutions to the objectives and measures of `tell`.

    Measures are from 0 to 1 on the axes' own scales. Genes beyond ±1 count as ±1. pyribs takes
    finite numbers alone, so infeasible solutions have the objective `worst`, which an archive
    refuses whose `threshold_min` is not below it, and a measure of 0.
    """

    def function(solutions: Any) -> tuple[np.ndarray, np.ndarray]:
        genes = np.clip(np.asarray(solutions, np.float32), -1.0, 1.0)
        found = evaluate(Vector(jnp.asarray(genes)))
        place = np.asarray(places(jnp.asarray(found.measures), cells.axes))
        fitness, status = np.asarray(found.fitness), np.asarray(found.status)
        sound = (status == 0) & np.isfinite(fitness) & np.isfinite(place).all(1)
        objective = np.where(sound, fitness, np.float32(worst))
        return objective, np.where(sound[:, None], place, np.float32(0))

    return function
