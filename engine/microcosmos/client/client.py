"""The client of a Microcosmos server."""

import os
from collections.abc import Iterator, Mapping, Sequence
from itertools import chain
from os import PathLike
from pathlib import Path
from typing import Any, Self, overload
from uuid import uuid4

import httpx

from ..archive import creature_h5
from ..archive.file import HDF5
from ..invalid import InvalidField
from ..json_text import read_json
from . import arguments, sharing, specs
from .connection import Connection
from .creature import Creature
from .errors import NotFound
from .polling import Event, events
from .record import find
from .run import Run
from .sharing import Share, expiry, publish
from .sweep import Sweep

HERE = "http://127.0.0.1:8000"


class Client:
    """Uses the server at `url`, else at MICROCOSMOS_URL, else on this machine.

    The default of `token` is MICROCOSMOS_TOKEN. Requests that fail on their way are repeated
    for up to `patience` seconds, if that is safe: 30, or until a first answer three tries,
    unless it is given.
    """

    def __init__(
        self,
        url: str | None = None,
        token: str | None = None,
        *,
        patience: float | None = None,
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
    def submit(
        self, spec: Any, *, name: str | None = None, key: str | None = None, **scheduling: Any
    ) -> Run: ...

    @overload
    def submit(
        self,
        spec: Any,
        *,
        seeds: int | Sequence[int] | None = None,
        grid: Mapping[str, Sequence[Any]] | None = None,
        name: str | None = None,
        key: str | None = None,
        **scheduling: Any,
    ) -> Sweep: ...

    def submit(
        self,
        spec: Any,
        *,
        seeds: int | Sequence[int] | None = None,
        grid: Mapping[str, Sequence[Any]] | None = None,
        name: str | None = None,
        key: str | None = None,
        **scheduling: Any,
    ) -> Run | Sweep:
        """Queue a spec, a file with one, or a preset by its name.

        With `seeds` (a number or a list) or a `grid` (values by the dotted path of a field) it
        is a sweep. The same `key` with the same arguments is the same run, however often it is
        sent.
        `scheduling` may be `priority` (low, normal, high, or for admins urgent), `labels` that
        the worker must have, `may_yield` to urgent runs, and `device_patience`, the seconds
        until another kind of device may continue it.
        """
        # A request that is repeated after a lost answer makes one run alone
        # (test_a_request_whose_answer_is_lost_is_repeated_safely).
        document, key = specs.document(self.connection, spec), key or str(uuid4())
        grid = grid if grid is None else arguments.fields("grid", grid)
        if seeds is None and grid is None:
            # The name is sent at once: a run that was queued without it would be sent again.
            record = self.connection.send(
                "POST", "runs", document, key=key, name=name, **scheduling
            )
            run = Run(self.connection, record)
            return run.change(name=name) if name and not run.name else run
        many = {
            "spec": document,
            "seeds": 1 if seeds is None else _seeds(seeds),
            "grid": {
                path: arguments.several(f"grid.{path}", values)
                for path, values in (grid or {}).items()
            },
        }
        many |= {"name": name} if name else {}
        made = self.connection.send("POST", "sweeps", many, key=key, **scheduling)
        return Sweep(self.connection, made)

    def estimate(self, spec: Any) -> dict[str, Any]:
        """Estimate the memory, work and time of a run."""
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
        """Yield the runs that match, newest first; pages are read as they are needed."""
        if sweep is not None and not isinstance(sweep, Sweep):
            sweep = self.sweep(sweep, deleted=deleted)
        records = self.connection.items(
            "runs",
            status=_texts("status", status),
            experiment=_texts("experiment", experiment),
            tag=tag,
            q=text,
            sweep=sweep and sweep.id,
            deleted=deleted or None,
            sort=sort,
            limit=200,
        )
        return (Run(self.connection, one) for one in records)

    def run(self, id: str, *, deleted: bool = False) -> Run:
        """Return the run whose id begins with `id`; raise `NotFound`, `Refused` for several."""
        # The server searches for the text; `find` then compares the beginning of ids.
        candidates = self.connection.items("runs", q=id, deleted=deleted or None, limit=200)
        return Run(self.connection, find(self.connection, "runs", id, candidates))

    def last(self) -> Run:
        """Return the newest run."""
        newest = next(self.runs(), None)
        if newest is None:
            raise NotFound(f"{self.url} has no runs yet: submit one first.")
        return newest

    def sweeps(self) -> Iterator[Sweep]:
        """Yield all sweeps, newest first."""
        return (Sweep(self.connection, one) for one in self.connection.items("sweeps"))

    def sweep(self, id: str, *, deleted: bool = False) -> Sweep:
        """Return the sweep whose id begins with `id`, from the bin too if `deleted`.

        Raise `NotFound`, and `Refused` for several.
        """
        lists = [None, True] if deleted else [None]
        candidates = chain(*(self.connection.items("sweeps", deleted=one) for one in lists))
        return Sweep(self.connection, find(self.connection, "sweeps", id, candidates))

    def experiments(self) -> list[dict[str, Any]]:
        """Return the experiments, each with presets and the schema of its spec."""
        return list(self.connection.items("experiments"))

    def creature(self, sha: str) -> Creature:
        """Return the creature of this name. Raise `NotFound` if the server has none."""
        creature = Creature(self.connection, arguments.name("sha", sha))
        _ = creature.file  # The request; an assertion would be left out under `python -O`.
        return creature

    def import_creature(self, file: Mapping[str, Any] | str | Path) -> Creature:
        """Import a creature, its file in JSON or HDF5, or the address of a share.

        The server verifies the hash.
        """
        if not isinstance(file, Mapping | str | PathLike):
            needed = "must be a creature file, its path or the address of a share"
            raise InvalidField("file", f"{needed}; got {file!r:.80}")
        if isinstance(file, str) and (address := sharing.address(file)):
            document = sharing.creature(address)
        else:
            document = dict(file) if isinstance(file, Mapping) else creature_file(Path(file))
        return self._imported(document)

    def import_all(self, address: str) -> Iterator[Creature]:
        """Import all creatures of the share at an address, the best first, one at a time,
        without their ancestors.

        Raises `ValueError` for another text, which is no address of a share.
        """
        at = sharing.address(address) if isinstance(address, str) else None
        if at is None:
            raise InvalidField("address", f"must be that of a share, got {address!r:.200}")
        yield from map(self._imported, sharing.creatures(at))

    def _imported(self, document: Mapping[str, Any]) -> Creature:
        made = self.connection.send("POST", "creatures", document, key=str(uuid4()))
        return Creature(self.connection, made["creature"])

    def share(self, what: Run | Creature | str, **options: Any) -> Share:
        """Publish a run's archive or a creature, given itself, an id or a SHA-256.

        `options` are those of `sharing.publish`.
        """
        if isinstance(what, Run | Creature):
            return what.share(**options)
        if not isinstance(what, str):
            raise InvalidField("what", f"must be a run, a creature or its name; got {what!r}")
        if len(what) == 64:
            return publish(self.connection, {"creature": what}, **options)
        return self.run(what).share(**options)

    def shares(self) -> list[Share]:
        """Return your own shares."""
        return [Share(self.connection, one) for one in self.connection.items("shares")]

    def unshare(self, slug: str) -> None:
        """Revoke a share, given its slug or its whole address."""
        slug = sharing.slug(slug)
        self.connection.send("DELETE", f"shares/{slug}")

    def commons(self) -> list[Share]:
        """Return the shares that are listed for everybody."""
        return [Share(self.connection, one) for one in self.connection.items("commons")]

    def tokens(self) -> list[dict[str, Any]]:
        return list(self.connection.items("tokens"))

    def create_token(
        self, name: str, scope: str = "read", *, days: float | None = None
    ) -> dict[str, Any]:
        """Create a token; only this answer contains its secret."""
        document = {"name": name, "scope": scope}
        document |= {"expires_at": expiry(days)} if days is not None else {}
        return self.connection.send("POST", "tokens", document)

    def revoke_token(self, id: str) -> None:
        """Revoke the token whose id begins with `id`."""
        tokens = self.connection.items("tokens")
        token = find(self.connection, "tokens", id, tokens, fetch=False)
        self.connection.send("DELETE", f"tokens/{token['id']}")

    def workers(self) -> list[dict[str, Any]]:
        """Return the live workers, with device, memory, load and run of each."""
        return list(self.connection.items("workers"))

    def events(self, run: str | Run | None = None) -> Iterator[Event]:
        """Yield new events of all runs or of one, without an end."""
        if run is not None and not isinstance(run, Run):
            run = self.run(run)
        stream = events(self.connection, run and run.id)
        return (event for event in stream if event.kind != "beat")


def _texts(field: str, given: Any) -> list[Any]:
    """Return one text or several as a list."""
    return [given] if isinstance(given, str) else arguments.several(field, given)


def _seeds(seeds: Any) -> int | list[int]:
    """Return a number of seeds, or a list of some."""
    if isinstance(seeds, bool) or not hasattr(seeds, "__iter__"):
        return arguments.whole("seeds", seeds)
    if listed := arguments.wholes("seeds", seeds):
        return listed
    raise InvalidField("seeds", "must be a number, or a list with at least one; got []")


def creature_file(path: Path) -> dict[str, Any]:
    """Read a creature file. Raise `ValueError` for any other file."""
    data = path.read_bytes()
    try:
        return creature_h5.load(data) if data.startswith(HDF5) else read_json(data)
    except ValueError as error:
        raise ValueError(f"{path} needs a creature, as JSON or HDF5: {error}") from error
