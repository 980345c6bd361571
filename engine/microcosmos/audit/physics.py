"""The physics audit: tell swimming by physics from artefacts of the method.

The same rest shapes at the same times are simulated again: in ways that should make no
difference (at twice the resolution and half the step, with another delta), and in one that
should (the gait made reciprocal: Purcell, Am. J. Phys. 45, 3, 1977).
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
from .variants import (
    at_full_strength,
    body_of,
    other_delta,
    reciprocal,
    refine,
    with_other_delta,
)

AGREEING_RANGE = (0.5, 2.0)
"""Range of displacement, relative to the recorded one, that counts as the same swimming.

The range is wide because the delta thickens a filament by most of a cell: at twice the
resolution a slender swimmer is half as thick and goes further.
"""

MAX_IMPULSE = 1e-4
"""Largest net momentum given by a body, float32."""

MAX_RECIPROCAL = 0.015
"""Largest displacement of a reciprocal gait in creeping flow, as a share of its path."""

CREEPING_REYNOLDS = 1.0
"""Reynolds number below which the scallop theorem holds."""

COST_RATIO = 16
"""Ratio of an audit's cell steps to those of the creature."""


@dataclass(frozen=True)
class Simulation:
    """The result of one simulation."""

    displacement: np.ndarray
    """(2,) displacement of the mean node, in the creature's own cells."""
    path: float
    """Mean path of a node, in cells."""
    mach: float
    limited: float
    reynolds: float
    impulse: float

    @property
    def distance(self) -> float:
        return float(np.hypot(*self.displacement))


def audit(file: Mapping[str, Any]) -> dict[str, Any]:
    """Return the audit of a creature file, as a JSON document described in `docs/formats.md`.

    Raises `creature.CreatureError` for a file that is invalid, too large, or diverges.
    """
    file = creature.parse(file)
    scene = unmeasured(creature.scene_of(file))
    work = COST_RATIO * scene.world.width * scene.world.height * scene.task.steps
    if work > CELL_STEPS:
        needed = f"at most {CELL_STEPS // COST_RATIO:.1e} cell steps for an audit"
        raise creature.CreatureError("task.steps", needed, work // COST_RATIO)
    task = build.build_task(scene)
    actuator = jax.tree.map(jnp.asarray, actuator_of(file, scene))
    driven = search.drive(task, actuator)
    nominal, rest = _simulate(task, driven)
    if not np.isfinite(nominal.distance):
        needed = "a creature whose simulation stays finite"
        raise creature.CreatureError("identity", needed, "one that diverges")
    body, rest = _developed(scene, driven, rest)
    refined, _ = _simulate_rest(*refine(scene, rest, body))
    other, _ = _simulate_rest(with_other_delta(scene, body), rest)
    back, _ = _simulate_rest(at_full_strength(scene, body), reciprocal(rest))
    rows = [
        *_simulation_rows(scene, nominal),
        _agreement_row(
            "refined", "at twice the resolution and half the step", nominal, refined, 0.5
        ),
        _agreement_row("delta", f"with the delta {other_delta(scene)}", nominal, other, 1.0),
        _reciprocal_row(back),
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
"""Rows that must pass for the creature to survive."""


def _developed(scene: spec.Scene, driven: Drive, rest: Rest) -> tuple[bodies.Body, Rest]:
    try:
        body, joints, edges = body_of(scene, driven)
    except ValueError as error:
        needed = "a body that can be built again"
        raise creature.CreatureError("identity.genome", needed, str(error)) from error
    angle, length = rest.angle[:, joints], rest.length[:, edges]
    return body, Rest(jnp.asarray(angle), jnp.asarray(length))


def _simulate_rest(task: search.Task, rest: Rest) -> tuple[Simulation, Rest]:
    return _simulate(task, search.drive(task, rest))


def _simulate(task: search.Task, driven: Drive) -> tuple[Simulation, Rest]:
    def run(start, inputs):
        begun = replace(driven, start=start, inputs=inputs)
        end, watched = search.simulate(begun, partial(search.watch, driven.world))
        seen = watched.observed
        values, path = search.motion_of(task, begun, end, seen), jnp.sum(seen.node_speed)
        displacement = seen.centre[-1] - world.centre(driven.world, start)
        mach, push = jnp.max(watched.mach), search.impulse(watched)
        return displacement, path, mach, values, push, seen.rest

    program = jax.jit(run, compiler_options=compiler_options())
    results = jax.device_get(program(driven.start, driven.inputs))
    displacement, path, mach, values, push, rest = results
    found = Simulation(
        displacement=np.asarray(displacement, float),
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


def _simulation_rows(scene: spec.Scene, found: Simulation) -> list[dict[str, Any]]:
    pushed = "" if scene.coupling.force_free else ": this form of the coupling allows it"
    fast = "the flow is so fast that it is compressible"
    limits = "limits are active and in part determine how it swims"
    bounded = (
        ("mach", "largest Mach number", found.mach, "", units.MAX_MACH, fast),
        ("limited", "node steps at a limit", found.limited, "share", units.MAX_LIMITED, limits),
        ("impulse", "net impulse on the fluid", found.impulse, "lattice units", MAX_IMPULSE,
         "it pushes itself" + pushed),
    )  # fmt: skip
    return [
        _row("displacement", "displacement", found.distance, "cells", "", None, ""),
        _row("reynolds", "Reynolds number", found.reynolds, "", "", None, ""),
        *(
            _row(name, quantity, value, unit, f"at most {most:g}", value <= most, note)
            for name, quantity, value, unit, most, note in bounded
        ),
    ]


def _agreement_row(
    name: str, how: str, nominal: Simulation, again: Simulation, scale: float
) -> dict[str, Any]:
    product = float(again.displacement @ nominal.displacement)
    along = product * scale / max(nominal.distance, 1e-12)
    share = along / max(nominal.distance, 1e-12)
    low, high = AGREEING_RANGE
    return _row(
        name,
        f"displacement {how}",
        share,
        "of the recorded",
        f"{low:g} to {high:g}",
        low <= share <= high,
        f"{how}, it goes {share:.2f} times as far",
    )


def _reciprocal_row(back: Simulation) -> dict[str, Any]:
    creeping = back.reynolds < CREEPING_REYNOLDS
    share = back.distance / max(back.path, 1e-12)
    return _row(
        "reciprocal",
        "displacement of the gait made reciprocal",
        share,
        "of the path",
        f"at most {MAX_RECIPROCAL:g} below Reynolds number {CREEPING_REYNOLDS:g}",
        share <= MAX_RECIPROCAL if creeping else None,
        "made reciprocal, it still swims although inertia is negligible",
    )
