"""A run on a server."""

from collections.abc import Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any, Self
from uuid import uuid4

from . import exporting, files, polling
from .archive import Archive
from .columns import Columns, Table, lineage
from .creature import Creature
from .errors import NotFound
from .record import Field, Record
from .sharing import Share, publish
from .views import watch


class Run(Record):
    """A copy of the server's record; `refresh` reads it again."""

    NOUN = "runs"
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
        from .live import live

        return live(self, self._connection, **options)

    def extend(self, generations: int) -> Self:
        """Add generations."""
        return self._ask("extend", {"generations": generations})

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
        None clears a field that may be empty, and resets another to its
        default.
        """
        chosen: dict[str, Any] = {}
        if creatures is not None:
            names = [one.sha if isinstance(one, Creature) else one for one in creatures]
            chosen["creatures"] = names
        if cells is not None:
            chosen["cells"] = list(cells)
        if region is not None:
            chosen["region"] = {axis: list(ends) for axis, ends in region.items()}
        if len(chosen) > 1:
            given = ", ".join(chosen)
            raise ValueError(f"fork needs one of creatures, cells, region; got {given}")
        document: dict[str, Any] = {
            "from": chosen or {"archive": True},
            "spec": {**(spec or {})},
        }
        document |= {} if generation is None else {"generation": generation}
        document |= {"name": name} if name else {}
        path, key = f"{self._path}/fork", str(uuid4())
        return Run(self._connection, self._connection.send("POST", path, document, key=key))

    def choose(self, creatures: Sequence[str | Creature]) -> Columns:
        """Let a part of the next generations descend from these creatures of its archive."""
        names = [one.sha if isinstance(one, Creature) else one for one in creatures]
        sent = {"creatures": names}
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
            self.record = self._connection.send("DELETE", self._path)
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
        given = {"name": name, "tags": None if tags is None else list(tags), "note": note}
        given = {field: value for field, value in given.items() if value is not None}
        self.record = self._connection.send("PATCH", self._path, given)
        return self

    def curves(self, points: int | None = None) -> Columns:
        """Return columns by generation: `qd_score`, `coverage`, `best`, and the summary's."""
        found = self._connection.read(f"{self._path}/generations", points=points)
        curves = {name: column for name, column in found.items() if name != "summary"}
        return Columns(curves | found["summary"])

    def archive(self, generation: int | None = None) -> Archive:
        """Return the elites with all measures, now or after a generation."""
        path = f"{self._path}/archive"
        found = self._connection.read(path, generation=generation)
        if names := ",".join(one["name"] for one in found["recorded"]):
            at = found["generation"]
            found = self._connection.read(path, generation=at, measures=names)
        return Archive(self._connection, self.id, found)

    def history(self, measures: Sequence[str] | None = None) -> Columns:
        """Return every elite that ever entered the archive, also those that were replaced:
        `creature`, `cell`, `generation`, `fitness`, and all measures or those that are named.
        """
        path = f"{self._path}/archive"
        if measures is None:
            recorded = self._connection.read(path)["recorded"]
            measures = [one["name"] for one in recorded]
        names = ",".join(measures) or None
        found = self._connection.read(f"{path}/history", measures=names)
        columns = {name: found[name] for name in ("creature", "cell", "fitness")}
        return Columns(columns | {"generation": found["elite_generation"]} | found["measures"])

    def results(self) -> Table:
        """Return the table of a run without an archive."""
        return Table(self._connection.read(f"{self._path}/results"))

    def lineage(self) -> Columns:
        """Return every insertion into the archive up to the last checkpoint, with parents."""
        return lineage(self._connection.ask("GET", f"{self._path}/archive.h5").content)

    def phylogeny(self, form: str = "csv") -> str:
        """Return all that ever entered, below ancestors in other runs: the ALife phylogeny
        standard's table (`csv`), or Newick (`nwk`)."""
        return self._connection.ask("GET", f"{self._path}/phylogeny.{form}").text

    def log(self, after: int | None = None, limit: int = 500) -> list[dict[str, Any]]:
        """Return the newest log entries, or those after an entry."""
        found = self._connection.read(f"{self._path}/log", after=after, limit=limit)
        return found["entries"]

    def pull(self, path: str | Path | None = None, *, quiet: bool = False) -> Path:
        """Download its file to a folder or a path; the next call resumes a broken download.

        The file is the last checkpoint, so that of a running run grows old.
        """
        to = Path(path or ".")
        to = to / f"{self.experiment}-{self.id[:8]}.h5" if to.is_dir() else to
        with files.progress_bar(to.name, quiet) as tell:
            return files.fetch(self._connection, f"{self._path}/archive.h5", to, tell)

    def export(self, form: str, to: str | Path | None = None, **options: Any) -> list[Path]:
        """Write its last checkpoint in a format that other programs read; see
        `microcosmos.export`, which takes several runs, for `form`, `to` and the options."""
        return exporting.export(self, form, to, **options)

    def share(self, *, generation: int | None = None, **options: Any) -> Share:
        """Publish its archive under a link; `title`, `credit`, `licence`, `days`, `listed`."""
        what = {"run": self.id} | ({} if generation is None else {"generation": generation})
        return publish(self._connection, what, **options)

    @cached_property
    def url(self) -> str:
        """Address of its page."""
        return f"{self._connection.url}/runs/{self.id}"


def _choices(found: Mapping[str, Any]) -> Columns:
    items = found["items"]
    return Columns({name: [one[name] for one in items] for name in ("creature", "generation")})
