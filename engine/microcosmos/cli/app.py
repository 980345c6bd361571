"""The application that the commands belong to, and how they talk."""

import sys
from pathlib import Path
from typing import NoReturn

import typer
from rich.console import Console

app = typer.Typer(
    help="Evolve swimming creatures, on this machine or on a server.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
)
console = Console(stderr=True)

CACHE = Path.home() / ".cache" / "microcosmos"
"""Where compiled programs are kept, unless JAX_COMPILATION_CACHE_DIR says otherwise."""


def fail(message: str) -> NoReturn:
    """Say what is wrong and end."""
    console.print(message, style="red", markup=False)
    sys.exit(2)
