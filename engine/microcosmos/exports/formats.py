"""Formats of exports, and the files of runs in each."""

import io
import zipfile
from collections.abc import Callable, Mapping, Sequence
from enum import StrEnum

from ..archive.quantities import Real
from . import arrow, births, tables
from .citation import Publication
from .crate import Extra, crate
from .dataset import netcdf, of_run
from .run_file import RunFile

Tell = Callable[[str], None]
"""Called with the name of each file before it is made."""


class Format(StrEnum):
    """What other programs read."""

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
    if form in arrow.WRITERS:
        return _tables(runs, form, tell, real)
    found: dict[str, bytes] = {}
    for run in runs:
        folder = f"{run.name}/" if len(runs) > 1 else ""
        tell(f"{run.name}: {form}")
        if form is Format.ro_crate:
            made = crate(run, publication, (extra or {}).get(run.name))
        else:
            name = "archive" if form is Format.netcdf else "phylogeny"
            made = {f"{name}.{ENDINGS[form]}": single(run, form, real)}
        found |= {f"{folder}{name}": data for name, data in made.items()}
    return found


def refuse_without_columns(form: Format) -> None:
    """Raise `ValueError` for a format without columns in SI units."""
    if form not in WITH_SI:
        known = ", ".join(WITH_SI)
        raise ValueError(
            f"`length` and `period` need one of the formats {known}; got {str(form)!r}"
        )


def _tables(
    runs: Sequence[RunFile], form: Format, tell: Tell, real: Real | None
) -> dict[str, bytes]:
    found: dict[str, bytes] = {}
    for name in tables.names(list(runs)):
        tell(f"{name}.{form}")
        found[f"{name}.{form}"] = arrow.WRITERS[form](arrow.of_runs(runs, name, real))
    return found


def single(run: RunFile, form: Format, real: Real | None = None) -> bytes:
    """Return the one file of a run in a format of `ENDINGS`."""
    if form is Format.netcdf:
        return netcdf(of_run(run, real))
    return births.written(run, ENDINGS[form])


def zipped(found: Mapping[str, bytes], folder: str) -> bytes:
    """Return files as a ZIP with one folder; the same files give the same bytes."""
    whole = io.BytesIO()
    with zipfile.ZipFile(whole, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in found.items():
            about = zipfile.ZipInfo(f"{folder}/{name}")
            about.compress_type, about.external_attr = zipfile.ZIP_DEFLATED, 0o644 << 16
            archive.writestr(about, data)
    return whole.getvalue()
