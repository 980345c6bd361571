"""Build measures, encodings and swimmers of plug-ins, with checks of what they return."""

from typing import Any

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array

from .. import genomes, plugins, search, spec
from ..bodies import swimmers


def build_measures(scene: spec.Scene) -> tuple[search.Measure, ...]:
    """Build the plug-in measures of a scene, by name."""
    task, found = scene.task, dict(scene.plugins)
    kinds = dict.fromkeys(found, "descriptor")
    if task.plugin is not None:
        found[task.fitness], kinds[task.fitness] = task.plugin, "fitness"
    return tuple(_measure(kinds[name], name, found[name]) for name in sorted(found))


def measures_of(scene: spec.Scene) -> tuple[str, ...]:
    """Return the names of a scene's measures, in the order of recording."""
    return search.MEASURES + tuple(measure.name for measure in build_measures(scene))


def plugin_versions(scene: spec.Scene) -> dict[str, Any]:
    """Return the versions of the plug-ins among a scene's measures, by name."""
    return {name: scene.plugins[name].model_dump(mode="json") for name in sorted(scene.plugins)}


def _measure(kind: str, name: str, version: spec.PluginVersion) -> search.Measure:
    plugin = plugins.find((kind,), name, version.source)

    def of(motion: search.Motion) -> Array:
        found = _array(name, plugin(motion, settings=version.settings))
        if found.shape != ():
            raise plugins.Broken(f"{name} must return one number, got shape {found.shape}")
        return found.astype(motion.path.dtype)

    return search.Measure(name, of)


def build_act(control: spec.PluginControl, controls: genomes.Controls) -> Any:
    """Build the function by which a plug-in encoding turns genes into movements."""
    name, version = control.encoding, control.plugin
    plugin = plugins.find(("encoding",), name, version.source)
    needed = (len(controls.joint_nodes), len(controls.edges))

    def act(genes: Array, clock: genomes.Clock) -> tuple[Array, Array]:
        found = plugin(genes, clock, settings=version.settings)
        if not isinstance(found, tuple | list) or len(found) != 2:
            raise plugins.Broken(f"{name} must return two arrays, for joints and for edges")
        angle, length = (_array(name, one) for one in found)
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
    found = plugin(settings=gait.plugin.settings)
    if not isinstance(found, swimmers.Swimmer):
        raise plugins.Broken(
            f"{gait.swimmer} must return a `swimmers.Swimmer`, got {type(found).__name__}"
        )
    return found


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


def _array(name: str, value: Any) -> Array:
    try:
        return jnp.asarray(value)
    except (TypeError, ValueError) as error:
        raise plugins.Broken(
            f"{name} must return numbers, got {type(value).__name__}"
        ) from error
