"""A run on a server, and its export."""

import json
from collections.abc import Mapping, Sequence
from functools import cached_property
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Self
from uuid import uuid4

from ..exports.crate import CHOICES, File
from ..exports.formats import ENDINGS, Format, export
from ..exports.run_file import RunFile, hexes
from ..invalid import InvalidField
from . import arguments, files, polling
from .archive import Archive
from .columns import Columns, Table, lineage
from .creature import Creature
from .errors import RUN, NotFound, Refused
from .record import Field, Record
from .sharing import Share, publish
from .views import live, watch


class Run(Record):
    """A copy of the server's record; `refresh` reads it again."""

    NOUN, KINDS = "runs", RUN
    experiment = Field[str]()
    status = Field[str]()
    """queued, running, paused, finished, failed or cancelled."""
    spec = Field[dict[str, Any]]()
    progress = Field[float]()
    generation = Field[int]()
    generations = Field[int]()
    qd_score = Field[float | None]()
    coverage = Field[float | None]()
    best = Field[float | None]()
    """The best fitness; `archive().best()` is its creature."""
    corrected_qd_score = Field[float | None]()
    """After the last reevaluation of the elites; None without."""
    corrected_coverage = Field[float | None]()
    hit_rate = Field[float | None]()
    error = Field[str | None]()

    def __repr__(self) -> str:
        name = f" {self.name!r}" if self.name else ""
        done = f"{self.generation} of {self.generations} generations"
        return f"<Run {self.id[:8]}{name}: {self.experiment}, {self.status}, {done}>"

    @property
    def ended(self) -> bool:
        return self.status in polling.ENDED

    def wait(self, timeout: float | None = None) -> str:
        """Return the status at the end; raise `TimeoutError` after `timeout` seconds."""
        self.record = polling.wait(self._connection, self.id, timeout)
        return self.status

    def watch(self) -> str:
        """Show the run until it ends, and return its status; Ctrl-C ends only the watching."""
        status = watch(polling.follow(self._connection, self.id), f"Run {self.id}")
        self.refresh()
        return status

    def live(self, **options: Any) -> Any:
        """Return a map of its archive for a notebook, which fills while the run goes on.

        `options` are those of `microcosmos.widgets.ArchiveMap`. The notebook stays free: a
        thread follows the run until it ends. Raise `ImportError` without
        `microcosmos[notebook]`, and `ValueError` for a run without an archive.
        """
        return live(self, self._connection, **options)

    def extend(self, generations: int) -> Self:
        """Add generations."""
        more = arguments.whole("generations", generations)
        return self._ask("extend", {"generations": more})

    def fork(
        self,
        *,
        creatures: Sequence[str | Creature] | None = None,
        cells: Sequence[int] | None = None,
        region: Mapping[str, Sequence[float]] | None = None,
        generation: int | None = None,
        spec: Mapping[str, Any] | None = None,
        name: str | None = None,
    ) -> "Run":
        """Start a new run from elites of this one: from some, from a region's, or from all.

        `region` gives low and high along axes by name. `spec` holds the fields that differ;
        None clears a field that may be empty, and resets another to its default.
        """
        axes = {} if region is None else arguments.fields("region", region)
        ends = {axis: arguments.ends(f"region.{axis}", pair) for axis, pair in axes.items()}
        given = {
            "creatures": None if creatures is None else arguments.names("creatures", creatures),
            "cells": None if cells is None else arguments.wholes("cells", cells),
            "region": None if region is None else ends,
        }
        chosen = {kind: one for kind, one in given.items() if one is not None}
        if len(chosen) > 1:
            got = ", ".join(chosen)
            raise ValueError(f"fork needs one of creatures, cells, region; got {got}")
        document = {"from": chosen or {"archive": True}, "spec": {}}
        document |= {} if spec is None else {"spec": arguments.fields("spec", spec)}
        document |= {} if generation is None else {"generation": generation}
        document |= {"name": name} if name else {}
        path, key = f"{self._path}/fork", str(uuid4())
        return Run(self._connection, self._connection.send("POST", path, document, key=key))

    def choose(self, creatures: Sequence[str | Creature]) -> Columns:
        """Let a part of the next generations descend from these creatures of its archive."""
        sent = {"creatures": arguments.names("creatures", creatures)}
        return _choices(self._connection.send("POST", f"{self._path}/choices", sent))

    def choices(self) -> Columns:
        """Return the chosen creatures: `creature`, and the `generation` from which each counts,
        None until that begins."""
        return _choices(self._connection.read(f"{self._path}/choices"))

    def exported_choices(self) -> dict[str, Any]:
        """Return the file with which `microcosmos evolve SPEC --choices FILE` repeats it."""
        return self._connection.read(f"{self._path}/choices.json")

    def delete(self) -> Self:
        """Move it to the bin; `restore` brings it back within a day."""
        try:
            self.record = self._checked(self._connection.send("DELETE", self._path))
        except NotFound:
            # It is in the bin already if the answer to a first request was lost.
            if not self.refresh().record.get("deleted_at"):
                raise
        return self

    def change(
        self,
        *,
        name: str | None = None,
        tags: Sequence[str] | None = None,
        note: str | None = None,
    ) -> Self:
        """Change its name, tags or note; None leaves them."""
        listed = None if tags is None else arguments.several("tags", tags)
        given = {"name": name, "tags": listed, "note": note}
        given = {field: value for field, value in given.items() if value is not None}
        self.record = self._checked(self._connection.send("PATCH", self._path, given))
        return self

    def curves(self, points: int | None = None) -> Columns:
        """Return columns by generation: `qd_score`, `coverage`, `best`, and the summary's."""
        columns = self._connection.read(f"{self._path}/generations", points=points)
        curves = {name: column for name, column in columns.items() if name != "summary"}
        return Columns(curves | columns["summary"])

    def archive(self, generation: int | None = None) -> Archive:
        """Return the elites with all measures, now or after a generation."""
        path = f"{self._path}/archive"
        document = self._connection.read(path, generation=generation)
        if names := ",".join(one["name"] for one in document["recorded"]):
            # The generation of the first answer: a running run may have gone on.
            at = document["generation"]
            try:
                document = self._connection.read(path, generation=at, measures=names)
            except Refused as error:
                # A worker that began again at a checkpoint has not reached it any more.
                if generation is None and error.field == "generation":
                    return self.archive()
                raise
        return Archive(self._connection, self.id, document)

    def history(self, measures: Sequence[str] | None = None) -> Columns:
        """Return every elite that ever entered the archive, also those that were replaced:
        `creature`, `cell`, `generation`, `fitness`, and all measures or those that are named.
        """
        path = f"{self._path}/archive"
        if measures is None:
            recorded = self._connection.read(path)["recorded"]
            measures = [one["name"] for one in recorded]
        names = ",".join(arguments.several("measures", measures)) or None
        document = self._connection.read(f"{path}/history", measures=names)
        columns = {name: document[name] for name in ("creature", "cell", "fitness")}
        return Columns(
            columns | {"generation": document["elite_generation"]} | document["measures"]
        )

    def results(self) -> Table:
        """Return the table of a run without an archive."""
        return Table(self._connection.read(f"{self._path}/results"))

    def lineage(self) -> Columns:
        """Return every insertion into the archive up to the last checkpoint, with parents."""
        return lineage(self._connection.ask("GET", f"{self._path}/archive.h5").content)

    def phylogeny(self, form: str = "csv", generation: int | None = None) -> str:
        """Return all that entered, now or up to a generation, below ancestors in other runs:
        the ALife phylogeny standard's table (`csv`), or Newick (`nwk`)."""
        if form not in TREE_FORMS:
            raise InvalidField("form", f"must be {' or '.join(TREE_FORMS)}; got {form!r:.80}")
        asked = {} if generation is None else {"generation": generation}
        path = f"{self._path}/phylogeny.{form}"
        return self._connection.ask("GET", path, params=asked).text

    def log(self, after: int | None = None, limit: int = 500) -> list[dict[str, Any]]:
        """Return the newest log entries, or those after an entry."""
        document = self._connection.read(f"{self._path}/log", after=after, limit=limit)
        return document["entries"]

    def pull(self, path: str | Path | None = None, *, quiet: bool = False) -> Path:
        """Download its file to a folder or a path; the next call resumes a broken download.

        The file is the last checkpoint, so that of a running run grows old.
        """
        to = Path(path or ".")
        to = to / f"{self.experiment}-{self.id[:8]}.h5" if to.is_dir() else to
        with files.progress_bar(to.name, quiet) as tell:
            return files.fetch(self._connection, f"{self._path}/archive.h5", to, tell)

    def export(
        self, form: str, to: str | Path | None = None, *, quiet: bool = False, **options: Any
    ) -> list[Path]:
        """Write its last checkpoint in a format that other programs read; see
        `microcosmos.export`, which takes several runs, for `form`, `to` and the options."""
        chosen = Format(form)
        file = opened(self, chosen, quiet=quiet)
        more = {file.name: extra(self, file)} if chosen is Format.ro_crate else None
        return export([file], form, to, extra=more, **options)

    def share(self, *, generation: int | None = None, **options: Any) -> Share:
        """Publish its archive under a link, with the options of `sharing.publish`."""
        what = {"run": self.id} | ({} if generation is None else {"generation": generation})
        return publish(self._connection, what, **options)

    @cached_property
    def url(self) -> str:
        """Return the address of its page."""
        return f"{self._connection.url}/runs/{self.id}"


def _choices(document: Mapping[str, Any]) -> Columns:
    items = document["items"]
    return Columns({name: [one[name] for one in items] for name in ("creature", "generation")})


TREE_FORMS = (ENDINGS[Format.alife], ENDINGS[Format.newick])
TREES = {
    Format.alife: (ENDINGS[Format.alife],),
    Format.newick: (ENDINGS[Format.newick],),
    Format.ro_crate: TREE_FORMS,
}
"""Endings of the phylogenies that a format needs."""


def opened(run: Run, form: Format, *, quiet: bool = False) -> RunFile:
    """Download a run's last checkpoint, and the phylogenies that the format needs."""
    with TemporaryDirectory() as folder:
        path = run.pull(folder, quiet=quiet)
        name, data = path.stem, path.read_bytes()
    file = RunFile(name, data)
    endings = TREES.get(form, ()) if file.has_archive else ()
    # The run may have gone on since this checkpoint.
    trees = {one: run.phylogeny(one, file.generation).encode() for one in endings}
    return RunFile(name, data, trees, run.record["finished_at"], run.name or "")


def extra(run: Run, file: RunFile) -> dict[str, File]:
    """Return the best creature of its file, and the creatures that people chose, if there are
    any."""
    files: dict[str, File] = {}
    # Not of the run's archive on the server, which may have gone on since this checkpoint.
    archive = file.archive()
    if len(archive["fitness"]):
        best = hexes(archive["creature"])[int(archive["fitness"].argmax())]
        about = "the best creature, for `microcosmos replay`"
        files["best.json"] = File(_json(Creature(run._connection, best).file), about)
    try:
        chosen: dict[str, Any] = run.exported_choices()
    except NotFound:
        return files
    about = "creatures that people chose, for `microcosmos evolve --choices`"
    return files | {CHOICES: File(_json(chosen), about)}


def _json(document: Any) -> bytes:
    return json.dumps(document, indent=1).encode()
