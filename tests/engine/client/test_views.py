"""Views of a run in terminals and notebooks."""

import sys
from types import SimpleNamespace

import httpx
import numpy as np
import pytest
from rich.console import Console

from microcosmos.client import NoAnswer, ServerError, drawing, polling, views
from microcosmos.client.columns import Columns, array
from microcosmos.client.formatting import duration
from microcosmos.client.polling import RunState

CURVES = {
    "generation": [1, 2, 3],
    "qd_score": [1.0, 2.0, 3.25],
    "coverage": [0.0, 0.1, 0.125],
    "best": [1.5, 1.5, 1.5],
}


def dots(lines):
    """(column, row from below) of every dot that is set."""
    return {
        (2 * sign + x, 4 * (len(lines) - line) - 1 - y)
        for line, text in enumerate(lines)
        for sign, letter in enumerate(text)
        for x, y in np.ndindex(2, 4)
        if (ord(letter) - 0x2800) & drawing.DOTS[x][y]
    }


@pytest.mark.parametrize(
    ("values", "size", "expected"),
    [
        (np.arange(8.0).tolist(), (4, 2), {(i, i) for i in range(8)}),
        ([0.0, 0.0, 1.0, 1.0], (2, 1), {(0, 0), (1, 0), (2, 1), (2, 2), (2, 3), (3, 3)}),
        ([2.0, None, 2.0, 2.0], (2, 1), {(0, 0), (2, 0), (3, 0)}),
    ],
    ids=["a line is straight", "a step has no gap", "unknown values are gaps"],
)
def test_braille_dots_are_those_of_the_curve(values, size, expected):
    assert dots(drawing.braille(values, *size)) == expected


def shown(state, width=100):
    console = Console(width=width, record=True, file=sys.stderr)
    console.print(views.drawn(state, width))
    return console.export_text()


def test_a_terminal_shows_the_state_within_its_width(record):
    text = shown(RunState(record, CURVES))
    progress = ("“mine”", "0f3c1a2b", "50 %", "5/10 generations", "1 min 15 s left")
    for part in (
        *progress,
        "12.5 evaluations/s",
        "QD score 3.25",
        "coverage 12.5 %",
        "best 1.5",
    ):
        assert part in text
    assert any(letter > "\u2800" for letter in text)
    narrow = shown(RunState(record, CURVES), 40)
    assert max(map(len, narrow.splitlines())) <= 40
    (line,) = (one for one in shown(RunState(record), 80).splitlines() if "50 %" in one)
    assert "1 min 15 s left" in line


def test_plain_lines_come_when_something_changes(record, capsys):
    states = ((0.5, "running"), (0.51, "running"), (0.6, "running"), (1, "failed"))
    with views.lines() as show:
        for progress, status in states:
            show(RunState(record | {"progress": progress, "status": status, "error": "why"}))
    said = capsys.readouterr()
    lines = said.err.splitlines()
    assert len(lines) == 3
    assert "failed: why" in lines[-1]
    assert not said.out  # It is for data.


EVIL = "a\x1b[2J\x9b2J\u202eb\nc"
SHOWN = r"a\u001b[2J\u009b2J\u202eb\u000ac"


@pytest.mark.parametrize(
    "field", ["name", "experiment", "status", "waiting_reason", "error", "warning"]
)
def test_characters_that_steer_a_terminal_are_shown(record, field):
    state = RunState(record | {field: EVIL}, {}, problem=EVIL)
    assert views.line(state).count(SHOWN) == 1 + (field != "warning")
    assert "\x1b" not in views.line(state)
    assert shown(state).count(SHOWN) == 2
    assert "\x1b" not in shown(state)


@pytest.fixture
def ipython(monkeypatch):
    """As if a notebook's kernel ran this: what it displays."""
    shown = []
    handle = SimpleNamespace(update=shown.append)

    def display(page, display_id):
        assert display_id
        shown.append(page)
        return handle

    shell = SimpleNamespace(kernel=None)
    library = SimpleNamespace(get_ipython=lambda: shell)
    monkeypatch.setitem(sys.modules, "IPython", library)

    def html(text):
        return SimpleNamespace(_repr_html_=lambda: text)

    namespace = SimpleNamespace(display=display, HTML=html)
    monkeypatch.setitem(sys.modules, "IPython.display", namespace)
    return shown


def test_a_notebook_brings_one_display_up_to_date(ipython, record):
    assert views.choose() is views.notebook
    named = record | {"name": "<script>"}
    with views.notebook() as show:
        show(RunState(named, CURVES))
        show(RunState(named | {"status": "finished"}, CURVES))
    first, last = ipython[0]._repr_html_(), ipython[-1]._repr_html_()
    assert first.count("<polyline") == 3
    assert "<script>" not in first
    assert "running" in first
    assert "finished" in last  # Whatever was left out for speed, the end is shown.


def test_without_a_terminal_or_notebook_there_are_lines(monkeypatch):
    monkeypatch.delitem(sys.modules, "IPython", raising=False)
    assert views.choose() is views.lines
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    assert views.choose() is views.terminal


def test_columns_are_arrays_with_gaps_as_nan():
    found = Columns({"a": [1, 2], "b": [None, 0.5], "c": ["x", "y"], "d": [[1], []]})
    assert found["a"].dtype == np.int64
    np.testing.assert_array_equal(found["b"], [np.nan, 0.5])
    assert found["d"][0] == [1]
    assert dict(found).keys() == {"a", "b", "c", "d"}
    assert array([]).dtype == float


@pytest.mark.parametrize(
    ("seconds", "words"),
    [(0.4, "0 s"), (75, "1 min 15 s"), (3720, "1 h 2 min"), (90000, "1 d 1 h"), (None, "")],
)
def test_durations_have_two_units(seconds, words):
    assert duration(seconds) == words


def test_a_sweep_is_watched_through_an_outage(fake, monkeypatch):
    monkeypatch.setattr(polling, "POLL", 0.0)
    sweep = {"id": "5eed", "name": None, "total": 2}
    away = [NoAnswer("No server answers."), ServerError("The database does not answer.", 503)]
    states = [{"queued": 2}, {"running": 1, "failed": 1}, *away]
    answers = iter([*states, {"finished": 1, "failed": 1}])

    def read(path):
        if isinstance(counts := next(answers), ServerError):
            raise counts
        return sweep | {"status_counts": counts}

    connection = fake({}).client.connection
    monkeypatch.setattr(connection, "read", read)
    states = polling.follow_sweep(connection, "5eed")
    shown = [(state.record["status"], state.problem) for state in states]
    lost = [("running", str(error)) for error in away]
    assert shown == [("queued", None), ("running", None), *lost, ("failed", None)]


def test_a_server_that_fails_ends_the_watching(fake):
    problem = {"content-type": "application/problem+json"}
    failed = httpx.Response(500, headers=problem, json={"detail": "The server failed."})
    connection = fake({("GET", "sweeps/5eed"): failed}).client.connection
    with pytest.raises(ServerError, match="The server failed"):
        next(polling.follow_sweep(connection, "5eed"))
