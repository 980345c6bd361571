"""The curves of a run: what each is called, what it is of, and how people read it."""

from typing import Literal, NamedTuple


class Curve(NamedTuple):
    """A curve: its name within a sentence, a description, and what its values are."""

    title: str
    description: str
    of: Literal["fitness", "share", "count"]


_ELSE_NAN = "NaN where nothing was repeated"
CURVES = {
    "qd_score": Curve("QD score", "QD score", "fitness"),
    "coverage": Curve("coverage", "Coverage, from 0 to 1", "share"),
    "best": Curve("best fitness", "Best fitness; NaN without elites", "fitness"),
    "mean": Curve("mean fitness", "Mean fitness of elites; NaN without any", "fitness"),
    "evaluations": Curve("evaluations", "Evaluations so far", "count"),
    "infeasible": Curve("infeasible", "Infeasible evaluations so far", "count"),
    "clipped": Curve("clipped", "Evaluations beyond an end of an axis", "count"),
    "corrected_qd_score": Curve(
        "corrected QD score", f"Corrected QD score; {_ELSE_NAN}", "fitness"
    ),
    "corrected_coverage": Curve(
        "corrected coverage", f"Corrected coverage; {_ELSE_NAN}", "share"
    ),
    "hit_rate": Curve("hit rate", f"Share of repeats in their own cell; {_ELSE_NAN}", "share"),
}
SHARES = tuple(name for name, curve in CURVES.items() if curve.of == "share")
"""Curves from 0 to 1, which people read in per cent."""
COUNTS = tuple(name for name, curve in CURVES.items() if curve.of == "count")
SUMS = ("qd_score", "corrected_qd_score")
"""Curves that add up fitness."""
CORRECTED = ("corrected_qd_score", "corrected_coverage", "hit_rate")
"""Curves with values only where elites were evaluated again."""


def curve_title(name: str) -> str:
    """Return what a curve, also one that a part of the search records, is called."""
    return CURVES[name].title if name in CURVES else name.replace("_", " ")
