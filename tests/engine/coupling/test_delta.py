"""Regularised deltas, and the transfer between nodes and cells."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import coupling
from microcosmos.coupling import delta

SIZE = (16, 12)
peskin = jax.jit(coupling.peskin)


@pytest.fixture
def samples(float64):
    """Distances of the four nearest cells from nodes anywhere between two cells."""
    shift = np.linspace(0, 1, 101)[:, None]
    return jnp.asarray(shift + np.array([-2.0, -1.0, 0.0, 1.0]))


def interpolate(plane, at):
    return coupling.interpolate(plane[None], at)[:, 0]


def test_peskins_delta_has_half_on_even_and_odd_cells_and_squares_of_three_eighths(samples):
    delta = np.asarray(peskin(samples))
    np.testing.assert_allclose(delta[:, 0] + delta[:, 2], 0.5, rtol=1e-14)
    np.testing.assert_allclose(np.sum(delta**2, 1), 3 / 8, rtol=1e-14)


def test_interpolation_can_be_differentiated_by_position(require_slope, float64):
    positions = jnp.asarray(np.random.default_rng(0).uniform(0, 12, (5, 2)))
    field = jnp.asarray(np.random.default_rng(1).normal(size=SIZE))

    def total(positions):
        return jnp.sum(interpolate(field, coupling.windows(positions, SIZE)) ** 2)

    require_slope(total, positions, h=1e-5, rtol=1e-7)


KERNELS = pytest.mark.parametrize(
    "kernel", [coupling.ROMA, coupling.HAT, coupling.PESKIN], ids=lambda k: k.weight.__name__
)


def around(points):
    """Distances of the nearest cells, and one more to each side, from anywhere in a cell."""
    return np.linspace(-0.5, 0.5, 101)[:, None] + np.arange(-points, points + 1.0)


@KERNELS
def test_weights_sum_to_one_and_have_no_first_moment(kernel, float64):
    r = around(kernel.points)
    weights = np.asarray(jax.jit(kernel.weight)(r))
    np.testing.assert_allclose(np.sum(weights, 1), 1, rtol=1e-14)
    np.testing.assert_allclose(np.sum(r * weights, 1), 0, atol=1e-14)


def test_the_sum_of_squares_of_the_three_point_delta_is_a_half(float64):
    # The condition from which Roma, Peskin and Berger (1999) have it.
    np.testing.assert_allclose(
        np.sum(np.square(jax.jit(coupling.roma)(around(3))), 1), 0.5, rtol=1e-13
    )


@KERNELS
def test_a_delta_is_even_and_ends_where_its_points_do(kernel, float64):
    r, weight = np.linspace(0, 3, 61), jax.jit(kernel.weight)
    weights = np.asarray(weight(r))
    np.testing.assert_array_equal(weight(-r), weights)
    ends = r >= kernel.points / 2
    assert np.all(weights[ends] == 0)
    assert np.all(weights[~ends] > 0)


@KERNELS
def test_both_derivatives_are_finite_at_every_seam(kernel, dtype):
    ends = [1e-30, 1.5 - 1e-6, 2 - 1e-6]
    r = jnp.asarray([-3, -2, -1.5, -1, -0.5, 0, 0.5, 1, 1.5, 2, 3, *ends], dtype)
    slope = jax.grad(kernel.weight)
    assert np.all(np.isfinite(jax.jit(jax.vmap(slope))(r)))
    assert np.all(np.isfinite(jax.jit(jax.vmap(jax.grad(slope)))(r)))


@KERNELS
def test_gradients_agree_with_finite_differences_between_seams(kernel, float64):
    r = [-1.9, -1.2, -0.7, -0.3, -0.1, 0.05, 0.45, 0.55, 0.95, 1.05, 1.45, 1.55, 1.95, 2.5]
    r, h, weight = np.array(r), 1e-6, jax.jit(kernel.weight)
    slope = jax.jit(jax.vmap(jax.grad(kernel.weight)))(r)
    difference = (np.asarray(weight(r + h)) - weight(r - h)) / (2 * h)
    np.testing.assert_allclose(slope, difference, atol=1e-8)


@KERNELS
def test_windows_hold_every_cell_of_the_support(kernel, float64):
    size = (16, 12)
    points = np.random.default_rng(0).uniform(-20, 20, (30, 2))
    points = np.concatenate([points, [[3.0, 4.0], [3.5, 4.5]]])

    @jax.jit
    def covered(points):
        at = coupling.windows(points, size, kernel)
        return coupling.spread(jnp.eye(len(points)), at, size)

    found, weight = np.asarray(covered(points)), jax.jit(kernel.weight)
    for axis, side in enumerate(size):
        away = np.arange(side)[None] - points[:, axis, None]
        away = away - side * np.round(away / side)
        np.testing.assert_allclose(np.sum(found, 2 - axis), weight(away), atol=1e-13)


@pytest.fixture
def many(float64, monkeypatch):
    """Points in two chunks of ten and a third not quite full, with values."""
    monkeypatch.setattr(delta, "CHUNK", 10)
    random = np.random.default_rng(0)
    points = random.uniform(-20, 20, (29, 2))
    return jnp.asarray(points), jnp.asarray(random.normal(size=(29, 3)))


@pytest.fixture
def field(float64):
    return jnp.asarray(np.random.default_rng(9).uniform(1, 2, (2, *SIZE)))


def written_out(points):
    """Weights of all cells for each point, (point, x, y)."""
    weights = []
    for axis, side in enumerate(SIZE):
        away = np.arange(side)[None] - np.asarray(points)[:, axis, None]
        weights.append(peskin(away - side * np.round(away / side)))
    return np.einsum("px,py->pxy", *weights)


def test_transfers_by_chunks_are_plain_sums_and_transposes(many, field):
    points, values = many
    at, weights = coupling.windows(points, SIZE), written_out(points)
    assert at.cells.shape[:2] == (-(-len(points) // 10), 10)
    found = jax.jit(lambda q, at: coupling.spread(q, at, SIZE))(values, at)
    expected = np.einsum("pxy,pc->cxy", weights, values)
    np.testing.assert_allclose(found, expected, atol=1e-13)
    expected = np.einsum("pxy,cxy->pc", weights, field)
    np.testing.assert_allclose(coupling.interpolate(field, at), expected, rtol=1e-12)
    divided = coupling.interpolate(field[:1], coupling.divided(at, field[1]))[:, 0]
    expected = np.einsum("pxy,xy->p", weights, field[0] / field[1])
    np.testing.assert_allclose(divided, expected, rtol=1e-12)
    there = jnp.sum(coupling.spread(values[:, :2], at, SIZE) * field)
    back = jnp.sum(coupling.interpolate(field, at) * values[:, :2])
    np.testing.assert_allclose(there, back, rtol=1e-12)


def test_transfers_by_chunks_have_the_gradient_of_the_plain_ones(field, monkeypatch):
    random = np.random.default_rng(0)
    points, values = random.uniform(-20, 20, (29, 2)), random.normal(size=(29, 1))
    given = (jnp.asarray(points), jnp.asarray(values))

    def slope(chunk):
        monkeypatch.setattr(delta, "CHUNK", chunk)

        @jax.jit
        def total(points, values):
            at = coupling.windows(points, SIZE)
            read = coupling.interpolate(field[:1], at)
            return jnp.sum(coupling.spread(values, at, SIZE) ** 2) + jnp.sum(read**2)

        return jax.jit(jax.grad(total, (0, 1)))(*given)

    for by_chunks, plain in zip(slope(10), slope(100), strict=True):
        np.testing.assert_allclose(by_chunks, plain, atol=1e-12)


@pytest.mark.parametrize("kernel", [coupling.PESKIN, coupling.HAT])
def test_the_temporary_memory_of_spreading_is_bounded(kernel):
    size = (64, 64)

    def needed(points):
        shapes = jax.ShapeDtypeStruct((points, 2), jnp.float32)
        at = jax.eval_shape(lambda x: coupling.windows(x, size, kernel), shapes)
        program = jax.jit(lambda values, at: coupling.spread(values, at, size))
        return program.lower(shapes, at).compile().memory_analysis().temp_size_in_bytes

    # A chunk's amounts in two channels, its windows and its values, and the planes.
    cells = kernel.points**2
    most = 4 * (delta.CHUNK * (2 * cells + 2 * cells + 4) + 4 * size[0] * size[1])
    assert needed(4 * delta.CHUNK) <= most
    assert needed(8 * delta.CHUNK) <= most
