"""A physics audit: whether a creature swims by the fluid or by the way it is computed.

What the creature did is done again, the same rest shapes at the same times, in simulations
that should make no difference (at twice the resolution and half the step, with another
delta) and in one that should (its gait made reciprocal: Purcell, Am. J. Phys. 45, 3, 1977).
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from .. import bodies, build, search, spec, units, world
from ..archive import creature
from ..device import compiler_options, device_kind
from ..filaments import Rest
from ..genomes import Drive
from ..viz.replay import CELL_STEPS, actuator_of, unmeasured
from .variants import body_of, other_delta, reciprocal, refine, tireless, with_other_delta

AGREES = (0.5, 2.0)
"""Displacement along the way that was recorded, as a share of it, that counts as the same
swimming. Wide, since the delta thickens a filament by most of a cell: at twice the
resolution a slender swimmer is half as thick and does go further."""

IMPULSE = 1e-4
"""Momentum that a body may have given away on balance, float32."""

RECIPROCAL = 0.015
"""Share of its path that a reciprocal gait may cover, where viscosity rules."""

CREEPING = 1.0
"""Reynolds number below which the scallop theorem should be felt."""

WORK = 16
"""Cell steps of an audit, in those of the creature."""


@dataclass(frozen=True)
class Found:
    """What one simulation came to."""

    way: np.ndarray
    """(2,) displacement of the mean node, in the creature's own cells."""
    path: float
    """Mean way of a node, in cells."""
    mach: float
    limited: float
    reynolds: float
    impulse: float

    @property
    def distance(self) -> float:
        return float(np.hypot(*self.way))


def audit(file: Mapping[str, Any]) -> dict[str, Any]:
    """The audit of a creature file, as a JSON document described in `docs/formats.md`.

    Raises `creature.CreatureError` for a file that is not sound, too large, or diverges.
    """
    file = creature.parse(file)
    scene = unmeasured(creature.scene_of(file))
    work = WORK * scene.world.width * scene.world.height * scene.task.steps
    if work > CELL_STEPS:
        needed = f"at most {CELL_STEPS // WORK:.1e} cell steps for an audit"
        raise creature.CreatureError("task.steps", needed, work // WORK)
    task = build.build_task(scene)
    actuator = jax.tree.map(jnp.asarray, actuator_of(file, scene))
    driven = search.drive(task, actuator)
    nominal, rest = _simulate(task, driven)
    if not np.isfinite(nominal.distance):
        needed = "a creature whose simulation stays finite"
        raise creature.CreatureError("identity", needed, "one that diverges")
    body, rest = _made(scene, driven, rest)
    refined, _ = _follow(*refine(scene, rest, body))
    other, _ = _follow(with_other_delta(scene, body), rest)
    back, _ = _follow(tireless(scene, body), reciprocal(rest))
    rows = [
        *_soundness(scene, nominal),
        _remeasured(
            "refined", "at twice the resolution and half the step", nominal, refined, 0.5
        ),
        _remeasured("delta", f"with the delta {other_delta(scene)}", nominal, other, 1.0),
        _reciprocal(back),
    ]
    reasons = [row["note"] for row in rows if row["passed"] is False]
    survives = all(row["passed"] is not False for row in rows if row["name"] in VERDICT_ROWS)
    return {
        "creature": file["sha256"],
        "verdict": {"survives": survives, "reasons": reasons},
        "rows": rows,
        "device": device_kind(),
    }


VERDICT_ROWS = ("refined", "delta", "impulse")
"""Rows without which it is not swimming."""


def _made(scene: spec.Scene, driven: Drive, rest: Rest) -> tuple[bodies.Body, Rest]:
    """The body that a creature has, and the rest shapes of what there is of it."""
    try:
        body, joints, edges = body_of(scene, driven)
    except ValueError as error:
        needed = "a body that can be built anew"
        raise creature.CreatureError("identity.genome", needed, str(error)) from error
    angle, length = rest.angle[:, joints], rest.length[:, edges]
    return body, Rest(jnp.asarray(angle), jnp.asarray(length))


def _follow(task: search.Task, rest: Rest) -> tuple[Found, Rest]:
    return _simulate(task, search.drive(task, rest))


def _simulate(task: search.Task, driven: Drive) -> tuple[Found, Rest]:
    """What came of it, and the rest shapes that were applied."""

    def run(start, inputs):
        begun = replace(driven, start=start, inputs=inputs)
        end, watched = search.simulate(begun, partial(search.watch, driven.world))
        values = search.motion_of(task, begun, end, watched.observed)
        path = jnp.sum(watched.observed.node_speed)
        way = watched.observed.centre[-1] - world.centre(driven.world, start)
        return (
            way,
            path,
            jnp.max(watched.mach),
            values,
            search.impulse(watched),
            watched.observed.rest,
        )

    program = jax.jit(run, compiler_options=compiler_options())
    way, path, mach, values, push, rest = jax.device_get(program(driven.start, driven.inputs))
    found = Found(
        way=np.asarray(way, float),
        path=float(path),
        mach=float(mach),
        limited=float(values["limited"]),
        reynolds=float(values["reynolds"]),
        impulse=float(push),
    )
    return found, rest


def _row(name: str, quantity: str, value: float, unit: str, bar: str, passed, note: str):
    return {
        "name": name,
        "quantity": quantity,
        "value": value if np.isfinite(value) else None,
        "unit": unit,
        "bar": bar or None,
        "passed": None if passed is None else bool(passed),
        "note": note if passed is False else "",
    }


def _soundness(scene: spec.Scene, found: Found) -> list[dict[str, Any]]:
    """What the simulation itself shows."""
    free = scene.coupling.force_free
    return [
        _row("displacement", "displacement", found.distance, "cells", "", None, ""),
        _row("reynolds", "Reynolds number", found.reynolds, "", "", None, ""),
        _row(
            "mach",
            "largest Mach number",
            found.mach,
            "",
            f"at most {units.MAX_MACH}",
            found.mach <= units.MAX_MACH,
            "the flow is so fast that it is compressible",
        ),
        _row(
            "limited",
            "node steps at a limit",
            found.limited,
            "share",
            f"at most {units.MAX_LIMITED:g}",
            found.limited <= units.MAX_LIMITED,
            "limits act: they decide in part how it swims",
        ),
        _row(
            "impulse",
            "net impulse on the fluid",
            found.impulse,
            "lattice units",
            f"at most {IMPULSE:g}",
            found.impulse <= IMPULSE,
            "it pushes itself" + ("" if free else ": this form of the coupling lets it"),
        ),
    ]


def _remeasured(
    name: str, how: str, nominal: Found, again: Found, scale: float
) -> dict[str, Any]:
    """How far the same gait goes the same way in another simulation."""
    along = float(again.way @ nominal.way) * scale / max(nominal.distance, 1e-12)
    share = along / max(nominal.distance, 1e-12)
    low, high = AGREES
    return _row(
        name,
        f"displacement {how}",
        share,
        "of the recorded",
        f"{low:g} to {high:g}",
        low <= share <= high,
        f"{how}, it goes {share:.2f} times as far",
    )


def _reciprocal(back: Found) -> dict[str, Any]:
    creeping = back.reynolds < CREEPING
    share = back.distance / max(back.path, 1e-12)
    return _row(
        "reciprocal",
        "displacement of the gait made reciprocal",
        share,
        "of the path",
        f"at most {RECIPROCAL:g} below Reynolds number {CREEPING:g}",
        share <= RECIPROCAL if creeping else None,
        "made reciprocal, it still swims where inertia hardly counts",
    )
