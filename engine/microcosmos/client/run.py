"""A run on a server."""

from collections.abc import Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any, Self
from uuid import uuid4

from . import files, forking, polling, watching
from .archive import Archive
from .columns import Columns
from .creature import Creature
from .errors import NotFound
from .lineage import entries
from .progress import bar
from .record import Record
from .sharing import Share, publish
from .table import Table


class Run(Record):
    """As it was when the server was last asked; `refresh` asks again."""

    NOUN = "runs"

    def __repr__(self) -> str:
        name = f" {self.name!r}" if self.name else ""
        done = f"{self.generation} of {self.generations} generations"
        return f"<Run {self.id[:8]}{name}: {self.experiment}, {self.status}, {done}>"

    @property
    def experiment(self) -> str:
        return self.record["experiment"]

    @property
    def status(self) -> str:
        """queued, running, paused, finished, failed or cancelled."""
        return self.record["status"]

    @property
    def ended(self) -> bool:
        return self.status in polling.ENDED

    @property
    def spec(self) -> dict[str, Any]:
        return self.record["spec"]

    @property
    def progress(self) -> float:
        return self.record["progress"]

    @property
    def generation(self) -> int:
        return self.record["generation"]

    @property
    def generations(self) -> int:
        return self.record["generations"]

    @property
    def qd_score(self) -> float | None:
        return self.record["qd_score"]

    @property
    def coverage(self) -> float | None:
        return self.record["coverage"]

    @property
    def best(self) -> float | None:
        """The best fitness; who has it is `archive().best()`."""
        return self.record["best"]

    @property
    def error(self) -> str | None:
        return self.record["error"]

    def wait(self, timeout: float | None = None) -> str:
        """The state in which it has ended; `TimeoutError` after so many seconds."""
        self.record = polling.wait(self._connection, self.id, timeout)
        return self.status

    def watch(self) -> str:
        """Show how it goes until it has ended, and how it ended; Ctrl-C leaves it going."""
        status = watching.watch(self._connection, self.id)
        self.refresh()
        return status

    def extend(self, generations: int) -> Self:
        """So many generations more."""
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
        """A new run that begins with elites of this one: some, a region's, or all of them.

        `region` gives low and high along axes by name; `spec` says what is to differ, and
        None in it takes a field back to its default.
        """
        asked = forking.document(creatures, cells, region, generation, spec, name)
        path, key = f"{self._path}/fork", str(uuid4())
        return Run(self._connection, self._connection.send("POST", path, asked, key=key))

    def delete(self) -> Self:
        """Into the bin, from which `restore` takes it back for a day."""
        try:
            self.record = self._connection.send("DELETE", self._path)
        except NotFound:
            # It lies there already where the answer to a first request was lost.
            if not self.refresh().record.get("deleted_at"):
                raise
        return self

    def restore(self) -> Self:
        return self._ask("restore")

    def change(
        self,
        *,
        name: str | None = None,
        tags: Sequence[str] | None = None,
        note: str | None = None,
    ) -> Self:
        """Say what it is called, its tags or a note; what is left out stays as it is."""
        said = {"name": name, "tags": None if tags is None else list(tags), "note": note}
        said = {field: value for field, value in said.items() if value is not None}
        self.record = self._connection.send("PATCH", self._path, said)
        return self

    def curves(self, points: int | None = None) -> Columns:
        """Columns by generation: `qd_score`, `coverage`, `best` … and what else was told."""
        told = self._connection.read(f"{self._path}/generations", points=points)
        summary = told.pop("summary")
        return Columns(told | summary)

    def archive(self, generation: int | None = None) -> Archive:
        """Who is in which cell, with all that is recorded, now or as of a generation."""
        path = f"{self._path}/archive"
        told = self._connection.read(path, generation=generation)
        names = ",".join(one["name"] for one in told["recorded"])
        if names:  # Which there are is not known before.
            at = told["generation"]
            told = self._connection.read(path, generation=at, measures=names)
        return Archive(self._connection, self.id, told)

    def results(self) -> Table:
        """The table of a run that fills no archive."""
        return Table(self._connection.read(f"{self._path}/results"))

    def lineage(self) -> Columns:
        """Every entry into the archive up to the last checkpoint, with its two parents."""
        return entries(self._connection.ask("GET", f"{self._path}/archive.h5").content)

    def log(self, after: int | None = None, limit: int = 500) -> list[dict[str, Any]]:
        """What happened to it: the newest entries, or those after one."""
        found = self._connection.read(f"{self._path}/log", after=after, limit=limit)
        return found["entries"]

    def pull(self, path: str | Path | None = None, *, quiet: bool = False) -> Path:
        """Its file, into a folder or under a name; broken off, the next call goes on.

        It is the last checkpoint: of a run that goes on, the file grows old.
        """
        to = Path(path or ".")
        to = to / f"{self.experiment}-{self.id[:8]}.h5" if to.is_dir() else to
        with bar(to.name, quiet) as tell:
            return files.fetch(self._connection, f"{self._path}/archive.h5", to, tell)

    def share(self, *, generation: int | None = None, **said: Any) -> Share:
        """Publish its archive under a link; `title`, `credit`, `licence`, `days`, `listed`."""
        what = {"run": self.id} | ({} if generation is None else {"generation": generation})
        return publish(self._connection, what, **said)

    @cached_property
    def url(self) -> str:
        """Its page."""
        return f"{self._connection.url}/runs/{self.id}"
