"""Captions of figures that compare groups: specs, seeds, n, tests and correction."""

from math import inf

from ...spec.differences import short
from ...statistics import Aggregates, Comparison, wording
from .caption import run
from .reading import Described


def of_boxes(found: Comparison) -> str:
    """Return the caption of boxes with all points."""
    first = (
        f"{_measures(found)}: every run (points), the median of each group (line) and the "
        "quartiles (box)."
    )
    return " ".join([first, *_triangles(found), *_stated(found)])


def of_parameter(found: Comparison, path: str) -> str:
    """Return the caption of measures against a parameter."""
    first = (
        f"{_measures(found)} against {short(path)} (`{path}`): median over seeds (line), band "
        "between the quartiles, every run (points)."
    )
    return " ".join([first, *_triangles(found), *_stated(found)])


def of_profiles(found: Aggregates, first_run: Described) -> str:
    """Return the caption of performance profiles."""
    band = "" if found.refusal else ", with 95 % bands"
    first = (
        f"Performance profiles of {found.measure.title}: the share of runs with a greater "
        f"score{band}."
    )
    return " ".join([first, wording.aggregated(found), _rest(first_run)])


def _triangles(found: Comparison) -> list[str]:
    """Return what the triangles of a figure are, if it has any."""
    values = {x for result in found.results for one in result.summaries for x in one.values}
    said = {
        inf: "Triangles at the top are runs that do not reach the value.",
        -inf: "Triangles at the bottom are runs without elites.",
    }
    return [text for value, text in said.items() if value in values]


def _measures(found: Comparison) -> str:
    titles = [result.measure.title for result in found.results]
    letters = [f"({chr(97 + i)}) " if len(titles) > 1 else "" for i in range(len(titles))]
    named = ", ".join(map("".join, zip(letters, titles, strict=True)))
    return named if len(titles) > 1 else named[0].upper() + named[1:]


def _stated(found: Comparison) -> list[str]:
    said = [wording.groups(found), wording.tested(found), wording.results(found)]
    said += wording.cautions(found)
    return [one for one in said if one] + [_rest(found.groups[0].runs[0])]


def _rest(first: Described) -> str:
    return f"All else as in the first run: {run(first, seeds=())}"
