"""A run in a terminal: its progress, its figures, its curves."""

from typing import Self

from rich.console import Console, Group, RenderableType
from rich.live import Live
from rich.progress_bar import ProgressBar
from rich.table import Table
from rich.text import Text

from . import drawing, formatting
from .polling import Standing

COLOURS = {"finished": "green", "failed": "red", "cancelled": "yellow", "paused": "yellow"}
HEIGHT = 4
LONGEST = 32
"""Signs of a progress bar."""


class Terminal:
    """Drawn anew a few times a second, in place; the last state stays."""

    def __init__(self, console: Console | None = None) -> None:
        self.console = console or Console()
        self.standing: Standing | None = None
        self.live = Live(console=self.console, get_renderable=self._drawn, refresh_per_second=4)

    def __enter__(self) -> Self:
        self.live.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.live.stop()

    def show(self, standing: Standing) -> None:
        self.standing = standing

    def _drawn(self) -> RenderableType:
        if self.standing is None:
            return Text("...")
        return drawn(self.standing, self.console.width)


def drawn(standing: Standing, width: int) -> RenderableType:
    record = standing.record
    head = Text(formatting.titled(record) + "  ")
    head.append(formatting.standing(record), COLOURS.get(record["status"], "cyan"))
    figures = "   ".join(f"{name} {value}" for name, value in formatting.figures(record))
    parts: list[RenderableType] = [head, _bar(standing, width), Text(figures)]
    parts += _curves(standing, width)
    for trouble in (record.get("warning"), standing.trouble):
        if trouble:
            parts.append(Text(trouble, "yellow"))
    return Group(*parts)


def _bar(standing: Standing, width: int) -> RenderableType:
    """On one line: the bar has the room that its words leave."""
    record = standing.record
    share = f"{100 * record['progress']:.0f} %"
    done = f"{record['generation']}/{record['generations']} {record.get('unit', 'generations')}"
    told = [share, done, formatting.pace(record)]
    room = width - sum(len(text) + 2 for text in told)
    bar = ProgressBar(total=1.0, completed=record["progress"], width=max(4, min(LONGEST, room)))
    table = Table.grid(padding=(0, 2))
    table.add_row(bar, *told)
    return table


def ends(values: list[float | None]) -> str:
    """What the lowest and the highest dots stand for."""
    known = [value for value in values if value is not None]
    return f"{min(known):.3g} to {max(known):.3g}"


def _curves(standing: Standing, width: int) -> list[RenderableType]:
    """Side by side, as many as there is room and something to tell."""
    known = [
        (title, standing.curves[name])
        for title, name in formatting.FIGURES
        if sum(value is not None for value in standing.curves.get(name, [])) > 1
    ]
    if not known:
        return []
    table = Table.grid(padding=(0, 2))
    each = max(8, min(36, (width - 2 * len(known)) // len(known)))
    table.add_row(*(Text(f"{title}  {ends(values)}", "dim") for title, values in known))
    pictures = (drawing.braille(values, each, HEIGHT) for _, values in known)
    table.add_row(*(Text("\n".join(lines), "cyan", no_wrap=True) for lines in pictures))
    return [table]
