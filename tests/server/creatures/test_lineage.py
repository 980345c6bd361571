"""Ancestors and children of creatures, and creatures as HDF5."""

from io import BytesIO
from typing import Any

import h5py
import pytest

from microcosmos.archive import creature, creature_h5


@pytest.fixture
def upload_child(upload, identity):
    """Uploads a creature with parents, given by number or name, and returns its name."""

    def name(parent: int | str) -> str:
        return parent if isinstance(parent, str) else creature.name(identity(parent))

    def make(number: int, *parents: int | str, operator: str = "mutation") -> str:
        origin = {
            "parents": [name(parent) for parent in parents],
            "operator": operator,
            "generation": number,
            "seed": 0,
            "version": "1",
        }
        return upload(identity(number), None, origin)

    return make


def names(found):
    return [item["creature"] for item in found["items"]]


def test_ancestors_are_listed_once_nearest_first(api, upload_child):
    # 1 is a parent of 4 and of its other parent 3.
    old, one = upload_child(10), upload_child(1, 10)
    three, four = upload_child(3, 1, 1), upload_child(4, 1, 3)
    found = api.get(f"creatures/{four}/ancestors").json()
    assert names(found) == [one, three, old]
    assert [item["distance"] for item in found["items"]] == [1, 1, 2]
    assert [item["generation"] for item in found["items"]] == [1, 3, 10]
    assert (found["parents"], found["more"]) == ([one, three], False)


def test_limited_ancestors_say_whether_more_exist(api, upload_child):
    one, two, three = upload_child(1), upload_child(2, 1), upload_child(3, 2)
    near = api.get(f"creatures/{three}/ancestors", params={"depth": 1}).json()
    assert (names(near), near["more"]) == ([two], True)
    all_of_them = api.get(f"creatures/{three}/ancestors", params={"depth": 2}).json()
    assert (names(all_of_them), all_of_them["more"]) == ([two, one], False)
    assert api.get(f"creatures/{three}/ancestors", params={"depth": 0}).status_code == 422


def digests(begin, count):
    return [f"{begin + i:064x}" for i in range(count)]


def test_the_order_of_parents_decides_which_ancestors_are_listed(api, upload_child):
    older = {1: digests(0, 150), 2: digests(1000, 150)}
    one, two = upload_child(1, *older[1]), upload_child(2, *older[2])
    for child, first, second, parents in ((3, 1, 2, [one, two]), (4, 2, 1, [two, one])):
        name = upload_child(child, first, second)
        found = api.get(f"creatures/{name}/ancestors", params={"depth": 2}).json()
        assert names(found) == parents + older[first] + older[second][:48]
        assert found["more"]


def test_a_missing_parent_is_listed_by_hash(api, upload_child, identity, enter):
    child = upload_child(2, 1)
    (only,) = api.get(f"creatures/{child}/ancestors").json()["items"]
    assert only["creature"] == creature.name(identity(1))
    assert (only["stored"], only["fitness"], only["operator"]) == (False, None, None)
    parent = "ab" * 32
    elite = enter(1, 1.25, parent)
    (only,) = api.get(f"creatures/{elite}/ancestors").json()["items"]
    assert (only["creature"], only["stored"]) == (parent, False)


def test_children_are_counted_and_named_once_each(api, upload_child):
    parent = upload_child(1)
    two, three = upload_child(2, 1, 1), upload_child(3, 1)
    upload_child(4, 3)
    found = api.get(f"creatures/{parent}/children").json()
    assert (found["total"], sorted(names(found))) == (2, sorted([two, three]))
    few = api.get(f"creatures/{parent}/children", params={"limit": 1}).json()
    assert (few["total"], len(few["items"])) == (2, 1)


@pytest.fixture
def enter(api, report, attempt):
    """Records a creature with a fitness and a parent, and returns its name."""
    assert attempt is not None

    def enter(generation: int, fitness: float, parent: str) -> str:
        found = report(generation, {7: fitness})
        (elite,) = found.elites
        elite.provenance = {**elite.provenance, "parents": [parent]}
        attempt.record(found, 1.0)
        return elite.creature

    return enter


def test_children_are_named_best_first_and_unmeasured_ones_last(api, upload_child, enter):
    parent = upload_child(1)
    unmeasured = upload_child(2, 1)
    fitness = [9.5, -3.0, 10.25, 1e-7, 0.0]
    made = {enter(i, value, parent): value for i, value in enumerate(fitness, 1)}
    best = sorted(made, key=lambda name: made[name], reverse=True)
    found = api.get(f"creatures/{parent}/children").json()
    assert names(found) == [*best, unmeasured]
    few = api.get(f"creatures/{parent}/children", params={"limit": 2}).json()
    assert (few["total"], names(few)) == (6, best[:2])


def test_a_creature_as_hdf5_is_complete_and_always_the_same_bytes(api, upload_child):
    name = upload_child(3, 1)
    answer = api.get(f"creatures/{name}/creature.h5")
    assert answer.status_code == 200
    assert f'filename="creature-{name[:12]}.h5"' in answer.headers["content-disposition"]
    document = api.get(f"creatures/{name}").json()
    assert creature_h5.load(answer.content) == creature.parse(document)
    assert api.get(f"creatures/{name}/creature.h5").content == answer.content
    with h5py.File(BytesIO(answer.content), "r") as file:
        weights: Any = file["genome/connections/weight"]
        assert weights[:] == [3.0]


@pytest.mark.parametrize(
    "measures", [{"a\0b": 1.0}, {"a": 10**400}, {"a": "1/"}, {str(i): 0 for i in range(1001)}]
)
def test_impossible_measures_are_refused(api, identity, measures):
    measured = {"fitness": 0.5, "descriptors": {}, "block": 16, "room": [24, 64], "device": ""}
    measured["measures"] = {"displacement": 0.5, **measures}
    file = creature.document(identity(1), measured, None)
    assert api.post("creatures", json=file).status_code == 422
