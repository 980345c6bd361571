"""Groups of runs from files, folders, and runs and sweeps on a server."""

from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from typer import Argument, Option

from ..client import Client, Run, Sweep
from .remote import find

if TYPE_CHECKING:
    from ..statistics import Group, RunRecord

GROUPS = Argument(
    metavar="[NAME=]RUN,RUN...",
    help="A group: archive files, folders of them, or ids of runs and sweeps on a server. "
    "Without a name, runs form a group for each spec: a sweep has one for each case.",
)
Measures = Annotated[
    list[str] | None,
    Option(
        "--measure",
        help="A curve (qd_score), a curve after evaluations (qd_score@6400), or the "
        "evaluations to a value (best>=0.5); repeatable.",
        show_default="qd_score, coverage, best",
    ),
]
Resamples = Option(min=99, help="Resamples of the bootstrap.")
Seed = Option(min=0, help="Random seed of the bootstrap.")


def read_groups(
    texts: Sequence[str], url: str | None = None, token: str | None = None
) -> list["Group"]:
    """Return the groups that arguments name. Raises `ValueError` for what cannot be compared,
    and `ServerError` where a server is needed and fails."""
    from ..statistics import by_spec, named

    named_runs: dict[str, list[RunRecord]] = {}
    unnamed: list[RunRecord] = []
    with ExitStack() as stack:
        source = _Source(stack, url, token)
        for text in texts:
            name, equals, sources = text.partition("=")
            if not equals or Path(text).exists():
                unnamed += source.runs(text)
                continue
            if name in named_runs:
                raise ValueError(f"groups need names that differ, got {name!r} twice")
            named_runs[name] = source.runs(sources)
            if not name.strip() or not named_runs[name]:
                raise ValueError(f"a group is written as NAME=RUN,RUN,..., got {text!r}")
    return named(named_runs) + (by_spec(unnamed) if unnamed else [])


class _Source:
    """Where runs are read from; the server is met only for what is no file."""

    def __init__(self, stack: ExitStack, url: str | None, token: str | None):
        self._stack, self._address = stack, (url, token)
        self._client: Client | None = None

    def runs(self, text: str) -> list["RunRecord"]:
        from ..statistics import read_files

        found: list[RunRecord] = []
        for one in filter(None, (part.strip() for part in text.split(","))):
            path = Path(one)
            found += read_files([path]) if path.exists() else self._of_server(one)
        return found

    def _of_server(self, text: str) -> list["RunRecord"]:
        if not text or set(text.lower()) - set("0123456789abcdef-"):
            raise ValueError(f"a run is a file, a folder or an id on a server, got {text!r}")
        if self._client is None:
            self._client = self._stack.enter_context(Client(*self._address))
        thing = find(self._client, text)
        runs = list(thing.runs()) if isinstance(thing, Sweep) else [thing]
        return [record(run) for run in runs]


def record(run: Run) -> "RunRecord":
    """Return the run of a server for statistics. Raises `ValueError` without an archive."""
    from ..statistics import RunRecord

    if run.qd_score is None and "search" in run.spec and not run.generation:
        raise ValueError(
            f"{run.id}: a generation is needed; the run is {run.status} without one"
        )
    if run.qd_score is None:
        raise ValueError(f"{run.id}: a search with an archive is needed, got {run.experiment}")
    done = f"{run.status} at generation {run.generation:,} of {run.generations:,}"
    return RunRecord(
        name=run.id,
        document=run.spec,
        curves=run.curves(),
        version=run.record["version"],
        devices=(run.record["device"] or "an unknown device",),
        state="finished" if run.status == "finished" else done,
    )
