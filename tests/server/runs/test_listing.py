"""Names, tags and notes of runs, and lists that are filtered and sorted, over HTTP."""

from base64 import urlsafe_b64encode
from uuid import UUID, uuid4

import pytest
from answers import detail, errors

from microcosmos_server.tables import Run

pytestmark = pytest.mark.postgresql


@pytest.fixture
def add(api, update_rows, spec):
    """Submits a run, edits it and sets figures that only a worker sets."""
    count = iter(range(1000))

    def add(edits=None, **figures):
        run = api.post("runs", json={**spec, "seed": next(count)}).json()["id"]
        if edits:
            assert api.patch(f"runs/{run}", json=edits).status_code == 200
        if figures:
            update_rows(Run, Run.id == UUID(run), **figures)
        return run

    return add


@pytest.fixture
def found(api):
    def found(**query):
        answer = api.get("runs", params=query)
        assert answer.status_code == 200, answer.text
        return [run["id"] for run in answer.json()["items"]]

    return found


def test_runs_take_a_name_tags_and_a_note(api, run_id):
    before = api.get(f"runs/{run_id}").json()
    assert (before["name"], before["tags"], before["note"]) == (None, [], None)
    edits = {"name": "  Wide bodies ", "tags": [" wide", "naïve é"], "note": "Line 1\nLine 2"}
    changed = api.patch(f"runs/{run_id}", json=edits).json()
    after = {"name": "Wide bodies", "tags": ["wide", "naïve é"], "note": "Line 1\nLine 2"}
    assert changed == {**before, **after}
    assert api.patch(f"runs/{run_id}", json={"note": ""}).json()["note"] is None
    kept = api.patch(f"runs/{run_id}", json={}).json()
    assert kept == {**before, **after, "note": None}
    assert api.patch(f"runs/{run_id}", json={"name": None}).json()["name"] is None


@pytest.mark.parametrize(
    ("change", "field", "words"),
    [
        ({"name": "a" * 201}, "name", "at most 200 characters"),
        ({"name": 5}, "name", "valid string"),
        ({"tags": ["a" * 51]}, "tags.0", "at most 50 characters"),
        ({"tags": ["fine", " "]}, "tags.1", "1 or more characters"),
        ({"tags": [f"tag {i}" for i in range(21)]}, "tags", "at most 20 items"),
        ({"tags": ["same", " same "]}, "tags", "differ"),
        ({"tags": None}, "tags", "valid array"),
        ({"note": "a" * 10_001}, "note", "at most 10000 characters"),
        ({"status": "finished"}, "status", "no field of this name"),
        ({"spec": {}}, "spec", "no field of this name"),
    ],
)
def test_invalid_names_tags_and_notes_are_refused_by_field(api, run_id, change, field, words):
    before = api.get(f"runs/{run_id}").json()
    (error,) = errors(api.patch(f"runs/{run_id}", json={"name": "fine", **change}))
    assert error["field"] == field
    assert words in error["reason"]
    assert api.get(f"runs/{run_id}").json() == before


def test_recording_keeps_the_name_of_a_run(api, run_id, record, attempt):
    api.patch(f"runs/{run_id}", json={"name": "mine"})
    record(1, {1: 1.0})
    assert api.get(f"runs/{run_id}").json()["name"] == "mine"
    gone = "00000000-0000-0000-0000-000000000000"
    assert api.patch(f"runs/{gone}", json={"name": "a"}).status_code == 404


def test_lists_have_the_runs_of_any_of_the_states_and_experiments(api, add, found, sweep_id):
    first, second, third = add(), add(), add()
    api.post(f"runs/{first}/cancel")
    api.post(f"runs/{second}/pause")
    assert found(status=["cancelled", "paused"]) == [second, first]
    assert found(experiment="gaits") == [str(sweep_id)]
    both = found(experiment=["gaits", "quality-diversity"], status="queued")
    assert both == [third, str(sweep_id)]


def test_tags_are_whole_and_text_is_looked_for_anywhere(found, add):
    named = add({"name": "Wide Bodies", "tags": ["100%", "naïve"]})
    noted = add({"note": "see wide_bodies.csv", "tags": ["100"]})
    assert found(tag="100%") == [named]
    assert found(tag="100") == [noted]
    assert found(tag="wide") == []
    assert found(q="WIDE") == [noted, named]
    assert found(q="wide b") == [named]
    assert found(q="e_b") == [noted], "an underscore is no wildcard"
    assert found(q="0%") == [named], "a percent sign is no wildcard"
    assert found(q="naïv") == [named]
    assert found(q="\\") == found(q='"') == []


def test_search_ignores_case_in_any_alphabet_and_blanks(found, add):
    run = add({"name": "ÄLCHEN", "tags": ["Größe"], "note": "Вода"})
    other = add({"name": "Alchen"})
    for text in ("älchen", "GRÖ", "вОДа"):
        assert found(q=text) == [run], text
    assert found(q=" ") == found(q=" \t ") == found() == [other, run]
    last = add({"name": "äffchen"})
    assert found(sort="name", q="ä") == [last, run]


def test_text_finds_runs_by_the_beginning_of_their_ids(found, add):
    first, _ = add(), add()
    assert found(q=first) == [first]
    assert first in found(q=first[:3])
    assert found(q=first[:18]) == [first]
    assert found(q=first[1:]) == []


def test_all_tags_are_listed_with_the_number_of_their_runs(api, add):
    add({"tags": ["b", "a"]}), add({"tags": ["b"]}), add()
    assert api.get("tags").json() == [{"tag": "a", "runs": 1}, {"tag": "b", "runs": 2}]


def walked(api, **query):
    """The ids of all pages, two runs each."""
    cursor, ids = {}, []
    while True:
        page = api.get("runs", params={**query, **cursor, "limit": 2}).json()
        ids += [run["id"] for run in page["items"]]
        if page["next"] is None:
            return ids
        cursor = {"cursor": page["next"]}


@pytest.fixture
def several(add):
    """Runs whose figures have ties, and some of which have none."""
    names = ["b", None, "A", "b", "c", None, "a"]
    figures = [2.5, 0.1 + 0.2, None, 2.5, -1e-300, 1e300, None]
    return {
        add({"name": name}, best=best, qd_score=best, evaluations=i % 3, generation=i): i
        for i, (name, best) in enumerate(zip(names, figures, strict=True))
    }


ORDERS = {
    "created": [0, 1, 2, 3, 4, 5, 6],
    "progress": [0, 1, 2, 3, 4, 5, 6],
    "evaluations": [0, 1, 2, 0, 1, 2, 0],
    "name": [1, None, 0, 1, 2, None, 0],
    "best": [2, 1, None, 2, 0, 3, None],
    "qd_score": [2, 1, None, 2, 0, 3, None],
    "started": [None] * 7,
    "status": [0] * 7,
}
"""The ranks of the runs' values, by what they are sorted by."""


def test_pages_have_every_run_once_in_any_order(api, several):
    for key, ranks in ORDERS.items():
        for sign in ("", "-"):
            runs = walked(api, sort=sign + key)
            order = [ranks[several[run]] for run in runs]
            there = sorted((rank for rank in ranks if rank is not None), reverse=bool(sign))
            assert order == there + [None] * ranks.count(None), sign + key
            assert sorted(runs) == sorted(several), sign + key


def test_pages_go_on_where_they_were_though_runs_are_added(api, add, found):
    old = [add() for _ in range(3)]
    page = api.get("runs", params={"limit": 2}).json()
    half, done = add(generation=10), add(generation=5, status="finished")
    assert found(cursor=page["next"]) == [old[0]]
    assert found(sort="-progress")[:2] == [done, half], "a finished run is complete"


def test_invalid_filters_and_orders_are_refused_by_field(api, add):
    add(), add()
    for query in (
        {"sort": "colour"},
        {"status": "great"},
        {"experiment": "alchemy"},
        {"q": "a\0b"},
        {"tag": ""},
    ):
        answer = api.get("runs", params=query)
        assert answer.status_code == 422, query
        assert answer.json()["errors"][0]["field"].split(".")[0] in query
    page = api.get("runs", params={"limit": 1, "sort": "best"}).json()
    other = api.get("runs", params={"cursor": page["next"], "sort": "-created"})
    assert "`sort`" in detail(other, 422)


def crafted(sort, value, last=None):
    """A cursor that the server never sent; `value` is JSON."""
    text = f'["{sort}", {value}, "{last or uuid4()}"]'
    return urlsafe_b64encode(text.encode()).decode()


def test_a_forged_cursor_is_refused(api):
    wrong = {
        "evaluations": [str(10**30), str(1 << 63), "-1", "1.5", "1e300", "NaN", '"1"', "true"],
        "status": ["6", "-1", str(1 << 40), "0.5", "Infinity"],
        "best": ["NaN", "-Infinity", "1e999", "1" + 400 * "0", '"1"'],
        "progress": ["NaN", "[]"],
        "name": [r'"\ud800"', r'"a\u0000"', "5"],
        "experiment": [r'"\udfff"', r'"\u0000"'],
        "created": ['"0001-01-01T00:00:00+23:00"', '"9999-12-31T23:00:00-23:00"', '""', "0"],
        "started": ['"yesterday"'],
    }
    cursors = [(sort, crafted(sort, value)) for sort in wrong for value in wrong[sort]]
    deep = urlsafe_b64encode(20_000 * b"[").decode()
    cursors += [("best", crafted("best", "1", "no id")), ("best", deep), ("best", "é")]
    for sort, cursor in cursors:
        answer = api.get("runs", params={"sort": sort, "cursor": cursor})
        assert answer.status_code == 422, (sort, cursor)
        (error,) = answer.json()["errors"]
        assert error["field"] == "cursor"


def test_a_cursor_may_hold_any_possible_value(api):
    fine = {
        "evaluations": ["0", str((1 << 63) - 1)],
        "status": ["0", "5"],
        "best": ["1e308", "-3", "1" + 30 * "0", "null"],
        "name": ['"é"', '""'],
        "created": ['"0001-01-01T00:00:00+00:00"', '"9999-12-31T23:59:59.999999+00:00"'],
    }
    for sort, values in fine.items():
        for value in values:
            answer = api.get("runs", params={"sort": sort, "cursor": crafted(sort, value)})
            assert (answer.status_code, answer.json()) == (200, {"items": [], "next": None})
