"""Views of a run in terminals and notebooks."""

import re
import sys
from types import SimpleNamespace

import numpy as np
import pytest
from rich.console import Console

from microcosmos.client import (
    NoAnswer,
    drawing,
    formatting,
    notebook,
    polling,
    terminal,
    views,
)
from microcosmos.client.columns import Columns, array
from microcosmos.client.polling import RunState

CURVES = {
    "generation": [1, 2, 3],
    "qd_score": [1.0, 2.0, 3.25],
    "coverage": [0.0, 0.1, 0.125],
    "best": [1.5, 1.5, 1.5],
}


def dots(lines):
    """(column, row from below) of every dot that is set."""
    found = set()
    for line, text in enumerate(lines):
        for sign, letter in enumerate(text):
            for x in (0, 1):
                for y in range(4):
                    if (ord(letter) - 0x2800) & drawing.DOTS[x][y]:
                        found.add((2 * sign + x, 4 * (len(lines) - line) - 1 - y))
    return found


def test_a_straight_line_is_drawn_straight():
    assert dots(drawing.braille(np.arange(8.0).tolist(), 4, 2)) == {(i, i) for i in range(8)}


def test_a_step_is_drawn_without_a_gap():
    assert dots(drawing.braille([0.0, 0.0, 1.0, 1.0], 2, 1)) == {
        (0, 0), (1, 0), (2, 1), (2, 2), (2, 3), (3, 3)
    }  # fmt: skip


def test_unknown_values_are_gaps_and_constants_a_line():
    assert dots(drawing.braille([2.0, None, 2.0, 2.0], 2, 1)) == {(0, 0), (2, 0), (3, 0)}
    assert drawing.braille([None], 3, 1) == ["⠀⠀⠀"]
    assert drawing.polyline([None, 1.0, 3.0], 10, 4) == "5.0,4.0 10.0,0.0"
    assert drawing.polyline([], 10, 4) == ""


def shown(state, width=100):
    console = Console(width=width, record=True, file=sys.stderr)
    console.print(terminal.drawn(state, width))
    return console.export_text()


def test_a_terminal_shows_how_it_stands(record):
    text = shown(RunState(record, CURVES))
    for part in ("“mine”", "0f3c1a2b", "50 %", "5/10 generations", "1 min 15 s left"):
        assert part in text
    for part in ("12.5 evaluations/s", "QD score 3.25", "coverage 12.5 %", "best 1.5"):
        assert part in text
    assert any(letter > "\u2800" for letter in text)
    narrow = shown(RunState(record, CURVES), 40)
    assert max(map(len, narrow.splitlines())) <= 40


def test_progress_and_time_left_share_a_line_of_80_columns(record):
    (line,) = (one for one in shown(RunState(record), 80).splitlines() if "50 %" in one)
    assert "1 min 15 s left" in line


def test_trouble_and_reasons_are_shown(record):
    waits = record | {
        "status": "queued",
        "waiting_reason": "no worker is free",
        "eta_seconds": None,
    }
    text = shown(RunState(waits, {}, "No server answers."))
    assert "queued: no worker is free" in text
    assert "No server answers." in text
    assert "evaluations/s" not in text


def test_a_table_shows_its_summary(record):
    table = record | {"qd_score": None, "summary": {"fastest_speed": 0.25, "name": "x"}}
    assert "fastest speed 0.25" in shown(RunState(table))


def test_plain_lines_come_when_something_changes(record, capsys):
    states = ((0.5, "running"), (0.51, "running"), (0.6, "running"), (1, "failed"))
    with views.lines() as show:
        for progress, status in states:
            show(RunState(record | {"progress": progress, "status": status, "error": "why"}))
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 3
    assert "failed: why" in lines[-1]


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
    assert views.choose() is notebook.notebook
    named = record | {"name": "<script>"}
    with notebook.notebook() as show:
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
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True, raising=False)
    assert views.choose() is terminal.terminal


def test_columns_are_arrays_with_gaps_as_nan():
    found = Columns({"a": [1, 2], "b": [None, 0.5], "c": ["x", "y"], "d": [[1], []]})
    assert found["a"].dtype == np.int64
    np.testing.assert_array_equal(found["b"], [np.nan, 0.5])
    assert found["d"][0] == [1]
    assert dict(found).keys() == {"a", "b", "c", "d"}
    assert array([]).dtype == float


def test_a_map_has_its_cells_where_they_are():
    axes = [{"name": "turning", "bins": 4}, {"name": "<b>", "bins": 2}]
    picture = drawing.archive_map(
        axes, np.array([0, 3, 6]), np.array([1.0, 2.0, 3.0]), "a caption"
    )
    squares = re.findall(r'x="([\d.]+)" y="([\d.]+)" .*? fill="(#\w+)"', picture)
    assert squares == [
        ("0.00", "160.00", "#440154"),
        ("80.00", "0.00", "#21918c"),
        ("240.00", "160.00", "#fde725"),
    ]
    assert "<b>" not in picture
    assert "<rect" not in drawing.archive_map(axes, np.array([]), np.array([]), "")


def test_columns_are_a_data_frame_where_pandas_is_there():
    pytest.importorskip("pandas")
    found = Columns({"a": [1, 2], "b": [None, 0.5]}).to_pandas()
    assert list(found.columns) == ["a", "b"]
    assert found["a"].tolist() == [1, 2]


def test_without_pandas_it_is_said_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ImportError, match=r"pip install .pandas"):
        Columns({"a": [1]}).to_pandas()


@pytest.mark.parametrize(
    ("seconds", "words_"),
    [(0.4, "0 s"), (75, "1 min 15 s"), (3720, "1 h 2 min"), (90000, "1 d 1 h"), (None, "")],
)
def test_durations_have_two_units(seconds, words_):
    assert formatting.duration(seconds) == words_


def test_a_sweep_is_watched_through_an_outage(fake, monkeypatch):
    """As a run is: laptops sleep, servers start again."""
    monkeypatch.setattr(polling, "POLL", 0.0)
    sweep = {"id": "5eed", "name": None, "total": 2}
    states = [
        {"queued": 2},
        {"running": 1, "failed": 1},
        None,
        None,
        {"finished": 1, "failed": 1},
    ]
    left = list(states)

    def read(path):
        if (counts := left.pop(0)) is None:
            raise NoAnswer("No server answers.")
        return sweep | {"status_counts": counts}

    connection = fake({}).client.connection
    monkeypatch.setattr(connection, "read", read)
    shown = [
        (state.record["status"], state.problem)
        for state in polling.follow_sweep(connection, "5eed")
    ]
    lost = ("running", "No server answers.")
    assert shown == [("queued", None), ("running", None), lost, lost, ("failed", None)]
