"""A design problem: a gait that takes a swimmer along a given path.

Genes are Fourier coefficients of every joint and edge. Adam follows the gradient of the mean
squared distance between the body's middle and a point that moves along the path, through the
whole coupled simulation.
"""

import jax
import jax.numpy as jnp
import numpy as np

import microcosmos
from microcosmos import build, search, spec, world
from microcosmos.genomes import Vector
from microcosmos.search import folding

SCENE = {
    "world": {"width": 32, "height": 32, "viscosity": 0.1},
    "body": {"nodes": 12},
    "control": {"encoding": "direct", "period": 50, "angle_scale": 0.4, "length_scale": 0.2},
}


def bend(steps: int, radius: float = 4.0) -> np.ndarray:
    """(time, 2) a quarter of a circle to the left, in cells from the start."""
    turn = np.linspace(0, np.pi / 2, steps + 1)[1:]
    return radius * np.stack([np.sin(turn), 1 - np.cos(turn)], 1)


def main(steps: int = 200, updates: int = 100, rate: float = 0.03) -> list[float]:
    """The root mean square distance from the path before every update, in cells."""
    microcosmos.prepare()
    scene = spec.Scene.model_validate(SCENE | {"task": {"steps": steps}})
    task = build.build_task(scene)
    assert task.encoding is not None
    path = jnp.asarray(bend(steps), jnp.float32) + jnp.mean(task.start.positions, 0)[None]

    def middle_of(state, _):
        return jnp.mean(world.unwrapped(task.world, state), 0)

    def distance(genes):
        driven = search.drive(task, Vector(genes), differentiable=True)
        _, middle = search.simulate(driven, middle_of, segment=20)
        return jnp.sqrt(jnp.mean(jnp.sum((middle - path) ** 2, 1)))

    both = jax.jit(jax.value_and_grad(distance))
    genes = 0.1 * task.encoding.newcomer(key=jax.random.key(1)).values
    state, found = folding.begin(genes), []
    for update in range(updates):
        value, slope = both(genes)
        found.append(float(value))
        if update % 10 == 0 or update == updates - 1:
            print(f"{update:>3}: {value:.3f} cells from the path")
        change, state = folding.descend(state, slope, rate)
        genes = jnp.clip(genes + change, -1, 1)  # As genes of a creature are.
    return found


if __name__ == "__main__":
    main()
