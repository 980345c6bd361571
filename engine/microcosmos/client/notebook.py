"""A run in a notebook: one display, which is updated."""

import time
from collections.abc import Iterator
from contextlib import contextmanager
from html import escape
from importlib import import_module
from typing import Any

from . import drawing, formatting
from .polling import RunState
from .views import Show

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
