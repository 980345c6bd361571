"""Plug-ins of every kind that takes part in an evaluation."""

import jax.numpy as jnp
import numpy as np

from microcosmos import bodies, plugins
from microcosmos.bodies import swimmers


@plugins.fitness("way", title="Straight way", unit="cells")
def way(motion):
    return motion.measures["displacement"] * motion.measures["straightness"]


@plugins.body("stick", title="A stick", nodes=8)
def stick():
    return bodies.chain(8, 1.0)


@plugins.gait("wriggler", title="A wriggler", nodes=8)
def wriggler():
    body = bodies.chain(8, 1.0)

    def gait(time):
        wave = np.sin(2 * np.pi * (np.linspace(0, 1, 6)[None] - time[:, None]))
        return 0.3 * wave, np.zeros((len(time), 7))

    return swimmers.Swimmer("wriggler", body, gait)


@plugins.encoding("pulse", title="A pulse", genes=2, per_joint=1)
def pulse(genes, clock):
    wave = jnp.sin(clock.phase[:, None] + 3 * genes[0] * clock.joints[None])
    return wave * genes[None, 2:], 0.1 * jnp.cos(clock.phase)[:, None] * clock.edges[None]
