"""The five known swimmers at every viscosity: what the Microcosmos paper says of them."""

from microcosmos import build
from microcosmos.spec import Gaits

from .rows import Found, Line, Plot, Row, at_most, holds

PAPER = "Microcosmos paper 2026, Hand-designed Locomotion"

Curves = dict[str, dict[float, float]]
"""Cells a cycle by swimmer and viscosity."""


def swum(chosen: Gaits) -> dict[str, Curves]:
    """The curves of every form of a sweep."""
    experiment = build.build_gaits(chosen)
    state = experiment.init()
    while not experiment.done(state):
        state, _ = experiment.advance(state)
    found: dict[str, Curves] = {}
    for row in state.rows:
        values = row.values
        curves = found.setdefault(str(values["form"]), {})
        far = values["displacement"]
        curve = curves.setdefault(str(values["swimmer"]), {})
        curve[float(values["viscosity"] or 0)] = float("nan") if far is None else float(far)
    return found


def check(chosen: Gaits | None = None, *, creeping: float = 0.05, rest: float = 0.1) -> Found:
    """Rows for each force-free form, and a plot for each form.

    From the viscosity `creeping` on viscosity rules; `rest` is the share of its best that a
    reciprocal swimmer may keep at the highest viscosity.
    """
    found = swum(chosen or Gaits())
    rows = [
        row
        for form in found
        if form != "paper"
        for row in _rows(form, found[form], creeping, rest)
    ]
    plots = [
        Plot(
            name=f"gaits-{form}",
            x="viscosity (cells²/step)",
            y="cells a cycle",
            lines=tuple(
                Line(swimmer, list(curve), list(curve.values()), "o-")
                for swimmer, curve in curves.items()
            ),
            logarithmic="x",
        )
        for form, curves in found.items()
    ]
    return Found(rows, plots)


def _rows(form: str, curves: Curves, creeping: float, rest: float) -> list[Row]:
    worm, tadpole, ray, cilia = (curves[n] for n in ("worm", "tadpole", "ray", "cilia"))
    slow = [nu for nu in cilia if nu >= creeping]
    most = max(cilia)
    rows = [
        holds(
            f"{form}: the worm is ahead of the tadpole at every viscosity",
            all(worm[nu] > tadpole[nu] for nu in worm),
            PAPER,
        ),
        at_most(
            f"{form}: the ray at ν {most:g}, as a share of its best",
            ray[most] / max(ray.values()),
            rest,
            PAPER,
        ),
        holds(
            f"{form}: cilia are ahead of worm, tadpole and ray from ν {creeping:g} on",
            all(cilia[nu] > max(worm[nu], tadpole[nu], ray[nu]) for nu in slow),
            PAPER,
        ),
    ]
    if form == "ours":
        best = {name: max(curve.values()) for name, curve in curves.items()}
        slowing = all(curve[most] < 0.65 * best[name] for name, curve in curves.items())
        rows.append(
            holds(f"{form}: all are below 65 % of their best at ν {most:g}", slowing, PAPER)
        )
    return rows
