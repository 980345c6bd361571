"""The command-line application, shared options, and how commands report errors."""

import sys
from collections.abc import Callable, Collection, Iterator
from contextlib import AbstractContextManager, contextmanager
from functools import wraps
from inspect import Signature, signature
from pathlib import Path
from typing import Annotated, Any, NoReturn

import typer
from pydantic import ValidationError
from rich.console import Console
from typer import Argument, Option

from ..client import ServerError
from ..spec import field_path
from ..version import VERSION

app = typer.Typer(
    help="Evolve swimming creatures, on this machine or on a server.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
)
console = Console(stderr=True)

CACHE = Path.home() / ".cache" / "microcosmos"
"""The default of JAX_COMPILATION_CACHE_DIR, the folder of compiled programs."""

CreaturePath = Annotated[
    Path, Argument(metavar="FILE", exists=True, dir_okay=False, help="A creature file.")
]
Set = Annotated[
    list[str] | None,
    Option(
        "--set",
        metavar="FIELD=VALUE",
        help="Set a field, such as world.viscosity=0.1; repeatable.",
    ),
]
OtherDevice = Annotated[
    bool, Option(help="Continue a run that another kind of device started.")
]


def _print_version(asked: bool) -> None:
    if asked:
        print(VERSION)
        raise typer.Exit


@app.callback()
def main(
    version: Annotated[
        bool,
        Option("--version", callback=_print_version, is_eager=True, help="Print the version."),
    ] = False,
) -> None:
    """Options of the program itself."""


def with_options(
    make: Callable[..., AbstractContextManager[Any]],
    omit: Collection[str] = (),
    **defaults: Any,
) -> Callable[[Callable[..., Any]], Callable[..., None]]:
    """Add the options of `make` to a command; its result becomes the first argument."""
    added = [
        one.replace(default=defaults.get(one.name, one.default))
        for one in signature(make).parameters.values()
        if one.name not in omit
    ]

    def decorate(command: Callable[..., Any]) -> Callable[..., None]:
        @wraps(command)
        def run(**values: Any) -> None:
            with make(**{one.name: values.pop(one.name) for one in added}) as made:
                command(made, **values)

        own = list(signature(command).parameters.values())[1:]
        run.__signature__ = Signature([*own, *added])  # pyright: ignore[reportAttributeAccessIssue]
        return run

    return decorate


def fail(message: str) -> NoReturn:
    """Print an error and exit with status 2."""
    console.print(message, style="red", markup=False, highlight=False, soft_wrap=True)
    sys.exit(2)


@contextmanager
def failing(subject: str | Path = "") -> Iterator[None]:
    """Report errors about a file or an option, and exit with status 2."""
    prefix = f"{subject}: " if subject else ""
    try:
        yield
    except ValidationError as error:
        fail("\n".join(f"{prefix}{message(found)}" for found in error.errors()))
    except (ValueError, ImportError, OSError, ServerError) as error:
        fail(f"{prefix}{error}")


def message(error: Any) -> str:
    """Return a validation error on one line: the field, what it needs, and what came."""
    needed = str(error["msg"]).removeprefix("Value error, ")
    got = "" if "got" in needed else f"; got {error['input']!r:.80}"
    return f"{field_path(error['loc'])}: {needed}{got}"
