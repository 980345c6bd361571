"""Derivatives of a creature file's measures, and their reliability."""

from collections.abc import Mapping
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from .. import search
from ..archive import creature
from ..build import build_task
from ..device import compiler_options
from ..viz.replay import actuator_of

By = tuple[str, ...]


def gradient(
    file: Mapping[str, Any],
    of: tuple[str, ...] = ("fitness",),
    by: By = ("genes",),
    *,
    horizon: int | None = None,
    segment: int | None = None,
) -> tuple[dict[str, float], dict[str, dict[str, np.ndarray]]]:
    """Return measures of a creature, and for each its derivatives by parts of the creature.

    Names are those of `search.gradients.parts` and of the measures. `horizon` is the number of
    steps; with `segment`, reverse mode keeps that number of steps in memory.
    Raises `creature.CreatureError` for an invalid file and `ValueError` for unknown names.
    """
    task, actuator = _creature(file, jnp.dtype("float32"))
    values = search.gradients.parts(task, actuator, by)

    def both(values):
        return search.gradients.value_and_jacobian(
            task, actuator, values, of, horizon=horizon, segment=segment
        )

    measured, rows = jax.device_get(jax.jit(both, compiler_options=compiler_options())(values))
    slopes = {name: {part: rows[part][i] for part in rows} for i, name in enumerate(of)}
    return dict(zip(of, measured.tolist(), strict=True)), slopes


def report_gradient(
    file: Mapping[str, Any], of: str = "fitness", by: By = ("genes",), *, starts: int = 8
) -> search.GradientReport:
    """Return the report on a creature file's gradient; raises as `gradient` does."""
    return search.report_gradient(lambda dtype: _creature(file, dtype), of, by, starts=starts)


def _creature(file: Mapping[str, Any], dtype: Any) -> tuple[search.Task, search.Actuator]:
    file = creature.parse(file)
    scene = creature.scene_of(file)
    actuator = jax.tree.map(
        lambda x: jnp.asarray(x, dtype if jnp.issubdtype(x.dtype, jnp.floating) else x.dtype),
        actuator_of(file, scene),
    )
    return build_task(scene, dtype, room=creature.room(file)), actuator
