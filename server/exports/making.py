"""Make the files of an export from a run's checkpoint and the database."""

import json
from collections.abc import Sequence

from sqlalchemy.orm import Session

from microcosmos.archive import choices as choices_file
from microcosmos.archive.quantities import Real
from microcosmos.exports import births as file_births
from microcosmos.exports.citation import Publication
from microcosmos.exports.crate import Extra, File
from microcosmos.exports.formats import ENDINGS, Format, files, single, zipped
from microcosmos.exports.readme import CHOICES
from microcosmos.exports.run_file import RunFile, hexes

from ..choices import choosing
from ..creatures import initial
from ..phylogenies import births, trees
from ..services.services import Services
from ..tables import Run

TREES = {
    Format.alife: ("csv",),
    Format.newick: ("nwk",),
    Format.ro_crate: ("csv", "nwk"),
}
"""Endings of the phylogenies that a format needs."""


def name_of(run: Run) -> str:
    return f"{run.experiment}-{str(run.id)[:8]}"


def make(
    services: Services, run: Run, path: str, form: Format, real: Real | None = None
) -> bytes:
    """Return the one file of a run in a format, or a ZIP of several.

    `real` quantities add columns in SI units. Raises `ValueError` for a run that lacks what the
    format needs.
    """
    data = services.artifacts.read(path)
    with services.sessions.read() as session:
        file = RunFile(name_of(run), data, _trees(session, run, TREES.get(form, ())))
        extra = _extra(session, run, file) if form is Format.ro_crate else {}
    if form in ENDINGS:
        return single(file, form, real)
    publication = Publication(title=run.name or "")
    found = files([file], form, publication, {file.name: extra}, real=real)
    return zipped(found, f"{file.name}-{form}")


def _trees(session: Session, run: Run, endings: Sequence[str]) -> dict[str, bytes]:
    """Return phylogenies with the ancestors in earlier runs."""
    if not endings:
        return {}
    tree = trees.of_run(session, run, births.ancestors_of_run(session, run))
    return {ending: file_births.FORMS[ending](tree).encode() for ending in endings}


def _extra(session: Session, run: Run, file: RunFile) -> Extra:
    """Return the best creature, and the creatures that people chose, if there are any."""
    found: dict[str, File] = {}
    archive = file.archive()
    if len(archive["fitness"]):
        best = hexes(archive["creature"])[int(archive["fitness"].argmax())]
        for one in initial.files(session, [best]):
            about = "the best creature, for `microcosmos replay`"
            found["best.json"] = File(json.dumps(one, indent=1).encode(), about)
    counted = choosing.counted(session, run)
    rows = [(row.generation, row.creature) for row in counted if row.generation]
    if rows:
        creatures = initial.files(session, sorted({name for _, name in rows}))
        document = json.dumps(choices_file.document(rows, creatures), indent=1)
        about = "creatures that people chose, for `microcosmos evolve --choices`"
        found[CHOICES] = File(document.encode(), about)
    return found
