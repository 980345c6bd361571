"""A comparison as rows, text, CSV, JSON and LaTeX; aggregates over tasks as text and JSON."""

import csv as csv_module
import json as json_module
import re
from collections.abc import Sequence
from dataclasses import asdict
from io import StringIO
from math import isfinite
from typing import Any

from ..latex import latex as escaped
from . import wording
from .aggregates import Aggregates
from .comparison import Comparison, Pair, Result, Summary

Cells = list[list[str]]
GROUPS = ("measure", "group", "n", "median", "quartiles", "IQM", "95 %")
PAIRS = ("measure", "first", "second", "U", "p", "p (Holm)", "A12", "95 %")
OVERALL = ("measure", "groups", "H", "p")
MEANS = ("measure", "group", "runs", "IQM", "95 %")
IMPROVEMENTS = ("measure", "first", "second", "P(first > second)", "95 %")
INTERVALS = ("quartiles", "95 %")
"""Columns with two numbers in a cell."""
RANGE = re.compile(r"[\d.,e+]+ to [\d.,e+]+")
"""An interval with two numbers, neither below 0: a dash before a minus is hard to read."""
SYMBOLS = {"A12": "$A_{12}$", "U": "$U$", "H": "$H$", "p": "$p$"}
"""Titles of columns that LaTeX sets as mathematics."""
COLUMNS = (
    *("table", "measure", "group", "other", "n", "low", "median", "high"),
    *("iqm", "iqm_low", "iqm_high", "test", "statistic", "p", "p_holm"),
    *("a12", "a12_low", "a12_high", "run", "seed", "value"),
)
"""Columns of the CSV: one row for each group, test and run, with empty cells."""


def group_rows(comparison: Comparison) -> Cells:
    """Return a row for each measure and group, under `GROUPS`."""
    return [
        [
            result.measure.title,
            one.group,
            str(one.count),
            wording.number(one.median),
            wording.interval((one.low, one.high)),
            wording.number(one.middle_mean),
            wording.interval(one.interval),
        ]
        for result in comparison.results
        for one in result.summaries
    ]


def pair_rows(comparison: Comparison) -> Cells:
    """Return a row for each measure and pair of groups, under `PAIRS`."""
    return [
        [
            result.measure.title,
            pair.first,
            pair.second,
            f"{pair.test.statistic:g}",
            wording.probability(pair.test.p),
            wording.probability(pair.p),
            f"{pair.superiority:.2f}",
            f"{pair.interval[0]:.2f} to {pair.interval[1]:.2f}",
        ]
        for result in comparison.results
        for pair in result.pairs
    ]


def overall_rows(comparison: Comparison) -> Cells:
    """Return a row for each measure's test over all groups, under `OVERALL`."""
    return [
        [
            result.measure.title,
            str(len(comparison.groups)),
            f"{result.overall.statistic:.4g}",
            wording.probability(result.overall.p),
        ]
        for result in comparison.results
        if result.overall
    ]


def _tables(comparison: Comparison) -> list[tuple[Sequence[str], Cells, str]]:
    """Return titles, rows and LaTeX columns of the tables that have rows."""
    tables = [
        (GROUPS, group_rows(comparison), "llrrrrr"),
        (OVERALL, overall_rows(comparison), "lrrr"),
        (PAIRS, pair_rows(comparison), "lllrrrrr"),
    ]
    return [one for one in tables if one[1]]


def _sentences(comparison: Comparison) -> list[str]:
    stated = [wording.groups(comparison), wording.method(comparison)]
    return stated + wording.cautions(comparison)


def text(comparison: Comparison) -> str:
    """Return tables for a terminal, then sentences on groups, tests and intervals."""
    parts = [_aligned(titles, rows) for titles, rows, _ in _tables(comparison)]
    return "\n\n".join(parts + _sentences(comparison)) + "\n"


def _aligned(titles: Sequence[str], rows: Cells) -> str:
    lines = [list(titles), *rows]
    widths = [max(len(line[i]) for line in lines) for i in range(len(titles))]
    return "\n".join(
        "  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)).rstrip()
        for line in lines
    )


def csv(comparison: Comparison) -> str:
    """Return a row for each group, test and run, with full precision."""
    text = StringIO()
    writer = csv_module.DictWriter(text, COLUMNS, restval="", lineterminator="\n")
    writer.writeheader()
    for result in comparison.results:
        measure = {"measure": result.measure.text}
        writer.writerows(measure | _summary(one) for one in result.summaries)
        if result.overall:
            writer.writerow(measure | {"table": "all groups"} | vars_of(result.overall))
        writer.writerows(measure | _pair(pair) for pair in result.pairs)
        writer.writerows(measure | row for row in _runs(comparison, result))
    return text.getvalue()


def _summary(one: Summary) -> dict[str, Any]:
    low, high = one.interval or ("", "")
    return {
        "table": "group",
        "group": one.group,
        "n": one.count,
        "low": one.low,
        "median": one.median,
        "high": one.high,
        "iqm": one.middle_mean,
        "iqm_low": low,
        "iqm_high": high,
    }


def _pair(pair: Pair) -> dict[str, Any]:
    low, high = pair.interval
    effect = {"a12": pair.superiority, "a12_low": low, "a12_high": high, "p_holm": pair.p}
    ends = {"table": "pair", "group": pair.first, "other": pair.second}
    return ends | vars_of(pair.test) | effect


def vars_of(test: Any) -> dict[str, Any]:
    return {"test": test.name, "statistic": test.statistic, "p": test.p}


def _runs(comparison: Comparison, result: Result) -> list[dict[str, Any]]:
    return [
        {"table": "run", "group": group.name, "run": run.name, "seed": run.seed, "value": value}
        for group, one in zip(comparison.groups, result.summaries, strict=True)
        for run, value in zip(group.runs, one.values, strict=True)
    ]


def document(comparison: Comparison) -> dict[str, Any]:
    """Return all of a comparison as JSON's values; null where a run does not reach a value, or
    has no elites."""
    return {
        "groups": [
            {
                "name": group.name,
                "n": len(group.runs),
                "runs": [{"run": run.name, "seed": run.seed} for run in group.runs],
            }
            for group in comparison.groups
        ],
        "differences": comparison.differences,
        "measures": [_result(result) for result in comparison.results],
        "refusal": comparison.refusal or None,
        "groups_in_words": wording.groups(comparison),
        "method": wording.method(comparison),
        "cautions": wording.cautions(comparison),
        "tests": comparison.tests,
        "bootstrap": {
            "resamples": comparison.bootstrap.resamples,
            "seed": comparison.bootstrap.seed,
        },
        "versions": list(comparison.versions),
    }


def _result(result: Result) -> dict[str, Any]:
    numbers = [
        {"values": [_plain(x) for x in one.values]}
        | {k: _plain(v) for k, v in _summary(one).items() if k != "table"}
        for one in result.summaries
    ]
    pairs = [{k: v for k, v in _pair(pair).items() if k != "table"} for pair in result.pairs]
    return {
        "measure": result.measure.text,
        "title": result.measure.title,
        "less_is_better": result.measure.less_is_better,
        "groups": numbers,
        "overall": vars_of(result.overall) if result.overall else None,
        "pairs": pairs,
    }


def _plain(value: Any) -> Any:
    if isinstance(value, float):
        return value if isfinite(value) else None
    return None if value == "" else value


def json(comparison: Comparison) -> str:
    return json_module.dumps(document(comparison), indent=1, ensure_ascii=False) + "\n"


def latex(comparison: Comparison) -> str:
    """Return tables for LaTeX with booktabs, and the caption as a comment."""
    parts = [_tabular(*one) for one in _tables(comparison)]
    caption = escaped(" ".join(_sentences(comparison)))
    return f"% \\usepackage{{booktabs}}\n% \\caption{{{caption}}}\n" + "\n\n".join(parts) + "\n"


def _tabular(titles: Sequence[str], rows: Cells, columns: str) -> str:
    head = _row([SYMBOLS.get(title, escaped(title)) for title in titles])
    lines = [f"\\begin{{tabular}}{{{columns}}}", "\\toprule", head, "\\midrule"]
    before, several = "", len({row[0] for row in rows}) < len(rows)
    for row in rows:
        if several and before and row[0] != before:
            lines.append("\\addlinespace")
        shown = ["" if row[0] == before else row[0], *row[1:]]
        cells = zip(shown, titles, columns, strict=True)
        lines.append(_row([_cell(*one) for one in cells]))
        before = row[0]
    return "\n".join([*lines, "\\bottomrule", "\\end{tabular}"])


def _row(cells: Sequence[str]) -> str:
    return " & ".join(cells) + r" \\"


def _cell(text: str, title: str, column: str) -> str:
    """Return a cell for LaTeX; columns on the right have numbers, all others words."""
    if column == "l":
        return escaped(text)
    # In text mode LaTeX sets a minus as a hyphen (test_latex_keeps_minus_signs_and_words).
    cell = escaped(text.replace("< ", "<")).replace("-", "$-$")
    if title in INTERVALS and RANGE.fullmatch(text):
        cell = cell.replace(" to ", "--")
    return cell


def mean_rows(several: Sequence[Aggregates]) -> Cells:
    """Return a row for each measure and group over all tasks, under `MEANS`."""
    return [
        [
            found.measure.title,
            one.group,
            str(one.runs),
            wording.number(one.middle_mean),
            wording.interval(one.interval),
        ]
        for found in several
        for one in found.groups
    ]


def improvement_rows(several: Sequence[Aggregates]) -> Cells:
    """Return a row for each measure and pair of groups, under `IMPROVEMENTS`."""
    return [
        [
            found.measure.title,
            one.first,
            one.second,
            f"{one.probability:.2f}",
            wording.interval(one.interval),
        ]
        for found in several
        for one in found.improvements
    ]


def aggregates_text(several: Sequence[Aggregates]) -> str:
    """Return tables for a terminal: the mean of the middle half, and improvements."""
    tables = ((MEANS, mean_rows(several)), (IMPROVEMENTS, improvement_rows(several)))
    parts = [_aligned(titles, rows) for titles, rows in tables if rows]
    return "\n\n".join([*parts, wording.aggregated(*several)]) + "\n"


def aggregates_json(several: Sequence[Aggregates]) -> str:
    """Return all of the aggregates as JSON, with the performance profiles."""
    documents = [
        asdict(one)
        | {"measure": one.measure.text, "cautions": wording.cautions_over_tasks([one])}
        for one in several
    ]
    return json_module.dumps(documents, indent=1, ensure_ascii=False) + "\n"
