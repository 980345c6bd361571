"""Inputs of a creature's evaluation, written for the native kernel in a browser."""

from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import Any

import jax
import numpy as np

from .. import search
from ..archive import columns, creature
from ..build import build_point, build_task
from ..device import compiler_options
from ..search.evaluation import FEASIBLE
from ..search.window import SUMMARISED
from ..spec import Gait, Scene, Task
from ..viz.replay import actuator_of

GOAL = ("displacement", "energy", "measure", "sign")
Arrays = dict[bytes, tuple[str, np.ndarray]]
"""Arrays by their bytes: calls share most of theirs, and a file has each one once."""


def evaluation_inputs(file: Mapping[str, Any]) -> bytes:
    """Return the inputs of a creature's evaluation, described in `docs/formats.md`.

    Raises `creature.CreatureError` for an invalid file.
    """
    file = creature.parse(file)
    scene = creature.scene_of(file)
    header: dict[str, Any] = {"creature": file["sha256"], "uncovered": None}
    try:
        goal, inputs = _inputs(file, scene)
    except search.NotCovered as error:
        return columns.dump(header | {"uncovered": error.reason}, {})
    arrays: Arrays = {}
    trials, placements = inputs.scales.shape[:2]
    header |= {
        "goal": goal if scene.task.plugin is None else None,
        "measures": SUMMARISED,
        "largest": [name for name, _ in FEASIBLE.values()],
        "cycle": scene.control.period if isinstance(scene.control, Gait) else None,
        "copies": 1 if scene.world.copies is None else scene.world.copies.count,
        "numbers": {"develop": dict(inputs.development), "rollout": dict(inputs.simulation)},
        "trials": [
            [
                _simulation(_at(inputs, trial, placement), arrays)
                for placement in range(placements)
            ]
            for trial in range(trials)
        ],
    }
    return columns.dump(header, dict(arrays.values()))


def _inputs(file: Mapping[str, Any], scene: Scene) -> tuple[dict[str, Any], search.Inputs]:
    """Return the goal of a creature's task, and the inputs as NumPy arrays.

    Measures that a spec names are left out: no kernel computes them.
    """
    task = scene.task
    if task.plugin is not None:
        task = Task(steps=task.steps, trials=task.trials)
    bare = scene.model_copy(update={"task": task, "measures": (), "plugins": {}})
    goal, program = _program(bare.model_dump_json())
    actuator = actuator_of(file, scene)
    if isinstance(scene.control, Gait):
        return goal, jax.device_get(program(actuator, build_point(scene)))
    return goal, jax.device_get(program(actuator))


@lru_cache(maxsize=16)
def _program(scene_json: str) -> tuple[dict[str, Any], Callable[..., search.Inputs]]:
    """Return a goal and the program that computes the inputs.

    The program takes a genotype, or rest shapes and the conditions of a point.
    """
    task = build_task(Scene.model_validate_json(scene_json))

    def inputs(actuator: search.Actuator, *point: search.Conditions) -> search.Inputs:
        return search.inputs(search.in_conditions(task, *point) if point else task, actuator)

    # The compiler options of evaluations, for the same bits.
    program = jax.jit(inputs, compiler_options=compiler_options())
    return {name: getattr(task.goal, name) for name in GOAL}, program


def _at(inputs: search.Inputs, trial: int, placement: int) -> search.Inputs:
    return jax.tree.map(lambda x: x[trial, placement], inputs)


def _simulation(inputs: search.Inputs, arrays: Arrays) -> dict[str, Any]:
    """Return the inputs of one simulation, with arrays by their places in the file."""
    return {
        "develop": [_place(one, arrays) for one in inputs.develop],
        "rollout": [_place(one, arrays) for one in inputs.rollout],
        "clock": _place(inputs.clock, arrays),
        "scales": _place(inputs.scales, arrays),
        "whole": _place(inputs.whole, arrays),
        "constant": {name: float(value) for name, value in inputs.constant.items()},
    }


def _place(array: Any, arrays: Arrays) -> int:
    """Return the place of an array among those of the file, which has each one once."""
    values = np.asarray(array)
    key = values.dtype.name.encode() + str(values.shape).encode() + values.tobytes()
    name, _ = arrays.setdefault(key, (str(len(arrays)), values))
    return int(name)
