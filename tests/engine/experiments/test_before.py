"""Files that an earlier version wrote: they are read, gone on from and imported.

In `before/` are those of commit ee159a5, which knew no `search.origin`, `own` and `credit`: a
search after its first generation of three, the fittest creature of its end as both kinds of
creature file, and a refinement of that creature after the first of its three rows.
"""

import json
from pathlib import Path

import numpy as np
import pytest

from microcosmos.archive import creature, creature_h5, file
from microcosmos.build import build
from microcosmos.spec import Refinement, parse
from microcosmos.viz.figures.reading import read

BEFORE = Path(__file__).with_name("before")
WRITTEN = {name: (BEFORE / f"{name}.h5").read_bytes() for name in ("search", "refinement")}


@pytest.fixture(scope="module")
def search():
    return build(parse(json.loads(file.load(WRITTEN["search"])[1]["spec"])))


@pytest.fixture(scope="module")
def refinement():
    """As `microcosmos refine` is given it: today's reading of the creature's file."""
    found = creature.parse((BEFORE / "creature.json").read_bytes())
    return build(Refinement(creature=found, steps=2, block=2))


@pytest.fixture(params=["search", "refinement"])
def taken_up(request):
    """An experiment, its file, and the state that is taken up from it."""
    experiment, data = request.getfixturevalue(request.param), WRITTEN[request.param]
    return experiment, data, experiment.restore(data, other_device=True)


def test_nothing_of_it_is_lost_or_changed(taken_up):
    experiment, data, state = taken_up
    held, kept = file.load(data)[0], file.load(experiment.save(state))[0]
    assert json.dumps(_bits(held)) == json.dumps(_bits(kept))


def test_it_goes_on_as_what_is_written_today_does(taken_up, finish):
    experiment, _, state = taken_up
    again = experiment.restore(experiment.save(state), other_device=True)
    whole = finish(experiment, state)
    assert finish(experiment, again) == whole


def test_its_archive_is_drawn(search):
    found = read(WRITTEN["search"])
    assert len(found.cells) == len(found.fitness) == len(found.lineage["cell"])
    assert found.document == json.loads(search.plan.spec)


def test_its_creatures_keep_their_names_and_can_begin_a_search(small):
    written = json.loads((BEFORE / "creature.json").read_bytes())
    found = creature.parse(written)
    assert found == creature_h5.load((BEFORE / "creature.h5").read_bytes())
    assert found == written | {"credit": []}
    forked = build(small(search={"origin": [found["sha256"]]}), [found])
    report = forked.advance(forked.init())[1]
    assert found["sha256"] in {parent for elite in report.elites for parent in elite.parents}


def _bits(tree):
    """Every array by its type, shape and bytes."""
    if isinstance(tree, dict):
        return {name: _bits(tree[name]) for name in sorted(tree)}
    array = np.asarray(tree)
    return [str(array.dtype), array.shape, array.tobytes().hex()]
