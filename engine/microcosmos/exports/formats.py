"""Formats of exports, and the files of runs in each, in a folder or a ZIP file."""

import errno
import io
import os
import zipfile
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from enum import StrEnum
from pathlib import Path

from ..archive.atomic import folder_part, remove_left, sync_folder, write_whole
from ..archive.creature import parse
from ..archive.file_names import beside, stem
from ..invalid import InvalidField
from ..quantities.real import Real
from . import arrow, run_file, tables
from .crate import Extra, File, Publication, crate
from .dataset import netcdf, of_run
from .run_file import RunFile

Tell = Callable[[str], None]
"""Called with the name of each file before it is made."""


class Format(StrEnum):
    """The formats of exports."""

    parquet = "parquet"
    arrow = "arrow"
    alife = "alife"
    newick = "newick"
    netcdf = "netcdf"
    ro_crate = "ro-crate"


ENDINGS = {Format.alife: "csv", Format.newick: "nwk", Format.netcdf: "nc"}
"""Endings of formats with one file for each run."""
WITH_SI = (Format.parquet, Format.arrow, Format.netcdf)
"""Formats whose columns may be in SI units too."""
MEDIA_TYPES = {
    Format.alife: "text/csv",
    Format.newick: "text/plain",
    Format.netcdf: "application/x-netcdf",
}


def silent(file: str) -> None:
    """Ignore the progress."""


def files(
    runs: Sequence[RunFile],
    form: Format,
    publication: Publication | None = None,
    extra: Mapping[str, Extra] | None = None,
    tell: Tell = silent,
    real: Real | None = None,
) -> dict[str, bytes]:
    """Return the files of runs in a format, by their paths.

    Tables hold all runs; other formats have a folder for each of several runs. `extra` are
    further files of a RO-Crate by the name of its run. `real` quantities add columns in SI
    units to formats of `WITH_SI`. Raises `ValueError` where two runs have one name, a run lacks
    what the format needs, or a format has no columns, and `ImportError` without the libraries.
    """
    if real is not None:
        refuse_without_columns(form)
    names = [run.name for run in runs]
    if len({*names}) < len(names):
        twice = next(name for name in names if names.count(name) > 1)
        raise ValueError(f"runs need different names; got {twice!r} twice")
    # A folder of such a name would be that of another run, or lie outside the export's.
    if wrong := {".", ".."}.intersection(names):
        raise InvalidField("name", f"of a run must name a folder; got {wrong.pop()!r}")
    if form in arrow.WRITERS:
        return _tables(runs, form, tell, real)
    written: dict[str, bytes] = {}
    for run in runs:
        folder = f"{run.name}/" if len(runs) > 1 else ""
        tell(f"{run.name}: {form}")
        if form is Format.ro_crate:
            made = crate(run, publication, (extra or {}).get(run.name))
        else:
            name = "archive" if form is Format.netcdf else "phylogeny"
            made = {f"{name}.{ENDINGS[form]}": single(run, form, real)}
        written |= {f"{folder}{name}": data for name, data in made.items()}
    return written


def refuse_without_columns(form: Format) -> None:
    """Raise `ValueError` for a format without columns in SI units."""
    if form not in WITH_SI:
        known = ", ".join(WITH_SI)
        raise InvalidField(
            "length", f"and `period` need one of the formats {known}; got {str(form)!r}"
        )


def _tables(
    runs: Sequence[RunFile], form: Format, tell: Tell, real: Real | None
) -> dict[str, bytes]:
    written: dict[str, bytes] = {}
    for name in tables.names(list(runs)):
        tell(f"{name}.{form}")
        written[f"{name}.{form}"] = arrow.WRITERS[form](arrow.of_runs(runs, name, real))
    return written


def single(run: RunFile, form: Format, real: Real | None = None) -> bytes:
    """Return the one file of a run in a format of `ENDINGS`."""
    if form is Format.netcdf:
        return netcdf(of_run(run, real))
    return run_file.written(run, ENDINGS[form])


def zipped(files: Mapping[str, bytes], folder: str) -> bytes:
    """Return files as a ZIP with one folder; the same files give the same bytes."""
    whole = io.BytesIO()
    with zipfile.ZipFile(whole, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            # Without a date, the same files give the same bytes.
            about = zipfile.ZipInfo(f"{folder}/{name}")
            # Python would let the owner alone read them.
            about.compress_type, about.external_attr = zipfile.ZIP_DEFLATED, 0o644 << 16
            archive.writestr(about, data)
    return whole.getvalue()


def export(
    runs: Sequence[str | os.PathLike | RunFile],
    form: str,
    to: str | os.PathLike | None = None,
    *,
    publication: Publication | None = None,
    extra: Mapping[str, Extra] | None = None,
    zip: bool = False,
    tell: Tell = silent,
    length: str | None = None,
    period: str | None = None,
) -> list[Path]:
    """Write runs in a format into a new folder, or a ZIP file, and return the files.

    `runs` are paths of archive files. `form` is `parquet`, `arrow`, `alife`, `newick`,
    `netcdf` or `ro-crate`. Without `to` the folder is called after the run and the format.
    `publication` and `extra` are for a RO-Crate. The real `length` of a body, such as `1mm`,
    and `period` of a stroke, such as `0.5s`, add columns in SI units to `parquet`, `arrow` and
    `netcdf`. Raises `FileExistsError` where something would be overwritten,
    `ValueError` for a run that lacks what the format needs and for a length or period without
    a known unit, and `ImportError` without the libraries of `microcosmos[exports]`.
    """
    chosen, real = Format(form), Real.of(length, period)
    if not runs:
        raise InvalidField("runs", "must have at least one run; got none")
    opened = [one if isinstance(one, RunFile) else of_path(Path(one)) for one in runs]
    folder = Path(to) if to is not None else default_folder(opened, chosen)
    if zip and folder.name in ("", ".."):
        raise InvalidField("to", f"must name the ZIP file; got {folder}")
    if zip and folder.suffix.lower() == ".zip":
        folder = folder.with_suffix("")  # People name the file; the folder lies in it.
    target = folder.with_name(f"{folder.name}.zip") if zip else folder
    # Before minutes of work that could not be written.
    refuse_existing(target)
    contents = files(opened, chosen, publication, extra, tell, real)
    if not zip:
        return write(contents, folder)
    target.parent.mkdir(parents=True, exist_ok=True)
    write_whole(target, zipped(contents, folder.name))
    return [target]


def of_path(path: Path) -> RunFile:
    """Open an archive file; its name is that of the run."""
    return RunFile(stem(path), path.read_bytes())


def default_folder(runs: Sequence[RunFile], form: Format) -> Path:
    name = runs[0].name if len(runs) == 1 else f"{len(runs)}-runs"
    return Path(f"{name}-{form}")


def best_creature(path: Path, run: RunFile) -> dict[str, File]:
    """Return the best creature that `evolve` has written beside an archive file.

    A file of another run, or of an earlier checkpoint, is none.
    """
    fittest = run_file.fittest(run)
    with suppress(FileNotFoundError, ValueError):
        data = beside(path, ".best.json").read_bytes()
        if parse(data)["sha256"] in fittest:
            about = "the best creature, for `microcosmos replay`"
            return {"best.json": File(data, about)}
    return {}


def refuse_existing(folder: Path) -> None:
    """Raise `FileExistsError` where a folder has content, or is a file.

    What a killed export has left there is removed.
    """
    for one in _places(folder):
        remove_left(one)
    if folder.is_dir() and not any(folder.iterdir()):
        return
    if folder.exists() or folder.is_symlink():
        raise FileExistsError(
            f"--to needs a new or empty folder, because nothing is overwritten; got {folder}"
        )


def _places(folder: Path) -> tuple[Path, Path]:
    """Return the folder beside which files of a new folder are written, and of an empty one.

    An empty folder stays, and its files are written in it: it may be a link, another disk, or
    that of the shell.
    """
    return folder, folder / "export"


def write(files: Mapping[str, bytes], folder: Path) -> list[Path]:
    """Write files into a new or empty folder, and return their paths.

    They are written beside it first, so that a failure leaves no half of them. Raises
    `FileExistsError` for a folder with content, and `OSError`.
    """
    refuse_existing(folder)
    empty, (beside, inside) = folder.is_dir(), _places(folder)
    place = inside if empty else beside
    place.parent.mkdir(parents=True, exist_ok=True)
    try:
        with folder_part(place) as part:
            for name, data in files.items():
                path = part / name
                path.parent.mkdir(parents=True, exist_ok=True)
                write_whole(path, data)
            if empty:
                for one in [*part.iterdir()]:
                    one.replace(folder / one.name)
                part.rmdir()
            else:
                part.replace(folder)
    except OSError as error:
        if error.errno == errno.ENOTEMPTY:  # Another export into it was quicker.
            refuse_existing(folder)
        raise
    sync_folder(place.parent)
    return [folder / name for name in files]
