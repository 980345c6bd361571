"""The report of a study: one HTML file, whose every number names the runs it comes from."""

import hashlib
import json
import platform
from collections.abc import Sequence
from html import escape
from pathlib import Path

import numpy
import scipy

from ..archive.atomic import write_whole
from ..spec.paths import value_text
from ..statistics import Group, tables, wording
from ..statistics.measures import Measure
from ..version import VERSION
from . import figures, markup, written
from .figures import Picture
from .markup import Cell, Link, Number
from .results import Compare, Results, exports, gather
from .runs import Plan, PlannedRun

FILE = "report.html"


def write(plan: Plan, source: bytes, command: str) -> list[Path]:
    """Make the report of a study whose runs are finished, its figures and exports.

    `source` is the content of the study's file as it was planned, `command` the line that
    repeats it. The same runs give the same bytes. Figures and exports that the study no longer
    has are removed. Return the paths, the report first.
    """
    results = gather(plan)
    # Before anything is written: a figure that fails leaves the last report whole.
    pictures = figures.draw(results)
    report = plan.folder / FILE
    write_whole(report, render(results, pictures, source, command).encode())
    made = {"figures": figures.files(pictures), "exports": exports(results)}
    return [report, *written.write(plan.folder, made)]


def render(results: Results, pictures: Sequence[Picture], source: bytes, command: str) -> str:
    """Return the report as HTML."""
    study = results.plan.study
    body = [markup.heading(study.title, level=1)]
    body += [markup.paragraph(part) for part in study.about.split("\n\n") if part.strip()]
    body.append(markup.paragraph(_summary(results), quiet=True))
    for number, one in enumerate(results.comparisons.values(), 1):
        body += _comparison(number, one, [x for x in pictures if x.of == one.name])
    body += _runs(results)
    body += _specs(results)
    body += _repeat(results, source, command)
    return markup.page(study.title, body)


def _summary(results: Results) -> str:
    evaluations = sum(int(one.record.evaluations[-1]) for one in results.runs.values())
    sweeps = len(results.plan.study.sweeps)
    return (
        f"{len(results.runs)} runs of {sweeps} {'sweep' if sweeps == 1 else 'sweeps'}, "
        f"{evaluations:,} evaluations in all. Every number leads to the runs that it comes "
        "from, which are listed at the end."
    )


def _comparison(number: int, one: Compare, pictures: Sequence[Picture]) -> list[str]:
    body = [markup.heading(one.name, f"comparison-{number}")]
    if one.statistics:
        statistics = one.statistics
        body.append(markup.paragraph(wording.difference(statistics)))
        body += _tables(number, one)
        body += [markup.paragraph(wording.method(statistics), quiet=True)]
        body += [markup.paragraph(text, quiet=True) for text in wording.cautions(statistics)]
    else:
        body += _aggregates(number, one)
    for picture in pictures:
        name = f"{picture.kind} of {picture.of}"
        body.append(markup.figure(picture.svg, picture.caption, name, not picture.wide))
    body += _values(number, one)
    return body


def _tables(number: int, one: Compare) -> list[str]:
    """Return the tables of groups and tests; all numbers carry the runs of their groups."""
    statistics = one.statistics
    assert statistics
    ids = {group.name: _ids(group) for group in one.groups}
    anchors = {group.name: f"c{number}-g{i}" for i, group in enumerate(one.groups, 1)}
    everything = tuple(id for runs in ids.values() for id in runs)

    def of_group(row: list[str], values: tuple[float, ...], median: float) -> list[Cell]:
        measure, name, *numbers = row
        runs, anchor = ids[name], anchors[name]
        cells = [Number(text, runs, anchor) for text in numbers]
        if median in values:  # The median is the value of one run.
            cells[1] = Number(numbers[1], (runs[values.index(median)],))
        return [measure, Link(name, anchor), *cells]

    def of_pair(row: list[str]) -> list[Cell]:
        measure, first, second, *numbers = row
        both, anchor = ids[first] + ids[second], f"c{number}"
        names = [Link(name, anchors[name]) for name in (first, second)]
        return [measure, *names, *(Number(text, both, anchor) for text in numbers)]

    summaries = [one for result in statistics.results for one in result.summaries]
    rows = [
        of_group(row, summary.values, summary.median)
        for row, summary in zip(tables.group_rows(statistics), summaries, strict=True)
    ]
    parts = [markup.table(tables.GROUPS, _named_once(rows))]
    overall = [
        [row[0], *(Number(text, everything, f"c{number}") for text in row[1:])]
        for row in tables.overall_rows(statistics)
    ]
    pairs = [of_pair(row) for row in tables.pair_rows(statistics)]
    parts += [markup.table(tables.OVERALL, overall)] if overall else []
    return parts + ([markup.table(tables.PAIRS, _named_once(pairs))] if pairs else [])


def _named_once(rows: list[list[Cell]]) -> list[list[Cell]]:
    """Return the rows; only the first row of a measure names it."""
    before = ["", *(row[0] for row in rows)]
    return [
        ["" if row[0] == above else row[0], *row[1:]]
        for row, above in zip(rows, before[:-1], strict=True)
    ]


def _aggregates(number: int, one: Compare) -> list[str]:
    ids, anchor = {group.name: _ids(group) for group in one.groups}, f"c{number}"
    means = [
        [measure, group, *(Number(text, ids[group], anchor) for text in numbers)]
        for measure, group, *numbers in tables.mean_rows(one.aggregates)
    ]
    improved = [
        [measure, a, b, *(Number(text, ids[a] + ids[b], anchor) for text in numbers)]
        for measure, a, b, *numbers in tables.improvement_rows(one.aggregates)
    ]
    parts = [markup.table(("measure", "group", "n", "IQM", "95 %"), means)]
    parts += [markup.table(tables.IMPROVEMENTS, improved)] if improved else []
    return [*parts, markup.paragraph(wording.aggregated(*one.aggregates), quiet=True)]


def _values(number: int, one: Compare) -> list[str]:
    """Return a table of every run's values, whose rows are also the lists of the groups."""
    statistics = one.statistics
    results = statistics.results if statistics else ()
    rows: list[list[Cell]] = []
    anchors = []
    for place, group in enumerate(one.groups):
        for i, run in enumerate(group.runs):
            texts = [wording.number(result.summaries[place].values[i]) for result in results]
            cells = [Number(text, (run.name,)) for text in texts]
            seed = Number(str(run.seed), (run.name,))
            rows.append([group.name, Link(run.name, f"run-{run.name}"), seed, *cells])
            anchors.append(f"c{number}-g{place + 1}" + (f"-{i}" if i else ""))
    titles = ["group", "run", "seed", *(result.measure.title for result in results)]
    return [
        markup.heading("Values of every run", f"c{number}", 3),
        markup.table(titles, rows, anchors),
    ]


def _runs(results: Results) -> list[str]:
    titles = ["run", "sweep", "case", "seed", "evaluations", "QD score", "coverage", "best"]
    rows: list[list[Cell]] = []
    for id, one in results.runs.items():
        last = [Measure(name).of(one.record) for name in ("qd_score", "coverage", "best")]
        numbers = [f"{int(one.record.evaluations[-1]):,}", *map(wording.number, last)]
        numbers = [str(one.record.seed), *numbers]
        cells = [Number(text, (id,)) for text in numbers]
        rows.append([id, one.run.sweep, _case(one.run) or "–", *cells, one.sha256[:12]])
    anchors = [f"run-{id}" for id in results.runs]
    return [
        markup.heading("Runs", "runs"),
        markup.paragraph(
            "A run is named by the SHA-256 of its spec, and its file is runs/RUN.h5. The last "
            "column is the beginning of the file's SHA-256."
        ),
        markup.table([*titles, "file"], rows, anchors),
    ]


def _case(run: PlannedRun) -> str:
    return ", ".join(f"{path} {value_text(value)}" for path, value in run.values.items())


def _specs(results: Results) -> list[str]:
    body = [markup.heading("Specs", "specs")]
    for name, base in results.plan.bases.items():
        sweep = results.plan.study.sweeps[name]
        given = sweep.spec if isinstance(sweep.spec, str) else "the spec in the study's file"
        seeds = sorted({run.spec.seed for run in results.plan.runs if run.sweep == name})
        parts = [f"{name}: {given}, seeds {', '.join(map(str, seeds))}"]
        parts += [f"{path} {value_text(value)}" for path, value in sweep.set.items()]
        for path, values in sweep.grid.items():
            parts.append(f"{path} of {', '.join(map(value_text, values))}")
        body.append(markup.paragraph("; ".join(parts) + "."))
        text = json.dumps(base.model_dump(mode="json"), indent=1)
        body.append(
            f"<details><summary>Whole spec of {escape(name)}</summary>"
            f"<pre>{escape(text)}</pre></details>"
        )
    return body


def _repeat(results: Results, source: bytes, command: str) -> list[str]:
    records = [one.record for one in results.runs.values()]
    versions = ", ".join(dict.fromkeys(record.version for record in records))
    devices = "; ".join(dict.fromkeys(x for record in records for x in record.devices))
    digest = hashlib.sha256(source).hexdigest()
    return [
        markup.heading("Repeat", "repeat"),
        markup.paragraph(
            f"Runs by Microcosmos {versions} on {devices}. Report by Microcosmos {VERSION}, "
            f"Python {platform.python_version()}, NumPy {numpy.__version__}, SciPy "
            f"{scipy.__version__}."
        ),
        f"<p>The command is <code>{escape(command)}</code>, with this file (SHA-256 "
        f"<code>{digest[:12]}</code>):</p>",
        f"<pre>{escape(source.decode())}</pre>",
    ]


def _ids(group: Group) -> tuple[str, ...]:
    return tuple(run.name for run in group.runs)
