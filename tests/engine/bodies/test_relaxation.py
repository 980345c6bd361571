"""The slowest bend of a body is that of the projection, and of closed forms."""

from math import cos, log, pi

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import bodies, filaments
from microcosmos.build import build_rods
from microcosmos.filaments import projection
from microcosmos.quantities import bodies as module
from microcosmos.quantities.bodies import relaxation


def of_a_chain(joints, bend):
    """Sweeps to 1/e of a chain of equal joints: over-relaxation, Young, Trans. Am. Math. Soc.
    76, 92 (1954). With k the stiffness and c = cos(π/(J + 1)), a sweep leaves the share
    g = ((s + √(s² + 4 (1 − k))) / 2)² of the slowest mode, where s = k c."""
    s = bend * cos(pi / (joints + 1))
    root = (s + (s * s + 4 * (1 - bend)) ** 0.5) / 2
    return -1 / (2 * log(root))


def uniform(body, bend):
    return relaxation(body, np.full(len(body.joints), bend))


@pytest.mark.fast
@pytest.mark.parametrize("bend", [1.0, 0.5, 0.05])
@pytest.mark.parametrize("joints", [2, 11, 30])
def test_a_chain_of_equal_joints_relaxes_as_youngs_formula_says(joints, bend):
    body = bodies.chain(joints + 2, 1.0)
    assert uniform(body, bend) == pytest.approx(of_a_chain(joints, bend), rel=1e-6)


@pytest.mark.fast
def test_a_long_soft_chain_relaxes_by_diffusion_also_where_few_modes_are_computed():
    # A sweep with small k is a step of C' = k/2 C'': the mode decays by k/2 (π/(J + 1))².
    joints, bend = 1000, 1e-3
    assert joints > module.DENSE
    diffusive = 2 / (bend * (np.pi / (joints + 1)) ** 2)
    assert uniform(bodies.chain(joints + 2, 1.0), bend) == pytest.approx(diffusive, rel=2e-3)


BODIES = {
    "uneven chain": bodies.chain(14, 1.0),
    "star": bodies.star(4, 5, 1.0),
    "ring": bodies.ring(12, 1.0),
}


@pytest.mark.parametrize("name", BODIES)
@pytest.mark.parametrize("dense", [True, False])
def test_a_body_of_uneven_stiffness_relaxes_as_the_projection_does(
    name, dense, float64, monkeypatch
):
    monkeypatch.setattr(module, "DENSE", 200 if dense else 0)
    body = BODIES[name]
    drawn = np.random.default_rng(3)
    bend = drawn.uniform(0.05, 0.9, len(body.joints))
    expected = relaxation(body, bend)
    rods = build_rods(body, float64)
    rods = filaments.Rods(**{**vars(rods), "bend": jnp.asarray(bend)})
    rest = filaments.Rest(jnp.asarray(body.rest_angle), jnp.asarray(body.rest_length))
    direction = body.positions[body.edges[:, 1]] - body.positions[body.edges[:, 0]]
    straight = np.arctan2(direction[:, 1], direction[:, 0])
    angles = jnp.asarray(straight + 0.05 * drawn.standard_normal(len(body.edges)))

    @jax.jit
    def swept(sweeps):
        return jax.lax.fori_loop(
            0, sweeps, lambda _, turned: projection.bend(turned, rods, rest), angles
        )

    def error(sweeps):
        found = swept(sweeps) - straight
        return float(jnp.max(jnp.abs(found - jnp.mean(found))))

    settled, ahead = int(8 * expected) + 2, max(2, round(expected))
    decay = error(settled + ahead) / error(settled)
    assert -ahead / np.log(decay) == pytest.approx(expected, rel=2e-3)
