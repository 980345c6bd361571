"""A design problem: the rest shape with which a gait comes farthest, at a given viscosity.

The gait stays the worm's; what is designed is how the body is bent at rest. Each step goes
along the gradient, by the rest angles of all joints and through the whole simulation, of the
way in the second half of it: by then the body, straight at first, has taken its shape.
"""

import jax
import jax.numpy as jnp

import microcosmos
from microcosmos import build, search, spec, world
from microcosmos.build import build_stroke

SCENE = {
    "world": {"width": 48, "height": 48},
    "body": {"builder": "worm"},
    "control": {"swimmer": "worm", "period": 100},
}


def main(
    viscosities: tuple[float, ...] = (0.05, 0.5), steps: int = 400, updates: int = 20
) -> dict[float, tuple[float, float]]:
    """The way in cells before and after, for each viscosity."""
    microcosmos.prepare()
    found = {}
    for viscosity in viscosities:
        place = SCENE["world"] | {"viscosity": viscosity}
        scene = spec.Scene.model_validate(SCENE | {"world": place, "task": {"steps": steps}})
        found[viscosity] = design(scene, updates)
        before, after = found[viscosity]
        print(f"viscosity {viscosity:g}: {before:.3f} cells straight, {after:.3f} bent")
    return found


def design(scene: spec.Scene, updates: int, step: float = 0.1) -> tuple[float, float]:
    """Gradient ascent with steps of a given length, halved where one leads down."""
    assert isinstance(scene.control, spec.Gait)
    task, stroke = build.build_task(scene), build_stroke(scene.control, scene.task.steps)

    def middle_of(state, _):
        return jnp.mean(world.unwrapped(task.world, state), 0)

    def way(values):
        driven = search.gradients.changed(task, stroke, values)
        _, middle = search.simulate(driven, middle_of, segment=20)
        moved = middle[-1] - middle[len(middle) // 2 - 1]
        return jnp.sqrt(jnp.sum(moved * moved) + 1e-12)

    both = jax.jit(jax.value_and_grad(way))
    values = search.gradients.parts(task, stroke, ("rest_angle",))
    length, slope = both(values)
    first = float(length)
    for _ in range(updates):
        up = slope["rest_angle"]
        change = step * up / jnp.sqrt(jnp.sum(up * up) + 1e-30)
        trial = {"rest_angle": values["rest_angle"] + change}
        further, steeper = both(trial)
        if further > length:
            values, length, slope = trial, further, steeper
        else:
            step /= 2
    return first, float(length)


if __name__ == "__main__":
    main()
