"""The tree of an archive holds every elite's descent and the whole ancestry of one."""

import numpy as np
import pytest

from microcosmos.viz.figures import caption, style
from microcosmos.viz.figures.lineage import family, heights, lineage

pytestmark = pytest.mark.long

PARENTS = [(), (), (0,), (0, 1), (2,), (3, 2), (1,)]
"""Of seven entries; the first two are newcomers, the fourth and the sixth have two parents."""

GENERATIONS = [1, 1, 2, 3, 4, 5, 5]
CELLS = [0, 1, 2, 3, 0, 4, 1]
"""Entries 4 and 6 replaced 0 and 1."""


def name(entry):
    return np.full(32, entry + 1, np.uint8)


@pytest.fixture
def archive(made):
    parents = np.zeros((7, 2, 32), np.uint8)
    for entry, own in enumerate(PARENTS):
        for k, parent in enumerate(own):
            parents[entry, k] = name(parent)
    columns = {
        "creature": np.stack([name(entry) for entry in range(7)]),
        "parents": parents,
        "generation": np.array(GENERATIONS),
        "cell": np.array(CELLS),
        "fitness": np.arange(7.0),
    }
    elites = [
        {"cell": cell, "fitness": float(e)}
        for cell, e in zip(range(5), (4, 6, 2, 3, 5), strict=True)
    ]
    return made(elites, best=range(1, 6), lineage=columns)


def test_elites_are_the_latest_entries_of_their_cells(archive):
    assert family(archive).tips.tolist() == [4, 6, 2, 3, 5]


def test_ancestors_are_those_of_both_parents(archive):
    found = family(archive)
    assert found.ancestors(5) == [5, 3, 2, 1, 0]
    assert found.ancestors(4) == [4, 2, 0]
    assert found.closure([5], both=False) == [5, 3, 0]


def test_no_two_entries_of_a_generation_stand_at_one_height(archive):
    found = family(archive)
    places = heights(found, list(range(7)))
    assert sorted(places) == list(range(7))
    ends = [places[entry] for entry in (4, 5, 6)]
    assert sorted(ends) == [0, 1, 2]
    assert places[0] == (places[2] + places[3]) / 2


def test_the_chosen_elite_and_all_its_ancestors_are_drawn_in_colour(archive):
    with style.styled():
        panel = lineage(archive, cell=4).axes[0]
    chosen, ring = panel.collections[-2:]
    generations = sorted(int(x) for x, _ in chosen.get_offsets())
    assert generations == [1, 1, 2, 3, 5]
    assert ring.get_offsets()[0][0] == 5
    dashed = [line for line in panel.get_lines() if line.get_linestyle() == "--"]
    assert len(dashed) == 2


def test_an_empty_cell_is_refused_with_those_that_are_not(archive):
    with pytest.raises(ValueError, match="`cell` must be one of the 5 that have an elite"):
        lineage(archive, cell=17)


def test_the_caption_counts_ancestors_and_names_the_elite(archive):
    told = caption.of_lineage(archive, 4, 4)
    assert told.startswith(
        "Descent of 5 elites (grey) and the 4 ancestors of the elite of cell 4"
    )
    assert "Dashed lines lead from second parents." in told
