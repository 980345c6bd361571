"""Lists are read in the order of an index, on PostgreSQL, however long they are."""

import json
import re
from typing import get_args

import pytest
import reports
from sqlalchemy import event, select, text

from microcosmos_server.core import paging
from microcosmos_server.runs import log, routes
from microcosmos_server.runs.submission import submit
from microcosmos_server.shares import routes as shares
from microcosmos_server.sweeps import routes as sweeps
from microcosmos_server.tables import Run, Share, Sweep

RUNS = [
    (routes.order(sort), routes.matching([], [], None, None)) for sort in get_args(routes.Sort)
]
OTHERS = [(shares.NEWEST_FIRST, select(Share)), (sweeps.NEWEST_FIRST, select(Sweep))]


@pytest.fixture
def database():
    return "postgresql"


@pytest.fixture
def plans(services):
    """The plans of the queries of an action, by a planner that sorts only if it must."""

    def planned(action):
        sent = []

        def note(_connection, _cursor, statement, parameters, *_):
            sent.append((statement, parameters))

        engine = services.sessions.engine
        with services.sessions.read() as session:
            for kind in ("sort", "seqscan", "bitmapscan"):
                session.execute(text(f"SET LOCAL enable_{kind} = off"))
            event.listen(engine, "before_cursor_execute", note)
            try:
                action(session)
            finally:
                event.remove(engine, "before_cursor_execute", note)
            connection = session.connection()
            return [
                "\n".join(row[0] for row in connection.exec_driver_sql(f"EXPLAIN {one}", given))
                for one, given in sent
            ]

    return planned


@pytest.mark.parametrize(
    ("order", "statement"),
    [*RUNS, *OTHERS],
    ids=[one.name for one, _ in RUNS] + ["shares", "sweeps"],
)
def test_a_page_of_a_list_needs_no_sort(plans, order, statement):
    *first, _rows = plans(lambda session: order.page(session, statement, None, 1))
    assert len(first) == 2  # Those with a key, and those without.
    assert all(re.search("Index (Only )?Scan", plan) for plan in first), first
    assert not any("Sort" in plan for plan in first), first


def test_a_later_page_begins_in_the_index(plans, services, update_rows):
    for best in (None, None, 1.0, 2.0):
        update_rows(Run, Run.id == submit(services, reports.DEMO)[0].id, best=best)
    order, statement = routes.order("-best"), routes.matching([], [], None, None)
    pages, cursor = [], None
    with services.sessions.read() as session:
        while not pages or cursor:
            found, cursor = order.page(session, statement, cursor, 1)
            pages.append((found[0].best, cursor))
    assert [best for best, _ in pages] == [2.0, 1.0, None, None]
    plan, *_ = plans(lambda session: order.page(session, statement, pages[0][1], 2))
    assert "Index Cond: ((best IS NOT NULL) AND (ROW(best, id) <" in plan


@pytest.mark.parametrize("path", ["runs", "sweeps", "shares", "commons"])
def test_a_list_has_pages_newest_first(api, spec, known, path):
    noun, key = ("shares", "slug") if path in ("shares", "commons") else (path, "id")
    made = []
    for seed in range(3):
        sent = {"runs": spec | {"seed": seed}, "sweeps": {"spec": spec}}
        share = {"creature": known, "title": f"{seed}", "listed": True}
        made.append(api.post(noun, json=sent.get(noun, share)).json()[key])
    first = api.get(path, params={"limit": 2}).json()
    rest = api.get(path, params={"limit": 2, "cursor": first["next"]}).json()
    assert [one[key] for one in first["items"] + rest["items"]] == made[::-1]
    assert (len(first["items"]), rest["next"]) == (2, None)
    assert api.get(path, params={"cursor": "x"}).status_code == 422


@pytest.mark.parametrize("path", ["runs", "sweeps"])
def test_a_page_of_long_specs_ends_early_and_the_next_goes_on(api, spec, monkeypatch, path):
    lengths = []
    for number in range(5):
        sent = spec | {"seed": number}
        made = api.post(path, json=sent if path == "runs" else {"spec": sent}).json()
        lengths.append((len(json.dumps(made["spec"])), made["id"]))
    room = sum(length for length, _ in lengths[-2:]) + 200  # Also for the grids, `{}`.
    monkeypatch.setattr(paging, "PAGE_LENGTH", room)
    pages, cursor = [], None
    while not pages or cursor:
        page = api.get(path, params={"cursor": cursor} if cursor else {}).json()
        pages.append([one["id"] for one in page["items"]])
        cursor = page["next"]
    newest_first = [made for _, made in lengths[::-1]]
    assert pages == [newest_first[:2], newest_first[2:4], newest_first[4:]]
    monkeypatch.setattr(paging, "PAGE_LENGTH", 1)
    assert len(api.get(path).json()["items"]) == 1


def test_the_log_of_a_run_needs_no_sort(plans, run_id):
    for after in (None, 0):
        (plan,) = plans(lambda session, after=after: log.read(session, run_id, after, 5))
        assert "ix_log_entries_run_id_id" in plan
        assert "Sort" not in plan
