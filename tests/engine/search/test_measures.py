"""Measures against closed forms, and against plain NumPy on a simulated creature."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import bodies, filaments, search, world
from microcosmos.search import measures as recorded

advance, curvature = jax.jit(recorded.advance), jax.jit(recorded.curvature)
efficiency, symmetry = jax.jit(recorded.efficiency), jax.jit(recorded.symmetry)
swimming_of = jax.jit(recorded.swimming)
STEPS = 40


@pytest.mark.fast
@pytest.mark.parametrize(("sign", "expected"), [(1, 1.0), (-1, -1.0)])
def test_both_halves_bend_alike_or_oppositely(float64, sign, expected):
    random = np.random.default_rng(0)
    half = random.normal(size=(30, 4))
    bent = np.concatenate([half, sign * half[:, ::-1]], 1) + random.normal(size=(1, 8))
    assert symmetry(bent) == pytest.approx(expected)


@pytest.mark.fast
def test_a_wave_along_the_body_is_not_symmetric(float64):
    t, joint = np.arange(60)[:, None], np.arange(20)[None]
    wave = np.sin(2 * np.pi * (t / 30 - joint / 10))
    assert abs(symmetry(wave)) < 0.1
    assert symmetry(np.zeros((5, 3))) == 0


@pytest.mark.fast
def test_absent_joints_do_not_count(float64):
    random = np.random.default_rng(1)
    bent = random.normal(size=(30, 5))
    wide = np.concatenate([bent, np.zeros((30, 3))], 1)
    kept = np.arange(8) < 5
    found = symmetry(wide, kept)
    np.testing.assert_allclose(found, symmetry(bent))
    size = np.abs(bent)
    for given in ((wide, kept), (bent,)):
        average, spread = curvature(*given)
        np.testing.assert_allclose(average, size.mean())
        np.testing.assert_allclose(spread, size.std())


@pytest.mark.fast
def test_no_power_is_no_efficiency(float64):
    values = [np.asarray(x) for x in (0.01, 0.002, 0.1)]
    assert efficiency(*values) == pytest.approx(0.1 * 0.01**2 / 0.002)
    assert efficiency(values[0], np.asarray(-1.0), values[2]) == 0
    assert np.isnan(efficiency(values[0], np.asarray(np.nan), values[2]))


def swum(strokes, velocity=0.01, jump=0.0):
    """Speed and stride of a body of 20 cells that moves evenly after its first stroke."""
    steps = np.arange(1, len(strokes) + 1)
    path = np.stack([0.6 * velocity * steps + jump * (strokes < 1), -0.8 * velocity * steps], 1)
    return [float(x) for x in swimming_of(path, strokes, 20.0)]


@pytest.mark.fast
def test_speed_and_stride_of_an_even_motion(float64):
    steps = np.arange(1.0, 1001)
    assert swum(steps / 100) == pytest.approx([1000 * 0.01 / 20, 100 * 0.01 / 20])
    assert swum(steps / 200) == pytest.approx([0.5, 0.1])  # Fewer strokes, the same speed.
    assert swum(steps / 300) == pytest.approx([0.5, 0.15])  # A part of a stroke is left out.
    assert swum(steps / 100, jump=5.0) == pytest.approx([0.5, 0.05], rel=1e-3)
    assert swum(steps / 501) == [0.0, 0.0]
    assert swum(np.zeros(1000)) == [0.0, 0.0]


@pytest.mark.fast
def test_advance_is_the_speed_along_x_with_its_sign(float64):
    steps = np.arange(1.0, 1001)
    path = np.stack([-0.006 * steps, 0.008 * steps], 1)
    assert float(advance(path, steps / 300, 20.0)) == pytest.approx(-0.3)
    assert float(advance(path, steps / 501, 20.0)) == 0


@pytest.mark.fast
def test_speed_can_be_differentiated(float64, require_slope):
    random = np.random.default_rng(0)
    path = np.cumsum(random.normal(size=(40, 2)), 0)
    strokes = np.cumsum(random.uniform(0.05, 0.1, 40))
    require_slope(lambda given: sum(swimming_of(*given, 5.0)), (path, strokes))


@pytest.fixture
def swimming(immerse, float64):
    """The start, states and measures of a gait, and the measures of its motion."""
    body = bodies.chain(8, 1.0)
    box, start = immerse(body, float64, viscosity=0.1, size=(24, 24), layers=2)
    t, joint = np.arange(STEPS)[:, None], np.arange(6)[None]
    angle = 0.3 * np.sin(2 * np.pi * t / 20 - 0.9 * joint)
    rest = filaments.Rest(jnp.asarray(angle), jnp.ones((STEPS, 7)))

    def record(state, measures):
        return search.observe(state, measures), state, measures

    @jax.jit
    def run():
        end, (observed, states, measures) = world.rollout(box, start, rest, record)
        path = world.route(box, start, observed)
        return states, measures, search.motion(box, start, end, observed, path, 7.0)

    return start, *run()


def test_measures_are_what_numpy_makes_of_the_states(swimming):
    start, states, measures, values = swimming
    positions, angles = np.asarray(states.positions), np.asarray(states.angles)
    centres = np.concatenate([[start.positions.mean(0)], positions.mean(1)])
    path = np.hypot(*np.diff(centres, axis=0).T).sum()
    heading = np.concatenate([[start.angles.mean()], angles.mean(1)])
    lengths = np.linalg.norm(np.diff(positions, axis=1), axis=2)
    turn = np.diff(angles, axis=1)
    bent = (turn + np.pi) % (2 * np.pi) - np.pi
    bent = bent / (0.5 * (lengths[:, 1:] + lengths[:, :-1]))
    size = np.abs(bent)
    change = bent - bent.mean(0)
    moved = np.hypot(*(centres[-1] - centres[0]))
    power = float(np.mean(measures.power))
    expected = {
        "displacement": moved,
        "path_length": path,
        "mean_speed": path / STEPS,
        "turning": np.abs(np.diff(heading)).sum(),
        "curvature_mean": size.mean(),
        "curvature_spread": size.std(),
        "symmetry": (change * change[:, ::-1]).sum() / (change**2).sum(),
        "efficiency": 0.1 * (moved / STEPS) ** 2 / power,
        "nodes": 8,
        "impulse": np.hypot(*np.cumsum(np.asarray(measures.force)[:, 0], 0).T).max(),
    }
    for name, value in expected.items():
        np.testing.assert_allclose(values[name], value, rtol=1e-9, atol=2e-12, err_msg=name)
    assert values["power"] == pytest.approx(power)
    assert values["power"] > 0
