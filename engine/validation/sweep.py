"""Check of the five known swimmers at every viscosity, against the Microcosmos paper."""

import os
from unittest.mock import patch

from microcosmos import build, device
from microcosmos.spec import Gaits

from .paths import JAX, Path
from .rows import Line, Plot, Result, Row, at_most, holds

PAPER = "Microcosmos paper 2026, Hand-designed Locomotion"

Curves = dict[str, dict[float, float]]
"""Cells a cycle by swimmer and viscosity."""


def swim(chosen: Gaits, path: Path = JAX) -> dict[str, Curves]:
    """Carry out a sweep and return the curves of every form."""
    with patch.dict(os.environ, {device.KERNEL_VARIABLE: path.choice}):
        experiment = build.build_gaits(chosen)
        state = experiment.init()
        while not experiment.done(state):
            state, _ = experiment.advance(state)
    forms: dict[str, Curves] = {}
    for values in (row.values for row in state.rows):
        far = values["displacement"]
        curves = forms.setdefault(str(values["form"]), {})
        curve = curves.setdefault(str(values["swimmer"]), {})
        curve[float(values["viscosity"] or 0)] = float("nan") if far is None else float(far)
    return forms


def check(
    chosen: Gaits | None = None,
    *,
    creeping: float = 0.05,
    rest: float = 0.1,
    path: Path = JAX,
) -> Result:
    """Return rows for each force-free form, and a plot for each form.

    Inertia is negligible from the viscosity `creeping` on. At the highest viscosity a
    reciprocal swimmer may reach at most the share `rest` of its best.
    """
    rows, plots = [], []
    for form, curves in swim(chosen or Gaits(), path).items():
        if form != "paper":
            rows += _rows(form, curves, creeping, rest)
        lines = [Line(name, list(c), list(c.values()), "o-") for name, c in curves.items()]
        axes = "viscosity (cells²/step)", "cells a cycle"
        plots.append(Plot(f"gaits-{form}", *axes, tuple(lines), logarithmic="x"))
    return Result(rows, plots)


def _rows(form: str, curves: Curves, creeping: float, rest: float) -> list[Row]:
    worm, tadpole, ray, cilia = (curves[n] for n in ("worm", "tadpole", "ray", "cilia"))
    slow, highest = [nu for nu in cilia if nu >= creeping], max(cilia)
    wins = all(worm[nu] > tadpole[nu] for nu in worm)
    share = ray[highest] / max(ray.values())
    leads = all(cilia[nu] > max(worm[nu], tadpole[nu], ray[nu]) for nu in slow)
    what = f"{form}: cilia are ahead of worm, tadpole and ray from ν {creeping:g} on"
    rows = [
        holds(f"{form}: the worm is ahead of the tadpole at every viscosity", wins, PAPER),
        at_most(
            f"{form}: the ray at ν {highest:g}, as a share of its best", share, rest, PAPER
        ),
        holds(what, leads, PAPER),
    ]
    if form == "ours":
        slows = all(curve[highest] < 0.65 * max(curve.values()) for curve in curves.values())
        what = f"{form}: all are below 65 % of their best at ν {highest:g}"
        rows.append(holds(what, slows, PAPER))
    return rows
