"""A Microcosmos server, from Python."""

import json
import os
from collections.abc import Iterator, Mapping, Sequence
from itertools import chain
from pathlib import Path
from typing import Any, Self, overload
from uuid import uuid4

import httpx

from ..archive import creature_h5
from ..archive.file import HDF5
from . import specs
from .connection import Connection
from .creature import Creature
from .errors import NotFound
from .pages import items
from .prefixes import only
from .run import Run
from .sharing import Share, expiry, publish
from .streaming import Event, events
from .sweep import Sweep

HERE = "http://127.0.0.1:8000"


class Client:
    """Speaks to the server at `url`, else at MICROCOSMOS_URL, else on this machine.

    A token is taken from MICROCOSMOS_TOKEN where none is given. Requests that do not get
    through are made again for up to `patience` seconds, where that can do no harm.
    """

    def __init__(
        self,
        url: str | None = None,
        token: str | None = None,
        *,
        patience: float = 30.0,
        transport: httpx.BaseTransport | None = None,
    ):
        url = url or os.environ.get("MICROCOSMOS_URL") or HERE
        token = token or os.environ.get("MICROCOSMOS_TOKEN") or None
        self.connection = Connection(url, token, patience, transport)

    @property
    def url(self) -> str:
        return self.connection.url

    def __repr__(self) -> str:
        return f"Client({self.url!r})"

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        self.connection.close()

    @overload
    def submit(self, spec: Any, *, name: str | None = None, key: str | None = None) -> Run: ...

    @overload
    def submit(
        self,
        spec: Any,
        *,
        seeds: int | Sequence[int],
        grid: Mapping[str, Sequence[Any]] | None = None,
        name: str | None = None,
        key: str | None = None,
    ) -> Sweep: ...

    @overload
    def submit(
        self,
        spec: Any,
        *,
        seeds: int | Sequence[int] | None = None,
        grid: Mapping[str, Sequence[Any]],
        name: str | None = None,
        key: str | None = None,
    ) -> Sweep: ...

    def submit(
        self,
        spec: Any,
        *,
        seeds: int | Sequence[int] | None = None,
        grid: Mapping[str, Sequence[Any]] | None = None,
        name: str | None = None,
        key: str | None = None,
    ) -> Run | Sweep:
        """Queue a spec, a file with one, or a preset by its name.

        With `seeds` (how many, or which) or a `grid` (values by the dotted path of a field)
        it is a sweep. The same `key` with the same spec is the same run, however often it is
        sent.
        """
        document, key = specs.document(self.connection, spec), key or str(uuid4())
        if seeds is None and grid is None:
            # Named as it is made: what was queued without its name would be submitted again.
            told = self.connection.send("POST", "runs", document, key=key, name=name)
            run = Run(self.connection, told)
            return run.change(name=name) if name and not run.name else run
        many = {
            "spec": document,
            "seeds": seeds if isinstance(seeds, int) else list(seeds or []) or 1,
            "grid": {path: list(values) for path, values in (grid or {}).items()},
        }
        many |= {"name": name} if name else {}
        return Sweep(self.connection, self.connection.send("POST", "sweeps", many, key=key))

    def estimate(self, spec: Any) -> dict[str, Any]:
        """Memory, work and time that a run will need, without queueing it."""
        document = specs.document(self.connection, spec)
        return self.connection.send("POST", "runs/estimate", document)

    def runs(
        self,
        *,
        status: str | Sequence[str] = (),
        experiment: str | Sequence[str] = (),
        tag: str | None = None,
        text: str | None = None,
        sweep: str | Sweep | None = None,
        deleted: bool = False,
        sort: str = "-created",
    ) -> Iterator[Run]:
        """All runs like these, newest first, fetched as they are needed."""
        asked = {
            "status": several(status),
            "experiment": several(experiment),
            "tag": tag,
            "q": text,
            "sweep": sweep.id if isinstance(sweep, Sweep) else sweep,
            "deleted": deleted or None,
            "sort": sort,
            "limit": 200,
        }
        found = items(self.connection, "runs", **asked)
        return (Run(self.connection, one) for one in found)

    def run(self, id: str, *, deleted: bool = False) -> Run:
        """The run of this id, or whose id alone begins so; `NotFound` where none does."""
        like = items(self.connection, "runs", q=id, deleted=deleted or None, limit=200)
        return Run(self.connection, only(self.connection, "runs", id, like))

    def last(self) -> Run:
        """The newest run."""
        found = next(self.runs(), None)
        if found is None:
            raise NotFound(f"{self.url} has no runs yet: submit one first.")
        return found

    def sweeps(self) -> Iterator[Sweep]:
        """All sweeps, newest first."""
        return (Sweep(self.connection, one) for one in items(self.connection, "sweeps"))

    def sweep(self, id: str, *, deleted: bool = False) -> Sweep:
        """The sweep of this id, or whose id alone begins so; `NotFound` where none does.

        With `deleted`, beginnings are looked for among those in the bin too.
        """
        lists = [None, True] if deleted else [None]
        like = chain(*(items(self.connection, "sweeps", deleted=one) for one in lists))
        return Sweep(self.connection, only(self.connection, "sweeps", id, like))

    def experiments(self) -> list[dict[str, Any]]:
        """The kinds of run, each with the schema of its spec and presets."""
        return self.connection.read("experiments")

    def creature(self, sha: str) -> Creature:
        """The creature of this name; `NotFound` where the server does not know it."""
        found = Creature(self.connection, sha)
        assert found.file
        return found

    def import_creature(self, file: Mapping[str, Any] | str | Path) -> Creature:
        """Bring a creature file, or where it is, as JSON or HDF5; its hash is verified."""
        document = dict(file) if isinstance(file, Mapping) else creature_file(Path(file))
        told = self.connection.send("POST", "creatures", document, key=str(uuid4()))
        return Creature(self.connection, told["creature"])

    def share(self, what: Run | Creature | str, **said: Any) -> Share:
        """Publish a run's archive or a creature, or what an id or a SHA-256 names.

        `said`: `title`, `credit`, `licence`, `days`, `listed`.
        """
        if isinstance(what, Run | Creature):
            return what.share(**said)
        if len(what) == 64:
            return publish(self.connection, {"creature": what}, **said)
        return self.run(what).share(**said)

    def shares(self) -> list[Share]:
        """One's own links."""
        return [Share(self.connection, one) for one in items(self.connection, "shares")]

    def unshare(self, slug: str) -> None:
        """Revoke a link, given its slug or its whole address."""
        slug = slug.rstrip("/").rpartition("/")[2]
        self.connection.send("DELETE", f"shares/{slug}")

    def commons(self) -> list[Share]:
        """What is listed for everybody."""
        return [Share(self.connection, one) for one in items(self.connection, "commons")]

    def tokens(self) -> list[dict[str, Any]]:
        return list(items(self.connection, "tokens"))

    def create_token(
        self, name: str, scope: str = "read", *, days: float | None = None
    ) -> dict[str, Any]:
        """A new token; its secret is told this once and never again."""
        document = {"name": name, "scope": scope}
        document |= {"expires_at": expiry(days)} if days is not None else {}
        return self.connection.send("POST", "tokens", document)

    def revoke_token(self, id: str) -> None:
        """Of this id, or whose id alone begins so."""
        like = items(self.connection, "tokens")
        found = only(self.connection, "tokens", id, like, fetch=False)
        self.connection.send("DELETE", f"tokens/{found['id']}")

    def workers(self) -> list[dict[str, Any]]:
        """Those that are alive, with device, memory, load and the run that each is at."""
        return self.connection.read("workers")

    def events(self, run: str | Run | None = None) -> Iterator[Event]:
        """What happens from now on, to all runs or to one; it does not end by itself."""
        found = events(self.connection, run.id if isinstance(run, Run) else run)
        return (event for event in found if event.kind != "beat")


def several(values: str | Sequence[str]) -> list[str]:
    return [values] if isinstance(values, str) else list(values)


def creature_file(path: Path) -> dict[str, Any]:
    """What is in a file. Raises `ValueError` where it is no creature's."""
    data = path.read_bytes()
    try:
        return creature_h5.load(data) if data.startswith(HDF5) else json.loads(data)
    except ValueError as error:
        raise ValueError(f"{path} needs a creature, as JSON or HDF5: {error}") from error
