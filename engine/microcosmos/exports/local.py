"""Export runs to a folder or a ZIP file."""

import os
from collections.abc import Mapping, Sequence
from pathlib import Path

from ..archive.atomic import write_whole
from ..archive.beside import beside, stem
from ..archive.quantities import Real
from .citation import Publication
from .crate import Extra, File
from .formats import Format, Tell, files, silent, zipped
from .run_file import RunFile
from .writing import refuse_existing, write


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
    `netcdf`. Raises `FileExistsError` where something would
    be overwritten, `ValueError` for a run that lacks what the format needs and for a length or
    period without a known unit, and `ImportError`
    without the libraries of `microcosmos[exports]`.
    """
    chosen, real = Format(form), Real.of(length, period)
    opened = [one if isinstance(one, RunFile) else of_path(Path(one)) for one in runs]
    folder = Path(to) if to is not None else default_folder(opened, chosen)
    target = folder.with_name(f"{folder.name}.zip") if zip else folder
    refuse_existing(target)
    found = files(opened, chosen, publication, extra, tell, real)
    if not zip:
        return write(found, folder)
    target.parent.mkdir(parents=True, exist_ok=True)
    write_whole(target, zipped(found, folder.name))
    return [target]


def of_path(path: Path) -> RunFile:
    """Open an archive file; its name is that of the run."""
    return RunFile(stem(path), path.read_bytes())


def default_folder(runs: Sequence[RunFile], form: Format) -> Path:
    name = runs[0].name if len(runs) == 1 else f"{len(runs)}-runs"
    return Path(f"{name}-{form}")


def best_creature(path: Path) -> dict[str, File]:
    """Return the best creature that `evolve` has written beside an archive file."""
    best = beside(path, ".best.json")
    if not best.is_file():
        return {}
    return {"best.json": File(best.read_bytes(), "the best creature, for `microcosmos replay`")}
