"""The command `compare`: statistics of groups of runs."""

from pathlib import Path
from typing import Annotated

from typer import Option

from ..archive.atomic import write_whole
from .app import app, fail, failing
from .groups import GROUPS, Measures, Resamples, Seed, read_groups
from .remote import Token, Url

FORMS = ("table", "csv", "json", "latex")


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
        from ..statistics import across, tables
        from ..statistics import compare as compared
        from ..statistics.effects import Bootstrap
        from ..statistics.measures import DEFAULT

        bootstrap, measures = Bootstrap(resamples, seed), measure or DEFAULT
        found = read_groups(groups, url, token)
        if task:
            several = [across(found, one, task, bootstrap) for one in measures]
            write = {"table": tables.aggregates_text, "json": tables.aggregates_json}
            _deliver(write[form](several), out)
        else:
            write = {name: getattr(tables, name) for name in ("csv", "json", "latex")}
            text = write.get(form, tables.text)(compared(found, measures, bootstrap))
            _deliver(text, out)


def _deliver(text: str, out: Path | None) -> None:
    """Write to a file, or to standard output."""
    if out is None:
        print(text, end="")
        return
    write_whole(out, text.encode())
    print(out)
