"""Creature files that bring their ancestors."""

import pytest

from microcosmos.archive import creature, pedigree
from microcosmos.spec import EXPERIMENTS

pytestmark = pytest.mark.fast


def one(number, *parents):
    """A gait of so many steps, with parents."""
    sweep = next(p.spec for p in EXPERIMENTS["gaits"].presets)
    scene = sweep.scene("ours", "worm", 0.5)
    written = scene.model_dump(mode="json")
    control = written["control"] | {"period": number}
    whole = {
        "format": creature.FORMAT,
        "genome": {"encoding": "gait", **control},
        "world": {**written["world"], "coupling": written["coupling"]},
        "body": written["body"],
        "task": written["task"],
    }
    names = [parent["sha256"] for parent in parents]
    origin = {"operator": "hand-made", "generation": 0, "seed": 0, "version": "0"}
    return creature.parse(creature.document(whole, None, {"parents": names, **origin}))


def test_a_family_is_taken_apart_as_it_was_put_together():
    oldest = one(40) | {"credit": ["Ada"], "licence": "CC0-1.0"}
    parent = one(60, oldest)
    young = one(80, parent, oldest)
    assert pedigree.split(pedigree.document(young, [parent, oldest])) == (
        young,
        [parent, oldest],
    )
    assert pedigree.split(young) == (young, [])


def test_nobody_comes_along_who_is_no_ancestor():
    oldest, stranger = one(40), one(100)
    young = one(80, oldest)
    with pytest.raises(creature.CreatureError, match=r"`ancestors.1` needs an ancestor"):
        pedigree.split(pedigree.document(young, [oldest, stranger]))
    grown = one(80, one(60, oldest))
    with pytest.raises(creature.CreatureError, match=r"`ancestors.0` needs an ancestor"):
        pedigree.split(pedigree.document(grown, [oldest]))


def test_names_of_credit_are_words():
    file = one(40)
    assert creature.parse(file | {"credit": [" Ada "]})["credit"] == ["Ada"]
    for wrong in ([""], ["x" * 201], ["x"] * 51, "Ada", [1]):
        with pytest.raises(creature.CreatureError, match="`credit"):
            creature.parse(file | {"credit": wrong})
