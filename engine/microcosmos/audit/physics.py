"""The physics audit: tell swimming by physics from artefacts of the method.

The same rest shapes at the same times are simulated again: in ways that should make no
difference (with wider limits and without, on a finer grid, with another delta, turned), and in
one that should (the gait made reciprocal: Purcell, Am. J. Phys. 45, 3, 1977). A creature is
trusted if it passes every bar.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
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
    alone,
    at_full_strength,
    body_of,
    other_delta,
    reciprocal,
    refine,
    turned,
    with_limits,
    with_other_delta,
)

RANGES = {
    "wider limits": (0.98, 1.02),
    "no limits": (0.95, 1.05),
    "refined": (0.67, 1.5),
    "delta": (0.67, 1.5),
    "heading": (0.85, 1.15),
}
"""Ranges of displacement, relative to the recorded one, that count as the same swimming.

Those of `refined` and `delta` are wide because the delta thickens a filament by most of a cell:
on a grid of half the spacing a slender swimmer is half as thick and goes further.
"""

HEADING = np.pi / 4
"""Turn of the body at the start, in rad: half way between directions of the lattice."""

MAX_RECIPROCAL = 0.015
"""Largest displacement of a reciprocal gait in creeping flow, as a share of its path."""

CREEPING_REYNOLDS = 1.0
"""Reynolds number below which the scallop theorem holds."""

COST_RATIO = 22
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
    crossing: float

    @property
    def distance(self) -> float:
        return float(np.hypot(*self.displacement))


def audit(file: Mapping[str, Any]) -> dict[str, Any]:
    """Return the audit of a creature file, as a JSON document described in `docs/formats.md`.

    Raises `creature.CreatureError` for a file that is invalid, too large, or diverges.
    """
    file = creature.parse(file)
    scene = alone(unmeasured(creature.scene_of(file)))
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
    # At full strength: a soft body lags behind a reciprocal gait, and its motion is not one.
    back, _ = _simulate_rest(at_full_strength(scene, body), reciprocal(rest))
    rows = [
        *_simulation_rows(scene, nominal),
        *_agreement_rows(scene, rest, body, nominal),
        _reciprocal_row(back, scene.world.flow is None),
    ]
    failed = [row for row in rows if row["passed"] is False]
    return {
        "creature": file["sha256"],
        "verdict": {"trusted": not failed, "reasons": [row["note"] for row in failed]},
        "rows": rows,
        "device": device_kind(),
    }


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
        end, seen = search.simulate(begun)
        values, path = search.motion_of(task, begun, end, seen), jnp.sum(seen.node_speed)
        values["crossing"] = search.crossing(
            search.poses_of(task, begun, seen), start.positions
        )
        displacement = world.route(driven.world, start, seen).way(0, -1)
        return displacement, path, values, seen.rest

    program = jax.jit(run, compiler_options=compiler_options())
    results = jax.device_get(program(driven.start, driven.inputs))
    displacement, path, values, rest = results
    simulation = Simulation(
        displacement=np.asarray(displacement, float),
        path=float(path),
        mach=float(values["mach"]),
        limited=float(values["limited"]),
        reynolds=float(values["reynolds"]),
        impulse=float(values["impulse"]),
        crossing=float(values["crossing"]),
    )
    return simulation, rest


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


def _simulation_rows(scene: spec.Scene, simulation: Simulation) -> list[dict[str, Any]]:
    pushed = "" if scene.coupling.force_free else ": this form of the coupling allows it"
    fast = "the flow is so fast that it is compressible"
    limits = "limits are active and in part determine how it swims"
    bounded = (
        ("mach", "largest Mach number", simulation.mach, "", units.MAX_MACH, fast),
        ("limited", "node steps at a limit", simulation.limited, "share",
         units.MAX_LIMITED, limits),
        ("impulse", "net impulse on the fluid", simulation.impulse, "lattice units",
         units.MAX_IMPULSE, "it pushes itself" + pushed),
        ("crossing", "poses in which filaments cross", simulation.crossing, "share",
         units.MAX_CROSSING, "filaments pass through each other"),
    )  # fmt: skip
    return [
        _row("displacement", "displacement", simulation.distance, "cells", "", None, ""),
        _row("reynolds", "Reynolds number", simulation.reynolds, "", "", None, ""),
        *(
            _row(name, quantity, value, unit, f"at most {most:g}", value <= most, note)
            for name, quantity, value, unit, most, note in bounded
        ),
    ]


def _agreement_rows(
    scene: spec.Scene, rest: Rest, body: bodies.Body, nominal: Simulation
) -> list[dict[str, Any]]:
    """Return the rows of simulations that should agree with the recorded one."""
    finer, shapes = refine(scene, rest, body)
    c, s = np.cos(HEADING), np.sin(HEADING)
    along = nominal.displacement
    expected = {"refined": 2 * along, "heading": np.array([[c, -s], [s, c]]) @ along}
    variants = [
        ("refined", "on half the grid spacing with a quarter of the step", finer, shapes)
    ]
    # Without limits both variants would be the recorded simulation.
    if scene.coupling.limits:
        wide, free = with_limits(scene, body, 2.0), with_limits(scene, body, None)
        variants += [("wider limits", "with limits doubled", wide, rest)]
        variants += [("no limits", "without limits", free, rest)]
    variants += [
        ("delta", f"with the delta {other_delta(scene)}", with_other_delta(scene, body), rest),
    ]
    if scene.world.open:  # Else directions differ.
        variants += [("heading", "with a heading of 45°", turned(scene, body, HEADING), rest)]
    return [
        _agreement_row(name, how, expected.get(name, along), _simulate_rest(task, shapes)[0])
        for name, how, task, shapes in variants
    ]


def _agreement_row(
    name: str, how: str, expected: np.ndarray, simulation: Simulation
) -> dict[str, Any]:
    # The part along the expected direction: as far in another direction is no agreement.
    share = float(simulation.displacement @ expected) / max(float(expected @ expected), 1e-24)
    low, high = RANGES[name]
    return _row(
        name,
        f"displacement {how}",
        share,
        "of the recorded",
        f"{low:g} to {high:g}",
        low <= share <= high,
        f"{how}, it goes {share:.2f} times as far"
        if np.isfinite(share)
        else f"{how}, its simulation does not stay finite",
    )


def _reciprocal_row(back: Simulation, at_rest: bool) -> dict[str, Any]:
    share = back.distance / max(back.path, 1e-12)
    finite = np.isfinite(share) and np.isfinite(back.reynolds)
    creeping = at_rest and not back.reynolds >= CREEPING_REYNOLDS
    return _row(
        "reciprocal",
        "displacement of the gait made reciprocal",
        share,
        "of the path",
        f"at most {MAX_RECIPROCAL:g} below Reynolds number {CREEPING_REYNOLDS:g}",
        share <= MAX_RECIPROCAL if creeping else None,
        "made reciprocal, it still swims although inertia is negligible"
        if finite
        else "made reciprocal, its simulation does not stay finite",
    )
