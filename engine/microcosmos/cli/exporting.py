"""The command `export`: runs as files that other programs read."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Annotated

from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn
from typer import Argument, Option

from ..client import Client
from ..client.formatting import visible
from ..client.run import extra, opened
from ..exports import formats
from ..exports.crate import File, Publication
from ..exports.formats import Format, Tell, refuse_without_columns
from ..exports.run_file import RunFile
from ..quantities.real import Real
from ..sizes import size
from ..viz.figures import drawing
from .app import console, failing, say
from .remote import RUNS, connecting, server_command

PICTURE = "archive.png"


@server_command(RUNS, "export", make=connecting)
def export_runs(
    connect: Callable[[], Client],
    runs: Annotated[
        list[str],
        Argument(metavar="RUN...", help="Archive files, or ids of runs on a server."),
    ],
    form: Annotated[Format, Option("--as", help="Format of the files.")],
    to: Annotated[
        Path | None,
        Option(help="A new folder for the files; default: named after the run and format."),
    ] = None,
    zip: Annotated[bool, Option("--zip", help="Write FOLDER.zip instead of FOLDER.")] = False,
    title: Annotated[str, Option(help="Title of a RO-Crate.")] = "",
    author: Annotated[
        list[str] | None,
        Option(metavar='"FAMILY, GIVEN"', help="Author of a RO-Crate; repeatable."),
    ] = None,
    licence: Annotated[
        str, Option(help="Licence of a RO-Crate, by SPDX; default: the file's.")
    ] = "",
    length: Annotated[
        str | None,
        Option(help="Real length of a body, such as 1mm, for columns in SI units."),
    ] = None,
    period: Annotated[
        str | None, Option(help="Real period of a stroke, such as 0.5s; with --length.")
    ] = None,
) -> None:
    """Export runs: as Parquet, Arrow, ALife standard, Newick, netCDF or RO-Crate."""
    publication = Publication(title, author or (), licence)
    with failing(), _progress(len(runs)) as tell:
        if Real.of(length, period) is not None:
            refuse_without_columns(form)  # Before anything is read.
        opened = {
            one.name: (one, more) for one, more in (_open(connect, r, form) for r in runs)
        }
        if len(opened) < len(runs):
            raise ValueError(f"RUN... needs different names; got {', '.join(runs)}")
        files = [one for one, _ in opened.values()]
        more = {name: extra for name, (_, extra) in opened.items()}
        options = {"publication": publication, "extra": more, "zip": zip, "tell": tell}
        written = formats.export(files, form, to, length=length, period=period, **options)
    for path in written:
        print(f"{path}  {size(path.stat().st_size)}")
    if form is Format.ro_crate and not author:
        say("No --author is given: add the authors to CITATION.cff before publishing.")


def _open(
    connect: Callable[[], Client], run: str, form: Format
) -> tuple[RunFile, dict[str, File]]:
    """Read a file if there is one, else a run on the server."""
    path, whole = Path(run), form is Format.ro_crate
    # A file first: its name may look like the beginning of an id.
    if path.is_file():
        with failing(path):
            file = formats.of_path(path)
            file.attributes  # noqa: B018 It refuses other files.
        more = formats.best_creature(path, file) if whole else {}
    elif path.suffix:
        raise ValueError(
            f"RUN must be an archive file or the id of a run; no file {run} exists"
        )
    else:
        one = connect().run(run)
        file = opened(one, form)
        more = extra(one, file) if whole else {}
    return file, more | (_picture(file) if whole else {})


def _picture(run: RunFile) -> dict[str, File]:
    """Return the map of an archive with elites, if matplotlib is installed."""
    # A crate without matplotlib lacks the picture alone.
    with suppress(ImportError):
        if len(run.archive()["cell"]):
            drawn = drawing.picture(run.data, drawing.Print(width="double"))
            return {PICTURE: File(drawn, "the map of the archive")}
    return {}


@contextmanager
def _progress(count: int) -> Iterator[Tell]:
    """Draw a progress bar if standard error is a terminal."""
    if not console.is_terminal:
        yield lambda file: None
        return
    columns = (
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        MofNCompleteColumn(),
    )
    with Progress(*columns, console=console, transient=True) as progress:
        bar = progress.add_task("reading", total=None)

        def tell(file: str) -> None:
            progress.update(bar, description=visible(file), advance=1)

        yield tell
