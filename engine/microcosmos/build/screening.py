"""Build the screening of a search's offspring."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import jax

from .. import device, search, spec
from ..experiments import screening
from ..experiments.state import Plan, Screening
from ..search.emitters import with_slots
from .emitters import build_emission
from .scene import build_layout, build_period, build_task

FIRST_ROUND = 2**30
"""Number of the first round when keys are derived; smaller numbers are generations."""
MODEL = 2**31
"""Number from which the key of a model's basis functions is derived."""


def build_screening(chosen: spec.Evolution, plan: Plan) -> Screening | None:
    """Build the settings of screening, if the spec asks for it."""
    asked = getattr(chosen.search, "screening", None)
    if asked is None:
        return None
    describe = build_description(chosen, plan)
    shapes = jax.eval_shape(describe, plan.genotype)
    regression = search.screening.Regression(
        inputs=len(shapes.inputs),
        outputs=_outputs(plan).count,
        key=jax.random.fold_in(plan.key, MODEL),
    )
    return Screening(asked.rounds, asked.candidates, asked.unscreened, regression)


def build_screening_programs(chosen: spec.Evolution, plan: Plan) -> screening.Programs | None:
    """Build the programs of screening, if the spec asks for it."""
    if plan.screening is None:
        return None
    outputs, regression = _outputs(plan), plan.screening.regression
    times, states = plan.screening.candidates, (None,) * len(plan.emitters)
    wide = tuple(with_slots(one, times * one.slots) for one in plan.emitters)
    emission = build_emission(replace(plan, emitters=wide))

    def candidates(elites, counters, generation, number, emitter):
        key = jax.random.fold_in(plan.key, FIRST_ROUND + number)
        children, _, counters = emission(states, elites, counters, generation, emitter, key=key)
        return children, counters

    return screening.Programs(
        emit=jax.jit(candidates),
        describe=search.block_program(build_description(chosen, plan)),
        predict=jax.jit(
            lambda described, model, cells: outputs.predict(
                described, regression, model, cells
            ),
            compiler_options=device.compiler_options(),
        ),
        best=jax.jit(search.screening.best, static_argnums=4),
        outputs=outputs.of,
    )


def build_description(chosen: spec.Evolution, plan: Plan) -> Callable[..., Any]:
    """Build the function that describes one genotype without simulating it."""
    scene = chosen.scene
    period = build_period(scene.control)
    assert period is not None  # `spec` refuses screening without a periodic timer.
    task = build_task(scene, room=plan.encoding.room)
    layout = build_layout(spec.shape(scene.body), task.start.positions.dtype)
    strokes = search.screening.Strokes(task, layout, period, scene.task.steps)
    return partial(search.screening.describe, strokes, plan.descriptors)


def _outputs(plan: Plan) -> search.screening.Outputs:
    return search.screening.Outputs(plan.axes, len(plan.measures), plan.feasible)
