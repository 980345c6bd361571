"""The command `export`: runs as files that other programs read."""

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated

from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn
from typer import Argument, Option

from ..archive.quantities import Real
from ..client import Client
from ..client.exporting import extra, opened
from ..exports import local
from ..exports.citation import Publication
from ..exports.crate import File
from ..exports.formats import Format, Tell, refuse_without_columns
from ..exports.run_file import RunFile
from ..naming import LICENCE
from ..sizes import size
from .app import console, failing
from .remote import RUNS, say, server_command

PICTURE = "archive.png"


@server_command(RUNS, "export")
def export_runs(
    client: Client,
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
    licence: Annotated[str, Option(help="Licence of a RO-Crate, by SPDX.")] = LICENCE,
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
        found = {one.name: (one, more) for one, more in (_open(client, r, form) for r in runs)}
        if len(found) < len(runs):
            raise ValueError(f"RUN... needs different names; got {', '.join(runs)}")
        files = [one for one, _ in found.values()]
        more = {name: extra for name, (_, extra) in found.items()}
        options = {"publication": publication, "extra": more, "zip": zip, "tell": tell}
        written = local.export(files, form, to, length=length, period=period, **options)
    for path in written:
        print(f"{path}  {size(path.stat().st_size)}")
    if form is Format.ro_crate and not author:
        say("No --author is given: add the authors to CITATION.cff before publishing.")


def _open(client: Client, run: str, form: Format) -> tuple[RunFile, dict[str, File]]:
    """Read a file if there is one, else a run on the server."""
    path, whole = Path(run), form is Format.ro_crate
    if path.is_file():
        with failing(path):
            file = local.of_path(path)
            file.attributes  # noqa: B018 It refuses other files.
        more = local.best_creature(path) if whole else {}
    elif path.suffix:
        raise ValueError(
            f"RUN must be an archive file or the id of a run; no file {run} exists"
        )
    else:
        one = client.run(run)
        file = opened(one, form)
        more = extra(one) if whole else {}
    return file, more | (_picture(file) if whole else {})


def _picture(run: RunFile) -> dict[str, File]:
    """Return the map of an archive with elites, if matplotlib is installed."""
    from ..viz.figures import drawing

    if not len(run.archive()["cell"]):
        return {}
    with TemporaryDirectory() as folder, suppress(ImportError):
        path, out = Path(folder, "run.h5"), Path(folder, PICTURE)
        path.write_bytes(run.data)
        drawing.archive(path, out, drawing.Print(width="double"), None, "fitness")
        return {PICTURE: File(out.read_bytes(), "the map of the archive")}
    return {}


@contextmanager
def _progress(count: int) -> Iterator[Tell]:
    """Draw a progress bar if standard error is a terminal."""
    if not console.is_terminal:
        yield lambda file: None
        return
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn())
    with Progress(*columns, console=console, transient=True) as progress:
        bar = progress.add_task("reading", total=None)

        def tell(file: str) -> None:
            progress.update(bar, description=file, advance=1)

        yield tell
