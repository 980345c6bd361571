"""Build named measures, and encodings, swimmers and emitters of plug-ins, and check their
results."""

from collections.abc import Callable
from dataclasses import is_dataclass
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array

from .. import genomes, plugins, search, spec
from ..bodies import swimmers
from ..measures import MEASURES
from ..spec.emitters import PluginEmitter


def build_measures(scene: spec.Scene) -> tuple[search.Measure, ...]:
    """Build the named measures of a scene: built-in ones, then those of plug-ins by name."""
    task, versions = scene.task, dict(scene.plugins)
    kinds = dict.fromkeys(versions, "descriptor")
    if task.plugin is not None:
        versions[task.fitness], kinds[task.fitness] = task.plugin, "fitness"
    built_in = [
        search.Measure(name, _checked(name, MEASURES[name].of)) for name in scene.measures
    ]
    return (
        *built_in,
        *(_measure(kinds[name], name, versions[name]) for name in sorted(versions)),
    )


def measures_of(scene: spec.Scene) -> tuple[str, ...]:
    """Return the names of a scene's measures, in the order of recording."""
    return search.MEASURES + tuple(measure.name for measure in build_measures(scene))


def plugin_versions(scene: spec.Scene) -> dict[str, Any]:
    """Return the versions of the plug-ins among a scene's measures, by name."""
    return {name: scene.plugins[name].model_dump(mode="json") for name in sorted(scene.plugins)}


def _measure(kind: str, name: str, version: spec.PluginVersion) -> search.Measure:
    plugin = plugins.find((kind,), name, version.source)
    called = partial(plugin, settings=version.settings)
    return search.Measure(name, _checked(name, called))


def _checked(name: str, function: Any) -> Callable[[search.Motion], Array]:
    def of(motion: search.Motion) -> Array:
        value = _array(name, function(motion))
        if value.shape != ():
            raise plugins.Broken(f"{name} must return one number, got shape {value.shape}")
        return value.astype(motion.path.dtype)

    return of


def build_act(control: spec.PluginControl, controls: genomes.Controls) -> Any:
    """Build the function by which a plug-in encoding turns genes into movements."""
    name, version = control.encoding, control.plugin
    plugin = plugins.find(("encoding",), name, version.source)
    needed = (len(controls.joint_nodes), len(controls.edges))

    def act(genes: Array, clock: genomes.Clock) -> tuple[Array, Array]:
        outputs = plugin(genes, clock, settings=version.settings)
        if not isinstance(outputs, tuple | list) or len(outputs) != 2:
            raise plugins.Broken(f"{name} must return two arrays, for joints and for edges")
        angle, length = (_array(name, one) for one in outputs)
        shapes = tuple((len(clock.phase), count) for count in needed)
        if (angle.shape, length.shape) != shapes:
            raise plugins.Broken(
                f"{name} must return shapes {shapes[0]} for joints and {shapes[1]} for edges, "
                f"got {angle.shape} and {length.shape}"
            )
        return angle, length

    return act


def swimmer_of(gait: spec.Gait) -> swimmers.Swimmer:
    """Build a swimmer, built in or from a plug-in."""
    if gait.plugin is None:
        return swimmers.SWIMMERS[gait.swimmer]()
    plugin = plugins.find(("gait",), gait.swimmer, gait.plugin.source)
    swimmer = plugin(settings=gait.plugin.settings)
    if not isinstance(swimmer, swimmers.Swimmer):
        raise plugins.Broken(
            f"{gait.swimmer} must return a `swimmers.Swimmer`, got {type(swimmer).__name__}"
        )
    return swimmer


def strokes_of(gait: spec.Gait, time: np.ndarray) -> tuple[swimmers.Swimmer, Any, Any]:
    """Return a swimmer and the deviations of its rest angles and lengths at these times."""
    swimmer = swimmer_of(gait)
    angle, length = swimmer.gait(time)
    shapes = (len(time), len(swimmer.body.joints)), (len(time), len(swimmer.body.edges))
    if (np.shape(angle), np.shape(length)) != shapes:
        raise plugins.Broken(
            f"{gait.swimmer} must return shapes {shapes[0]} and {shapes[1]}, got "
            f"{np.shape(angle)} and {np.shape(length)}"
        )
    return swimmer, angle, length


def build_plugin_emitter(
    chosen: PluginEmitter, problem: search.emitters.Problem
) -> search.Emitter:
    """Build the emitter of a plug-in. Raise `Broken` if it differs from its declaration."""
    name, emits = chosen.operator, chosen.emits
    plugin = plugins.find(("emitter",), name, chosen.plugin.source)
    emitter = plugin(problem, settings=chosen.plugin.settings)
    if not isinstance(emitter, search.Emitter):
        raise plugins.Broken(f"{name} must return an emitter, got {type(emitter).__name__}")
    if emitter.slots != problem.slots:
        raise plugins.Broken(f"{name} must have {problem.slots} `slots`, got {emitter.slots}")
    if isinstance(emitter, search.emitters.Learner) != bool(emits.gradients):
        raise plugins.Broken(f"{name} must declare `gradients` if it learns by them, only then")
    if emits.learns == "nothing":
        state = jax.eval_shape(lambda: emitter.init(key=jax.random.key(0)))
        if state is not None or not is_dataclass(emitter):
            raise plugins.Broken(
                f"{name} must be a dataclass without a state, or declare what it `learns`"
            )
    return emitter


def _array(name: str, value: Any) -> Array:
    try:
        return jnp.asarray(value)
    except (TypeError, ValueError) as error:
        raise plugins.Broken(
            f"{name} must return numbers, got {type(value).__name__}"
        ) from error
