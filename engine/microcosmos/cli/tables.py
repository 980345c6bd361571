"""Tables for people, of what others have written, too."""

from collections.abc import Iterable, Sequence
from typing import Any

from rich.table import Column, Table
from rich.text import Text

from .remote import stdout


def shown(names: Sequence[str], rows: Iterable[Sequence[Any]]) -> None:
    """A table on standard output; brackets in names and titles are no markup.

    The first column is what people copy: it is never broken.
    """
    heads = [Column(_cell(name), no_wrap=not place) for place, name in enumerate(names)]
    table = Table(*heads, box=None, pad_edge=False)
    for row in rows:
        table.add_row(*map(_cell, row))
    stdout().print(table)


def _cell(value: Any) -> Text:
    return value if isinstance(value, Text) else Text("" if value is None else str(value))
