"""A search of your own along learned axes: saved, restored, and run in pieces."""

import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import search
from microcosmos.search import emitters

SPACE = search.Vectors(6, -3.0, 3.0)
GRID = search.Grid(tuple(search.Axis(i, -3.0, 3.0, bins=5) for i in range(2)))


def evaluated(x):
    """Fitness, and six measures of which the last four are made of two numbers."""
    plane = [x[0] + x[1], x[0] - x[1], jnp.sin(x[2]) * x[0], x[1] * x[3]]
    return 60 - jnp.sum(x**2), jnp.stack([x[0], x[1], *plane])


def rows_of(vectors):
    found = [evaluated(jnp.asarray(x)) for x in vectors]
    return np.array([f for f, _ in found]), np.array([m for _, m in found])


def new(**changes):
    container = search.learned_axes(GRID, (2, 3, 4, 5), bins=5, first=3, **changes)
    line = emitters.IsoLine(16, SPACE, iso=0.05, line=0.2, select="curiosity")
    return search.Search(SPACE, container, [line], seed=4, measures=6)


def advanced(loop, generations):
    for _ in range(generations):
        loop.tell(*rows_of(loop.ask()))
    return loop


@pytest.mark.long
def test_it_goes_on_bit_for_bit_from_a_file_before_and_after_new_axes():
    whole, files = new(), []
    for _ in range(7):
        files.append(whole.save())
        advanced(whole, 1)
    assert whole.container.epoch == 3
    for number, data in enumerate(files):
        other = new()
        other.restore(data)
        assert other.save() == data
        assert advanced(other, 7 - number).save() == whole.save()


def test_a_restored_search_forgets_what_it_had_learned():
    loop = new()
    empty = loop.save()
    advanced(loop, 4).restore(empty)
    assert loop.container.epoch == 0
    assert advanced(loop, 4).save() == advanced(new(), 4).save()


@pytest.mark.long
def test_how_many_generations_a_call_takes_does_not_matter():
    whole, parts = new(), new()
    whole.run(evaluated, 13)
    for count in (1, 1, 4, 0, 7):
        parts.run(evaluated, count)
    assert whole.generation == parts.generation == 13
    assert whole.container.epoch == 4
    assert whole.save() == parts.save()


def test_the_file_of_a_search_along_other_axes_is_refused():
    data = advanced(new(), 2).save()
    with pytest.raises(ValueError, match="`container` must be the file's"):
        new(axes=1).restore(data)


def test_elites_are_in_different_learned_cells():
    loop = advanced(new(), 8)
    found = loop.elites
    cells = np.asarray(loop.container.cell_of(jnp.asarray(found.measures)))
    assert len(set(cells.tolist())) == len(cells) > 5
    assert loop.coverage <= 1
    assert loop.qd_score > 0
