"""Tortuosity against closed forms, and in runs by JAX and by the native kernel."""

from types import SimpleNamespace

import jax
import numpy as np
import pytest

from microcosmos.measures.named.tortuosity import tortuosity


@jax.jit
def along(path):
    return tortuosity(SimpleNamespace(middle=path))


def polar(angles, radius=3.0):
    return radius * np.stack([np.cos(angles), np.sin(angles)], 1)


@pytest.mark.fast
def test_a_straight_line_has_none(float64):
    steps = np.linspace(0, 1, 50)[:, None] ** 2  # At any pace.
    assert float(along(np.array([[3.0, -4.0]]) * steps)) == pytest.approx(1, rel=1e-9)


@pytest.mark.fast
@pytest.mark.parametrize("turn", [np.pi / 2, np.pi, 1.5 * np.pi])
def test_an_arc_has_that_of_its_chord(float64, turn):
    found = float(along(polar(np.linspace(0, turn, 4001))))
    assert found == pytest.approx(turn / (2 * np.sin(turn / 2)), rel=1e-6)


@pytest.mark.fast
@pytest.mark.parametrize("angle", [0.3, 1.0, 1.4])
def test_a_zigzag_has_the_secant_of_its_angle(float64, angle):
    steps = np.arange(21.0)
    zigzag = np.stack([steps, np.tan(angle) * (steps % 2)], 1)
    assert float(along(zigzag)) == pytest.approx(1 / np.cos(angle), rel=1e-9)


@pytest.mark.fast
def test_a_closed_path_has_the_most_and_rest_the_least(float64):
    assert float(along(polar(np.linspace(0, 2 * np.pi, 100)))) == pytest.approx(1000)
    assert float(along(np.full((30, 2), 7.0))) == pytest.approx(1)


@pytest.mark.fast
def test_it_can_be_differentiated_also_at_rest(float64, require_slope):
    random = np.random.default_rng(0)
    require_slope(along, np.cumsum(random.normal(size=(20, 2)), 0))
    assert np.all(np.isfinite(jax.grad(along)(np.zeros((9, 2)))))
