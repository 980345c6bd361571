"""Transfers of more points than a chunk holds."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import coupling
from microcosmos.coupling import delta

SIZE = (16, 12)


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
        weights.append(coupling.peskin(jnp.asarray(away - side * np.round(away / side))))
    return np.einsum("px,py->pxy", *weights)


def test_more_points_than_a_chunk_are_worked_on_in_chunks(many):
    at = coupling.windows(many[0], SIZE)
    assert at.cells.shape[:2] == (-(-len(many[0]) // 10), 10)


def test_spreading_by_chunks_is_the_plain_sum(many):
    points, values = many
    found = jax.jit(lambda x, q: coupling.spread(q, coupling.windows(x, SIZE), SIZE))(
        points, values
    )
    expected = np.einsum("pxy,pc->cxy", written_out(points), values)
    np.testing.assert_allclose(found, expected, atol=1e-13)


def test_interpolation_by_chunks_is_the_plain_sum(many, field):
    points, _ = many
    found = coupling.interpolate(field, coupling.windows(points, SIZE))
    expected = np.einsum("pxy,cxy->pc", written_out(points), field)
    np.testing.assert_allclose(found, expected, rtol=1e-12)


def test_windows_by_chunks_can_be_divided_by_a_plane(many, field):
    points, _ = many
    at = coupling.divided(coupling.windows(points, SIZE), field[1])
    expected = np.einsum("pxy,xy->p", written_out(points), field[0] / field[1])
    np.testing.assert_allclose(coupling.interpolate(field[:1], at)[:, 0], expected, rtol=1e-12)


def test_transfers_by_chunks_are_transposes(many, field):
    points, values = many
    at = coupling.windows(points, SIZE)
    there = jnp.sum(coupling.spread(values[:, :2], at, SIZE) * field)
    back = jnp.sum(coupling.interpolate(field, at) * values[:, :2])
    np.testing.assert_allclose(there, back, rtol=1e-12)


def test_transfers_by_chunks_have_the_gradient_of_the_plain_ones(field, monkeypatch):
    random = np.random.default_rng(0)
    given = (
        jnp.asarray(random.uniform(-20, 20, (29, 2))),
        jnp.asarray(random.normal(size=(29, 1))),
    )

    def slope(chunk):
        monkeypatch.setattr(delta, "CHUNK", chunk)

        @jax.jit
        def total(points, values):
            at = coupling.windows(points, SIZE)
            read = coupling.interpolate(field[:1], at)
            return jnp.sum(coupling.spread(values, at, SIZE) ** 2) + jnp.sum(read**2)

        return jax.grad(total, (0, 1))(*given)

    for by_chunks, plain in zip(slope(10), slope(100), strict=True):
        np.testing.assert_allclose(by_chunks, plain, atol=1e-12)


@pytest.mark.parametrize("kernel", [coupling.PESKIN, coupling.HAT])
def test_what_spreading_needs_besides_its_arguments_does_not_grow(kernel):
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
