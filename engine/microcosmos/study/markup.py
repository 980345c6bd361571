"""HTML of a report: tables whose every number links to the runs that it comes from."""

import base64
import re
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

STYLE = """
:root { color-scheme: light; --ink: #14222b; --quiet: #5a6b76; --line: #dfe6ea;
  --accent: #0b6b62 }
* { box-sizing: border-box }
body { margin: 0 auto; max-width: 60rem; padding: 2rem 1.25rem 4rem; color: var(--ink);
  background: #fff;
  font: .9375rem/1.55 system-ui, "Segoe UI", Roboto, "DejaVu Sans", sans-serif;
  font-variant-numeric: tabular-nums }
h1 { font-size: 1.7rem; line-height: 1.2; margin: 0 0 .5rem }
h2 { font-size: 1.2rem; margin: 2.5rem 0 .5rem; border-top: 1px solid var(--line);
  padding-top: 1rem }
h3 { font-size: 1rem; margin: 1.5rem 0 .4rem }
p { margin: .5rem 0; max-width: 46rem }
a { color: var(--accent); text-decoration: none }
a:hover { text-decoration: underline }
.quiet, figcaption { color: var(--quiet); font-size: .87rem }
.scroll { overflow-x: auto }
table { border-collapse: collapse; margin: .6rem 0; font-size: .87rem }
th, td { padding: .25rem .7rem .25rem 0; text-align: left; vertical-align: top }
th { font-weight: 600; border-bottom: 1px solid var(--ink); white-space: nowrap }
td { border-bottom: 1px solid var(--line) }
td.n, th.n { text-align: right; white-space: nowrap }
td.n a { color: inherit }
tr:target { background: #e0f0ee }
figure { margin: 1rem 0; break-inside: avoid }
figure img { width: 100%; display: block }
figure.single img { max-width: 30rem }
pre { overflow-x: auto; background: #f6f8f9; padding: .8rem; font-size: .75rem;
  line-height: 1.45; white-space: pre-wrap; overflow-wrap: anywhere }
code { font-family: ui-monospace, Menlo, Consolas, "DejaVu Sans Mono", monospace;
  font-size: .9em }
@page { size: A4; margin: 16mm 15mm }
@media print {
  html { font-size: 9.5pt }
  body { padding: 0; max-width: none; font-size: 1rem }
  p { max-width: none }
  h2, h3 { break-after: avoid }
  tr { break-inside: avoid }
  a { color: inherit }
  .scroll { overflow: visible }
  details { display: none }
  table { font-size: .85rem }
}
"""


@dataclass(frozen=True)
class Number:
    """A number as text, the ids of its runs, and the anchor that lists them."""

    text: str
    runs: tuple[str, ...]
    anchor: str = ""

    def html(self) -> str:
        to = f"run-{self.runs[0]}" if len(self.runs) == 1 else self.anchor
        title = ("run " if len(self.runs) == 1 else "runs ") + ", ".join(self.runs)
        return (
            f'<td class="n"><a href="#{escape(to)}" title="{escape(title)}" '
            f'data-runs="{" ".join(self.runs)}">{escape(self.text)}</a></td>'
        )


@dataclass(frozen=True)
class Link:
    """Text that leads to an anchor of the report."""

    text: str
    anchor: str

    def html(self) -> str:
        return f'<td><a href="#{escape(self.anchor)}">{escape(self.text)}</a></td>'


Cell = Number | Link | str


def table(
    titles: Sequence[str], rows: Sequence[Sequence[Cell]], anchors: Sequence[str] | None = None
) -> str:
    """Return a table; `anchors` are the ids of its rows."""
    first = rows[0] if rows else titles
    head = "".join(
        f"<th{' class=n' if isinstance(cell, Number) else ''}>{escape(title)}</th>"
        for title, cell in zip(titles, first, strict=True)
    )
    named = [f' id="{escape(anchor)}"' for anchor in anchors] if anchors else [""] * len(rows)
    lines = [
        f"<tr{name}>{''.join(_cell(cell) for cell in row)}</tr>"
        for name, row in zip(named, rows, strict=True)
    ]
    body = "\n".join(lines)
    return (
        f'<div class="scroll"><table><thead><tr>{head}</tr></thead>\n'
        f"<tbody>\n{body}\n</tbody></table></div>"
    )


def _cell(cell: Cell) -> str:
    return f"<td>{escape(cell)}</td>" if isinstance(cell, str) else cell.html()


def paragraph(text: str, quiet: bool = False) -> str:
    return f"<p{' class=quiet' if quiet else ''}>{_words(text)}</p>"


def _words(text: str) -> str:
    """Return text with what stands between backquotes as code."""
    return re.sub("`([^`]+)`", r"<code>\1</code>", escape(text))


def heading(text: str, anchor: str = "", level: int = 2) -> str:
    named = f' id="{escape(anchor)}"' if anchor else ""
    return f"<h{level}{named}>{escape(text)}</h{level}>"


def figure(svg: bytes, caption: str, alternative: str, single: bool) -> str:
    """Return a figure whose drawing is part of the page."""
    data = base64.b64encode(svg).decode()
    kind = ' class="single"' if single else ""
    # The report is one file, which needs no network (test_the_page_needs_no_network).
    source = f"data:image/svg+xml;base64,{data}"
    return (
        f'<figure{kind}><img alt="{escape(alternative)}" src="{source}">'
        f"<figcaption>{_words(caption)}</figcaption></figure>"
    )


def page(title: str, body: Sequence[str]) -> str:
    """Return a whole page, which needs no network."""
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(title)}</title>\n<style>{STYLE}</style>\n</head>\n<body>\n"
        + "\n".join(body)
        + "\n</body>\n</html>\n"
    )
