"""Write the inputs of a creature's evaluation, for the native kernel in a browser."""

from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import Any

import jax
import numpy as np

from .. import search
from ..archive import columns, creature
from ..build import build_point, build_task
from ..device import compiler_options
from ..search.summary import SUMMARISED
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
        goal, found = _inputs(file, scene)
    except search.NotCovered as error:
        return columns.dump(header | {"uncovered": error.reason}, {})
    arrays: Arrays = {}
    trials, placements = found.scales.shape[:2]
    header |= {
        "goal": goal if scene.task.plugin is None else None,
        "measures": SUMMARISED,
        "cycle": scene.control.period if isinstance(scene.control, Gait) else None,
        "copies": 1 if scene.world.copies is None else scene.world.copies.count,
        "numbers": {"develop": dict(found.development), "rollout": dict(found.simulation)},
        "trials": [
            [
                _simulation(_at(found, trial, placement), arrays)
                for placement in range(placements)
            ]
            for trial in range(trials)
        ],
    }
    return columns.dump(header, dict(arrays.values()))


def _inputs(file: Mapping[str, Any], scene: Scene) -> tuple[dict[str, Any], search.Inputs]:
    """Return the goal of a creature's task, and the inputs as NumPy arrays.

    Measures of plug-ins are left out: no kernel computes them.
    """
    task = scene.task
    if task.plugin is not None:
        task = Task(steps=task.steps, trials=task.trials)
    bare = scene.model_copy(update={"task": task, "plugins": {}})
    goal, program = _program(bare.model_dump_json())
    actuator = actuator_of(file, scene)
    if isinstance(scene.control, Gait):
        return goal, jax.device_get(program(actuator, build_point(scene)))
    return goal, jax.device_get(program(actuator))


@lru_cache(maxsize=16)
def _program(scene_json: str) -> tuple[dict[str, Any], Callable[..., search.Inputs]]:
    """Return a goal, and the program from a genotype, or rest shapes and the conditions of a
    point, to the inputs.

    Its compiler options are those of evaluations, for the same bits.
    """
    task = build_task(Scene.model_validate_json(scene_json))

    def found(actuator: search.Actuator, *point: search.Conditions) -> search.Inputs:
        return search.inputs(search.in_conditions(task, *point) if point else task, actuator)

    program = jax.jit(found, compiler_options=compiler_options())
    return {name: getattr(task.goal, name) for name in GOAL}, program


def _at(found: search.Inputs, trial: int, placement: int) -> search.Inputs:
    return jax.tree.map(lambda x: x[trial, placement], found)


def _simulation(found: search.Inputs, arrays: Arrays) -> dict[str, Any]:
    """Return the inputs of one simulation, with arrays by their places in the file."""
    return {
        "develop": [_place(one, arrays) for one in found.develop],
        "rollout": [_place(one, arrays) for one in found.rollout],
        "clock": _place(found.clock, arrays),
        "scales": _place(found.scales, arrays),
        "whole": _place(found.whole, arrays),
        "constant": {name: float(value) for name, value in found.constant.items()},
    }


def _place(array: Any, arrays: Arrays) -> int:
    """Return the place of an array among those of the file, which has each one once."""
    values = np.asarray(array)
    key = values.dtype.name.encode() + str(values.shape).encode() + values.tobytes()
    name, _ = arrays.setdefault(key, (str(len(arrays)), values))
    return int(name)
