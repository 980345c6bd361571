"""The application that the commands belong to, and how they talk."""

import sys
from pathlib import Path
from typing import Annotated, NoReturn

import typer
from rich.console import Console

from ..version import VERSION

app = typer.Typer(
    help="Evolve swimming creatures, on this machine or on a server.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
)
console = Console(stderr=True)

CACHE = Path.home() / ".cache" / "microcosmos"
"""Where compiled programs are kept, unless JAX_COMPILATION_CACHE_DIR says otherwise."""


def _tell_version(asked: bool) -> None:
    if asked:
        print(VERSION)
        raise typer.Exit


@app.callback()
def main(
    version: Annotated[
        bool,
        typer.Option("--version", callback=_tell_version, is_eager=True, help="Tell it."),
    ] = False,
) -> None:
    """What belongs to no command."""


def fail(message: str) -> NoReturn:
    """Say what is wrong and end."""
    console.print(message, style="red", markup=False, highlight=False, soft_wrap=True)
    sys.exit(2)
