"""Lists are read in the order of an index, on PostgreSQL, however long they are."""

from typing import get_args

import pytest
import reports
from sqlalchemy import event, select, text

from server.runs import listing, log
from server.runs.submission import submit
from server.shares import routes as shares
from server.sweeps import routes as sweeps
from server.tables import Run, Share, Sweep

RUNS = [
    (listing.order(sort), listing.matching([], [], None, None))
    for sort in get_args(listing.Sort)
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
    first = plans(lambda session: order.page(session, statement, None, 1))
    assert len(first) == 2  # Those with a key, and those without.
    assert all("Index Scan" in plan for plan in first), first
    assert not any("Sort" in plan for plan in first), first


def test_a_later_page_begins_in_the_index(plans, services, update_rows):
    for best in (None, None, 1.0, 2.0):
        update_rows(Run, Run.id == submit(services, reports.DEMO)[0].id, best=best)
    order, statement = listing.order("-best"), listing.matching([], [], None, None)
    pages, cursor = [], None
    with services.sessions.read() as session:
        while not pages or cursor:
            found, cursor = order.page(session, statement, cursor, 1)
            pages.append((found[0].best, cursor))
    assert [best for best, _ in pages] == [2.0, 1.0, None, None]
    (plan, _) = plans(lambda session: order.page(session, statement, pages[0][1], 2))
    assert "Index Cond: ((best IS NOT NULL) AND (ROW(best, id) <" in plan


def test_the_log_of_a_run_needs_no_sort(plans, run_id):
    for after in (None, 0):
        (plan,) = plans(lambda session, after=after: log.read(session, run_id, after, 5))
        assert "ix_log_entries_run_id_id" in plan
        assert "Sort" not in plan
