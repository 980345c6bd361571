"""Export runs of a server: their files, phylogenies across runs, and what repeats them."""

import json
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from ..exports.crate import File
from ..exports.formats import ENDINGS, Format
from ..exports.readme import CHOICES
from ..exports.run_file import RunFile
from .errors import NotFound

if TYPE_CHECKING:
    from .run import Run

TREES = {
    Format.alife: (ENDINGS[Format.alife],),
    Format.newick: (ENDINGS[Format.newick],),
    Format.ro_crate: (ENDINGS[Format.alife], ENDINGS[Format.newick]),
}
"""Endings of the phylogenies that a format needs."""


def opened(run: "Run", form: Format, *, quiet: bool = False) -> RunFile:
    """Download a run's last checkpoint, and the phylogenies that the format needs."""
    with TemporaryDirectory() as folder:
        path = run.pull(folder, quiet=quiet)
        name, data = path.stem, path.read_bytes()
    found = RunFile(name, data)
    endings = TREES.get(form, ()) if found.has_archive else ()
    trees = {ending: run.phylogeny(ending).encode() for ending in endings}
    return RunFile(name, data, trees)


def extra(run: "Run") -> dict[str, File]:
    """Return the best creature, and the creatures that people chose, if there are any."""
    found: dict[str, File] = {}
    archive = run.archive()
    if len(archive):
        about = "the best creature, for `microcosmos replay`"
        found["best.json"] = File(_json(archive.best().file), about)
    try:
        chosen: dict[str, Any] = run.exported_choices()
    except NotFound:
        return found
    about = "creatures that people chose, for `microcosmos evolve --choices`"
    return found | {CHOICES: File(_json(chosen), about)}


def _json(document: Any) -> bytes:
    return json.dumps(document, indent=1).encode()


def export(run: "Run", form: str, to: str | Path | None, **options: Any) -> list[Path]:
    """Write a run in a format; see `Run.export`."""
    from ..exports.local import export as write

    chosen = Format(form)
    quiet = options.pop("quiet", False)
    found = opened(run, chosen, quiet=quiet)
    more = {found.name: extra(run)} if chosen is Format.ro_crate else None
    return write([found], form, to, extra=more, **options)
