"""A run in a notebook: one display, brought up to date."""

import time
from html import escape
from importlib import import_module
from typing import Any, Self

from . import drawing, formatting
from .polling import Standing

OFTEN = 0.5
"""Seconds between two states of the display."""
WIDTH, HEIGHT = 200, 60
COLOURS = {"finished": "#2a8f4e", "failed": "#c0392b", "cancelled": "#b7791f"}


class Notebook:
    """The last state stays in the notebook when it is saved."""

    def __init__(self) -> None:
        self.handle: Any = None
        self.standing: Standing | None = None
        self.at = float("-inf")

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self.standing is not None:
            self._display(self.standing)

    def show(self, standing: Standing) -> None:
        self.standing = standing
        if time.monotonic() - self.at >= OFTEN:
            self.at = time.monotonic()
            self._display(standing)

    def _display(self, standing: Standing) -> None:
        page = Page(html(standing))
        if self.handle is None:
            display = import_module("IPython.display").display
            self.handle = display(page, display_id=True)
        else:
            self.handle.update(page)


class Page:
    """HTML that a notebook shows."""

    def __init__(self, text: str):
        self.text = text

    def _repr_html_(self) -> str:
        return self.text


def html(standing: Standing) -> str:
    record = standing.record
    colour = COLOURS.get(record["status"], "#2f7ec0")
    done = f"{record['generation']}/{record['generations']} {record.get('unit', 'generations')}"
    figures = [
        f"{escape(name)} <b>{escape(value)}</b>" for name, value in formatting.figures(record)
    ]
    told = " · ".join(filter(None, [done, *figures, formatting.pace(record)]))
    trouble = " ".join(filter(None, [record.get("warning"), standing.trouble]))
    return (
        f"<div><b>{escape(formatting.titled(record))}</b> "
        f'<span style="color:{colour}">{escape(formatting.standing(record))}</span></div>'
        f'<progress max="1" value="{record["progress"]:.4f}" style="width:{3 * WIDTH}px">'
        f"</progress><div>{told}</div>{_curves(standing, colour)}"
        f'<div style="color:#b7791f">{escape(trouble)}</div>'
    )


def _curves(standing: Standing, colour: str) -> str:
    pictures = [
        _curve(title, standing.curves.get(name, []), colour)
        for title, name in formatting.FIGURES
    ]
    return f'<div style="display:flex;gap:12px">{"".join(pictures)}</div>'


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
