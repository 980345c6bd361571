"""Groups of runs from files, folders, runs and sweeps, and the command `compare`."""

from collections.abc import Callable, Sequence
from contextlib import ExitStack
from errno import ENAMETOOLONG
from functools import cache
from pathlib import Path
from typing import Annotated

from typer import Argument, Option

from ..client import Client, Run, Sweep
from ..client.formatting import visible_lines
from ..statistics import Group, RunRecord, across, by_spec, named, read_files, tables
from ..statistics import compare as compared
from ..statistics.effects import MAX_RESAMPLES, Bootstrap
from ..statistics.measures import DEFAULT, parsed
from .app import app, deliver, fail, failing, refuse_input
from .remote import Token, Url, find

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
Resamples = Option(min=99, max=MAX_RESAMPLES, help="Resamples of the bootstrap.")
Seed = Option(min=0, help="Random seed of the bootstrap.")


def read_groups(
    texts: Sequence[str], url: str | None = None, token: str | None = None
) -> list[Group]:
    """Return the groups that arguments name. Raises `ValueError` for what cannot be compared,
    and `ServerError` where a server is needed and fails."""
    named_runs: dict[str, list[RunRecord]] = {}
    unnamed: list[RunRecord] = []
    with ExitStack() as stack:
        # Files alone need no server: the first id opens the connection.
        @cache
        def client() -> Client:
            return stack.enter_context(Client(url, token))

        for text in texts:
            name, equals, sources = text.partition("=")
            # A path that has these characters itself needs no name.
            unnamed_text = not equals or any(map(_exists, listed(text)[:1]))
            given = text if unnamed_text else sources
            if not listed(given) or not (unnamed_text or name.strip()):
                raise ValueError(f"a group is written as [NAME=]RUN,RUN,..., got {text!r}")
            if unnamed_text:
                unnamed += _runs(given, client)
                continue
            if name in named_runs:
                raise ValueError(f"groups need names that differ, got {name!r} twice")
            named_runs[name] = _runs(given, client)
    return named(named_runs) + (by_spec(unnamed) if unnamed else [])


def listed(text: str) -> list[str]:
    """Return what stands between commas; the longest path that exists may have some itself."""
    parts, found = text.split(","), []
    while parts:
        ends = range(len(parts), 1, -1)
        paths = ((end, ",".join(parts[:end]).strip()) for end in ends)
        end, one = next((p for p in paths if _exists(p[1])), (1, parts[0].strip()))
        found += [one] if one else []
        parts = parts[end:]
    return found


def _files(texts: Sequence[str]) -> list[Path]:
    """Return the files that arguments may name, and those in folders."""
    sources = [one for text in texts for one in (text, text.partition("=")[2])]
    paths = [Path(one) for source in sources for one in listed(source)]
    return paths + [file for path in paths for file in path.glob("*.h5")]


def _exists(path: str) -> bool:
    try:
        return Path(path).exists()
    except OSError as error:  # Several names together may be too long for one file.
        if error.errno != ENAMETOOLONG:
            raise
        return False


def _runs(text: str, client: Callable[[], Client]) -> list[RunRecord]:
    """Return runs between commas; only ids that are no files are looked up on the server."""
    records: list[RunRecord] = []
    for one in listed(text):
        if _exists(one):
            records += read_files([Path(one)])
            continue
        # A mistyped path must not be sent to a server as an id.
        if set(one.lower()) - set("0123456789abcdef-"):
            raise ValueError(f"a run is a file, a folder or an id on a server, got {one!r}")
        thing = find(client(), one)
        records += map(record, thing.runs() if isinstance(thing, Sweep) else [thing])
    return records


def record(run: Run) -> RunRecord:
    """Return the run of a server for statistics. Raises `ValueError` without an archive."""
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


FORMS = {"table": tables.text, "csv": tables.csv, "json": tables.json, "latex": tables.latex}


@app.command()
def compare(
    groups: Annotated[list[str], GROUPS],
    measure: Measures = None,
    form: Annotated[str, Option("--as", help=f"{', '.join(FORMS)}.")] = "table",
    out: Annotated[
        Path | None, Option(dir_okay=False, help="File to write to; default: print.")
    ] = None,
    task: Annotated[
        list[str] | None,
        Option(
            metavar="FIELD",
            help="A field of the spec that tells tasks apart, to aggregate over; repeatable.",
        ),
    ] = None,
    resamples: Annotated[int, Resamples] = 9999,
    seed: Annotated[int, Seed] = 0,
    url: Url = None,
    token: Token = None,
) -> None:
    """Compare groups of runs: quartiles, rank tests, effect sizes with intervals.

    Tests need five seeds in each group. With --task, aggregates over several tasks.
    """
    if form not in FORMS:
        fail(f"--as must be one of {', '.join(FORMS)}; got {form}")
    if task and form not in ("table", "json"):
        fail(f"--as must be table or json with --task; got {form}")
    with failing():
        refuse_input(out, *_files(groups))
        bootstrap, measures = Bootstrap(resamples, seed), parsed(measure or DEFAULT)
        groups_of_runs = read_groups(groups, url, token)
        if task:
            several = [across(groups_of_runs, one, task, bootstrap) for one in measures]
            write = {"table": tables.aggregates_text, "json": tables.aggregates_json}
            text = write[form](several)
        else:
            text = FORMS[form](compared(groups_of_runs, measures, bootstrap))
        deliver((visible_lines(text) if form == "table" else text).encode(), out)
