"""A run in a terminal: its progress, its figures, its curves."""

from collections.abc import Iterator
from contextlib import contextmanager

from rich.console import Console, Group, RenderableType
from rich.live import Live
from rich.progress_bar import ProgressBar
from rich.table import Table
from rich.text import Text

from . import drawing, formatting
from .polling import RunState
from .views import Show

CURVE_LINES = 4
LONGEST_BAR = 32
"""Characters."""


@contextmanager
def terminal() -> Iterator[Show]:
    """Draw in place; the last state stays."""
    console = Console()
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
        *(Text(problem, "yellow") for problem in problems),
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
