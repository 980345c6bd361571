"""Watch a run in a terminal, in a notebook, on a map, or as plain lines."""

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from html import escape
from importlib import import_module
from threading import Thread
from typing import TYPE_CHECKING, Any

from rich.console import Console, Group, RenderableType
from rich.live import Live
from rich.progress_bar import ProgressBar
from rich.table import Table
from rich.text import Text

from . import drawing, formatting, polling
from .connection import Connection
from .errors import ServerError
from .polling import RunState

if TYPE_CHECKING:
    from .run import Run


LINE_SECONDS = 30.0
"""Time between two plain lines, unless something changes."""

Show = Callable[[RunState], None]
View = AbstractContextManager[Show]


def watch(states: Iterator[RunState], what: str, view: View | None = None) -> str:
    """Show a run or a sweep, such as `Run ID`, until it ends; return its status.

    Ctrl-C ends only the watching; `KeyboardInterrupt` is passed on.
    """
    status = ""
    try:
        with view or choose()() as show:
            for state in states:
                show(state)
                status = state.record["status"]
    except KeyboardInterrupt:
        again = f"microcosmos watch {what.rpartition(' ')[2][:8]}"
        text = f"{what} goes on without being watched; to watch it again: {again}"
        print(text, file=sys.stderr, flush=True)
        raise
    return status


def choose() -> Callable[[], View]:
    """Return the view for this environment."""
    if in_notebook():
        return notebook
    return terminal if Console(stderr=True).is_terminal else lines


def in_notebook() -> bool:
    """Tell whether a notebook shows the output; IPython is not imported for that."""
    loaded: Any = sys.modules.get("IPython")
    shell = loaded.get_ipython() if loaded else None
    return shell is not None and hasattr(shell, "kernel")


@contextmanager
def lines() -> Iterator[Show]:
    """Print a line when the status changes, at each tenth of the way, and each half minute.

    As all progress, it goes to standard error.
    """
    last: Any = None
    at = float("-inf")

    def show(state: RunState) -> None:
        nonlocal last, at
        record = state.record
        now = (record["status"], int(10 * record["progress"]), state.problem)
        if now != last or time.monotonic() - at >= LINE_SECONDS:
            last, at = now, time.monotonic()
            print(line(state), file=sys.stderr, flush=True)

    yield show


def line(state: RunState) -> str:
    """Describe a run on one line."""
    record = state.record
    parts = [
        formatting.title(record),
        formatting.status_and_reason(record),
        formatting.done(record),
        *(f"{name} {value}" for name, value in formatting.figures(record)),
        formatting.speed(record),
        state.problem,
    ]
    return "  ".join(map(formatting.visible, filter(None, parts)))


SECONDS = 2.0
"""Shortest time between two requests of the archive, in seconds."""


def live(run: "Run", connection: Connection, **options: Any) -> Any:
    """Return the map, and follow the run in a thread until it ends."""
    if "archive" not in run.spec:
        raise ValueError(f"a run with an archive is needed, got {run.experiment!r}")
    from ..widgets import ArchiveMap  # Needs the optional anywidget.

    shown = ArchiveMap(run, **options)
    # A daemon, so that the thread ends with the kernel of the notebook.
    thread = Thread(target=_follow, args=(run, connection, shown), daemon=True)
    thread.start()
    return shown


def _follow(run: "Run", connection: Connection, shown: Any) -> None:
    generation, at = -1, float("-inf")
    try:
        for state in polling.follow(connection, run.id):
            record = state.record
            due = state.ended or time.monotonic() - at >= SECONDS
            if due and record["generation"] != generation:
                shown.show(run)
                generation, at = record["generation"], time.monotonic()
            status = f"{formatting.status_and_reason(record)} · {formatting.done(record)}"
            shown.status = state.problem or status
    except ServerError as error:
        shown.status = str(error)


CURVE_LINES = 4
LONGEST_BAR = 32
"""Characters."""


@contextmanager
def terminal() -> Iterator[Show]:
    """Draw in place; the last state stays."""
    console = Console(stderr=True)
    with Live(Text("..."), console=console, refresh_per_second=4) as live:
        yield lambda state: live.update(drawn(state, console.width))


def drawn(state: RunState, width: int) -> RenderableType:
    record = state.record
    head = Text(formatting.title(record) + "  ")
    colour = formatting.COLOURS.get(record["status"], "cyan")
    head.append(formatting.status_and_reason(record), colour)
    figures = "   ".join(f"{name} {value}" for name, value in formatting.figures(record))
    problems = filter(None, (record.get("warning"), state.problem))
    return Group(
        head,
        _bar(state, width),
        Text(figures),
        *_curves(state, width),
        *(Text(formatting.visible(problem), "yellow") for problem in problems),
    )


def _bar(state: RunState, width: int) -> RenderableType:
    """Draw the bar on one line, in the space that its words leave."""
    record = state.record
    percent = f"{100 * record['progress']:.0f} %"
    words = [percent, formatting.done(record), formatting.speed(record)]
    length = max(4, min(LONGEST_BAR, width - sum(len(text) + 2 for text in words)))
    table = Table.grid(padding=(0, 2))
    table.add_row(ProgressBar(total=1.0, completed=record["progress"], width=length), *words)
    return table


def _curves(state: RunState, width: int) -> list[RenderableType]:
    curves = {}
    for name, title in formatting.MEASURES.items():
        known = [value for value in state.curves.get(name, []) if value is not None]
        if len(known) > 1:
            head = f"{title}  {min(known):.3g} to {max(known):.3g}"
            curves[head] = state.curves[name]
    if not curves:
        return []
    table = Table.grid(padding=(0, 2))
    each = max(8, min(36, (width - 2 * len(curves)) // len(curves)))
    table.add_row(*(Text(head, "dim") for head in curves))
    pictures = (drawing.braille(values, each, CURVE_LINES) for values in curves.values())
    table.add_row(*(Text("\n".join(lines), "cyan", no_wrap=True) for lines in pictures))
    return [table]


UPDATE_SECONDS = 0.5
WIDTH, HEIGHT = 200, 60
COLOURS = {"finished": "#2a8f4e", "failed": "#c0392b", "cancelled": "#b7791f"}


@contextmanager
def notebook() -> Iterator[Show]:
    """Update one display; the last state stays in the notebook when it is saved."""
    handle: Any = None
    last: RunState | None = None
    at = float("-inf")

    def draw(state: RunState) -> None:
        nonlocal handle
        shown = import_module("IPython.display")
        page = shown.HTML(html(state))
        # One display that is updated: a saved notebook keeps the last state alone.
        if handle is None:
            handle = shown.display(page, display_id=True)
        else:
            handle.update(page)

    def show(state: RunState) -> None:
        nonlocal last, at
        last = state
        if time.monotonic() - at >= UPDATE_SECONDS:
            at = time.monotonic()
            draw(state)

    try:
        yield show
    finally:
        # The last state may have come within the pause after the one before.
        if last is not None:
            draw(last)


def html(state: RunState) -> str:
    record = state.record
    colour = COLOURS.get(record["status"], "#2f7ec0")
    pairs = formatting.figures(record)
    figures = [f"{escape(name)} <b>{escape(value)}</b>" for name, value in pairs]
    words = [formatting.done(record), *figures, formatting.speed(record)]
    problems = " ".join(filter(None, [record.get("warning"), state.problem]))
    curves = (
        _curve(title, state.curves.get(name, []), colour)
        for name, title in formatting.MEASURES.items()
    )
    return (
        f"<div><b>{escape(formatting.title(record))}</b> "
        f'<span style="color:{colour}">{escape(formatting.status_and_reason(record))}</span>'
        f'</div><progress max="1" value="{record["progress"]:.4f}" style="width:{3 * WIDTH}px">'
        f"</progress><div>{' · '.join(filter(None, words))}</div>"
        f'<div style="display:flex;gap:12px">{"".join(curves)}</div>'
        f'<div style="color:#b7791f">{escape(problems)}</div>'
    )


def _curve(title: str, values: list[float | None], colour: str) -> str:
    points = drawing.polyline(values, WIDTH, HEIGHT)
    if not points:
        return ""
    return (
        f'<figure style="margin:4px 0"><figcaption>{title}</figcaption>'
        f'<svg width="{WIDTH + 4}" height="{HEIGHT + 4}" viewBox="-2 -2 {WIDTH + 4} '
        f'{HEIGHT + 4}" role="img" aria-label="{title}"><polyline points="{points}" '
        f'fill="none" stroke="{colour}" stroke-width="1.5"/></svg></figure>'
    )
