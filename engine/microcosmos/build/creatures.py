"""From a scene to what its creatures are called, and the programs that evaluate them."""

from functools import partial
from typing import Any

import jax.numpy as jnp

from .. import naming, search, spec
from ..spec.control import Sight
from .scene import build_limits, build_stroke, build_task


def frame(scene: spec.Scene) -> dict[str, Any]:
    """The identity of a scene's creatures but for their genes."""
    whole = scene.model_dump(mode="json")
    # In numbers: a creature must not change with what an empty limit stands for.
    limits = {
        "max_displacement": scene.coupling.displacement_limit(scene.world.viscosity),
        "max_force": scene.coupling.force_limit(scene.world.viscosity),
    }
    return {
        "format": naming.FORMAT,
        "genome": _genome(scene.control),
        "world": whole["world"] | {"coupling": whole["coupling"] | limits},
        "body": whole["body"],
        "task": whole["task"],
    }


def _genome(control: spec.Controller | spec.Gait | spec.Fold) -> dict[str, Any]:
    written = control.model_dump(mode="json")
    if isinstance(control, spec.Gait):
        return {"encoding": "gait", **written}
    told: dict[str, Any] = {"encoding": control.encoding, "control": written}
    if isinstance(control, Sight):
        told |= {"inputs": list(control.inputs), "outputs": list(control.outputs)}
    return told


def build_block(scene: spec.Scene, room: tuple[int, int] | None = None):
    """The compiled program that evaluates a block of genotypes in a scene."""
    task = build_task(scene, room=room)
    return search.block_program(partial(search.evaluate, task))


def build_disturbed_block(scene: spec.Scene, room: tuple[int, int] | None = None):
    """The compiled program that evaluates genotypes under disturbed conditions."""
    task = build_task(scene, room=room)
    return search.block_program(
        lambda given: search.reevaluation.evaluate_disturbed(task, *given)
    )


def build_stroke_block(scene: spec.Scene):
    """The compiled program that carries out a scene's gait in a block of conditions."""
    gait = scene.control
    assert isinstance(gait, spec.Gait)
    rest = build_stroke(gait, scene.task.steps)
    task = build_task(scene)
    return search.block_program(partial(search.swim, task, rest, period=gait.period))


def build_point(scene: spec.Scene) -> search.Conditions:
    """The conditions of one point of a sweep."""
    viscosity = scene.world.viscosity
    limits = build_limits(scene.coupling, viscosity, jnp.float32)
    return search.Conditions(jnp.float32(viscosity), limits)
