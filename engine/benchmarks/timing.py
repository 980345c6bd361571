"""Wall times of programs, tables, and a check for optional libraries."""

import importlib.util
import statistics
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import jax
from rich.console import Console
from rich.table import Table


def seconds(program: Callable, *arguments: Any) -> float:
    """Return the wall time of one call."""
    start = time.perf_counter()
    jax.block_until_ready(program(*arguments))
    return time.perf_counter() - start


def interleaved(programs: Mapping[str, Callable], repeats: int) -> dict[str, list[float]]:
    """Return the wall times of compiled programs that take turns."""
    rounds = [{name: seconds(p) for name, p in programs.items()} for _ in range(repeats)]
    return {name: [one[name] for one in rounds] for name in programs}


def median_range(values: Sequence[float]) -> str:
    return f"{statistics.median(values):.1f} ({min(values):.1f}–{max(values):.1f})"


def print_table(title: str, columns: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
    table = Table(*columns, title=title)
    for row in rows:
        table.add_row(*row)
    Console(width=110).print(table)


def installed(package: str) -> bool:
    """Check that a library is installed; print how to install it if not."""
    if importlib.util.find_spec(package):
        return True
    print(f"({package} is not installed; `make peers` installs it)")
    return False
