"""Plug-ins and the device, for the commands that compute."""

from pathlib import Path
from typing import Annotated

from typer import Option

from .. import plugins
from .app import CACHE, app, console, failing

Modules = Annotated[
    list[Path] | None,
    Option("--module", help="A Python file with plug-ins, see docs/plugins.md; repeatable."),
]


def load_modules(files: list[Path] | None) -> None:
    """Load the plug-ins of installed packages and of these files; fail if a file is faulty."""
    for failed in plugins.load_all(()):
        console.print(f"{failed.module} is not loaded: {failed.reason}", style="yellow")
    with failing("--module"):
        for file in files or ():
            plugins.load(file)


def prepare_engine(files: list[Path] | None) -> None:
    """Load plug-ins and JAX."""
    load_modules(files)
    from ..device import prepare

    prepare(cache=CACHE)


@app.command("plugins")
def list_plugins(module: Modules = None) -> None:
    """List plug-ins: names, titles, versions."""
    load_modules(module)
    for plugin in plugins.loaded():
        one = plugin.declaration
        unit = f" in {one.unit}" if one.unit else ""
        print(
            f"{one.name}  {one.kind}  {one.title}{unit}  ({one.source[:12]}, {plugin.location})"
        )
