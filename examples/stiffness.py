"""An inverse problem: the bending stiffness of a filament, from how it straightens in a fluid.

Somebody has filmed a bent filament while it straightened. How stiff is it? The loss is the mean
squared distance of the nodes from where they were seen; a secant method finds where its
derivative, through the whole coupled simulation, is zero.
"""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np

import microcosmos
from microcosmos import bodies, build, filaments, spec, world

TRUE, FIRST = 0.3, 0.6
SCENE = spec.World(width=32, height=32, viscosity=0.2)
FORM = spec.Coupling(constraint_iterations=2, limits=False)


def main(nodes: int = 16, steps: int = 60, iterations: int = 12) -> float:
    """The recovered stiffness; each guess is printed."""
    microcosmos.prepare()
    body = bodies.arc(nodes, 1.0, 0.3, bend=TRUE)  # A soft body is swept.
    box = build.build_world(SCENE, FORM, body)
    places = body.positions - body.positions.mean(0) + 16
    start = world.at_rest(box, jnp.asarray(places, jnp.float32))
    straight = filaments.Rest(
        jnp.zeros((steps, len(body.joints))),
        jnp.tile(jnp.asarray(body.rest_length, jnp.float32), (steps, 1)),
    )

    def film(stiffness):
        rods = replace(box.rods, bend=jnp.full(len(body.joints), stiffness))
        stiff = replace(box, rods=rods)
        return world.rollout(
            stiff, start, straight, lambda state, _: world.unwrapped(stiff, state)
        )[1]

    seen = jax.jit(film)(TRUE)

    def loss(logarithm):
        return jnp.mean(jnp.sum((film(jnp.exp(logarithm)) - seen) ** 2, -1))

    both = jax.jit(jax.value_and_grad(loss))
    # Near the minimum the derivative is a straight line, whose zero two points give.
    before, now = np.log(FIRST), np.log(FIRST) - 0.2
    slope_before = float(both(jnp.float32(before))[1])
    for iteration in range(iterations):
        value, slope = (float(found) for found in both(jnp.float32(now)))
        print(f"{iteration:>2}: stiffness {np.exp(now):.5f}, loss {value:.3g}")
        bent = slope - slope_before
        step = -slope * (now - before) / bent if bent else 0.0
        if abs(step) < 1e-4:
            break
        before, slope_before = now, slope
        now = min(0.0, now + float(np.clip(step, -0.5, 0.5)))  # Stiffness is at most 1.
    found = float(np.exp(now))
    print(f"found {found:.5f}, was {TRUE}: off by {abs(found / TRUE - 1):.3%}")
    return found


if __name__ == "__main__":
    main()
