"""The command-line application, and how commands report errors."""

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
"""The default of JAX_COMPILATION_CACHE_DIR, the folder of compiled programs."""


def _tell_version(asked: bool) -> None:
    if asked:
        print(VERSION)
        raise typer.Exit


@app.callback()
def main(
    version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_tell_version, is_eager=True, help="Print the version."
        ),
    ] = False,
) -> None:
    """Options of the program itself."""


def fail(message: str) -> NoReturn:
    """Print an error and exit with status 2."""
    console.print(message, style="red", markup=False, highlight=False, soft_wrap=True)
    sys.exit(2)
