"""Build the identities of a scene's creatures, and the programs that evaluate them."""

from functools import partial
from typing import Any

import jax.numpy as jnp

from .. import naming, search, spec
from ..spec.control import NetworkInputs
from .scene import build_limits, build_stroke, build_task


def identity_template(scene: spec.Scene) -> dict[str, Any]:
    """Return the identity of a scene's creatures without their genes; a gait has none."""
    whole = scene.model_dump(mode="json")
    # Limits as numbers: the default of an empty limit must not change a creature.
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
    genome: dict[str, Any] = {"encoding": control.encoding, "control": written}
    if isinstance(control, NetworkInputs):
        genome |= {"inputs": list(control.inputs), "outputs": list(control.outputs)}
    return genome


def build_block(scene: spec.Scene, room: tuple[int, int] | None = None):
    """Build the compiled program that evaluates a block of genotypes in a scene."""
    task = build_task(scene, room=room)
    return search.block_program(partial(search.evaluate, task))


def build_disturbed_block(scene: spec.Scene, room: tuple[int, int] | None = None):
    """Build the compiled program that evaluates genotypes under disturbed conditions."""
    task = build_task(scene, room=room)
    return search.block_program(
        lambda given: search.reevaluation.evaluate_disturbed(task, *given)
    )


def build_stroke_block(scene: spec.Scene):
    """Build the compiled program that simulates a scene's gait in a block of conditions."""
    gait = scene.control
    assert isinstance(gait, spec.Gait)
    rest = build_stroke(gait, scene.task.steps)
    task = build_task(scene)
    return search.block_program(partial(search.swim, task, rest, period=gait.period))


def build_point(scene: spec.Scene) -> search.Conditions:
    """Build the conditions of one point of a gait sweep."""
    viscosity = scene.world.viscosity
    limits = build_limits(scene.coupling, viscosity, jnp.float32)
    return search.Conditions(jnp.float32(viscosity), limits)
