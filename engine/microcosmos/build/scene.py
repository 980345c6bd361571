"""Build the world, the body and the task of a scene."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import jax.numpy as jnp
import numpy as np

from .. import (
    bodies,
    coupling,
    fields,
    filaments,
    fluid,
    genomes,
    groups,
    search,
    spec,
    world,
)
from ..bodies import extent, is_exact
from ..device import array
from ..naming import FORMS
from ..spec.search import MEASURED
from .encodings import build_encoding
from .plugins import build_measures, strokes_of
from .surroundings import build_barrier, build_start, build_surroundings

PROJECTIONS = {
    "none": coupling.unprojected,
    "force": coupling.force_free,
    "force+torque": coupling.torque_free,
}
KERNELS = {"peskin": coupling.PESKIN, "roma": coupling.ROMA, "hat": coupling.HAT}
MAGIC = {"capped": fluid.capped_magic, "fixed": fluid.fixed_magic}
SMOOTHING = {"gaussian": fields.gaussian, "binomial": fields.binomial}
ROOM = (8, 8)
"""Default number of nodes and connections of networks that are not varied."""
Matching = Callable[[bodies.Body, float, Any, Any], filaments.Layout | None]
GOALS = {"displacement": (1.0, 0.0), "energy": (0.0, 1.0), "displacement+energy": (1.0, 1.0)}


def build_task(
    scene: spec.Scene,
    dtype: Any = jnp.float32,
    *,
    room: tuple[int, int] | None = None,
    body: bodies.Body | None = None,
) -> search.Task:
    """Build the world with the body at rest in its middle, and the encoding of genotypes.

    `room` is the number of nodes and connections of networks; `body` replaces the scene's body
    by the one that a genotype has grown.
    """
    body = spec.shape(scene.body) if body is None else body
    matching = matching_of(scene.body)
    box = build_world(scene.world, scene.coupling, body, dtype, matching=matching)
    middle = np.array([scene.world.width, scene.world.height]) / 2
    positions = body.positions - body.positions.mean(0) + middle
    start = build_start(scene.world, box, positions)
    gait = isinstance(scene.control, spec.Gait)
    encoding = None if gait else build_encoding(scene, room or ROOM)
    return search.Task(
        box,
        start,
        encoding,
        build_goal(scene.task),
        extent(body),
        placements=build_placements(scene.world),
        places=build_places(scene.world, dtype),
        plugin_measures=build_measures(scene),
        actuators=build_actuators(scene.control, body, dtype),
        period=build_period(scene.control),
        form=build_form(body),
        trials=scene.task.trials,
    )


def build_form(body: bodies.Body) -> tuple[float, ...]:
    """Build the measures of form of a body that does not grow."""
    pieces = len(np.unique(bodies.pieces(body.edges, len(body.positions))))
    every = np.ones(len(body.positions), bool), np.ones(len(body.edges), bool)
    found = bodies.growth.form(body.positions, body.edges, *every, pieces=pieces)
    return tuple(float(np.float32(found[name])) for name in FORMS)


def build_actuators(
    control: spec.Controller | spec.Gait | spec.Fold,
    body: bodies.Body,
    dtype: Any = jnp.float32,
) -> genomes.Actuators | None:
    """Build the bounds on a controller's commands; None if there are none."""
    if isinstance(control, spec.Gait | spec.Fold) or not control.bounded:
        return None
    return genomes.Actuators(
        build_layout(body, dtype), control.max_speed, control.lag, control.max_bend
    )


def build_period(control: spec.Controller | spec.Gait | spec.Fold) -> float | None:
    """Return the steps of a stroke; None for a controller without a periodic timer."""
    if isinstance(control, spec.Fold) or getattr(control, "timer", "") == "linear":
        return None
    return float(control.period)


def build_goal(task: spec.Task) -> search.Goal:
    if task.plugin is not None:
        return search.Goal(measure=task.fitness)
    if task.fitness in MEASURED:
        name, sign = MEASURED[task.fitness]
        return search.Goal(measure=name, sign=float(sign))
    displacement, energy = GOALS[task.fitness]
    return search.Goal(displacement, energy * task.energy_weight)


def build_placements(box: spec.World) -> jnp.ndarray | None:
    """Build the shifts of the energy in each world of a creature; None for one world."""
    energy, size = box.energy, (box.width, box.height)
    if energy is None or energy.placements == 1:
        return None
    shifts = fields.placements(size, energy.placements, energy.seed)
    return array(shifts, jnp.int32)


def matching_of(body: spec.Body) -> Matching:
    """Return what builds the shape matching of a body; one that a plan grew has soft joints."""
    return build_soft_matching if isinstance(body, spec.GrownBody) else build_matching


def build_places(box: spec.World, dtype: Any) -> jnp.ndarray | None:
    """Build the places of the copies of a creature; None if it is alone."""
    return None if box.copies is None else array(box.copies.places, dtype)


def build_world(
    box: spec.World,
    form: spec.Coupling,
    body: bodies.Body,
    dtype: Any = jnp.float32,
    *,
    matching: Matching | None = None,
) -> world.World:
    """Build the box of fluid around bodies; `matching` is `build_matching` if left out."""
    size = (box.width, box.height)
    return world.World(
        viscosity=array(box.viscosity, dtype),
        rods=build_rods(body, dtype),
        groups=groups.Groups(array(body.member, jnp.int32), body.count),
        size=size,
        form=world.Form(
            projection=PROJECTIONS[form.projection],
            force_factor=float(form.force_factor),
            theta_feedback=float(form.theta_feedback),
            forcing_iterations=form.forcing_iterations,
            constraint_iterations=form.constraint_iterations,
            layers=form.layers,
            kernel=KERNELS[form.kernel],
            magic=MAGIC[box.magic],
            fluid=box.fluid,
        ),
        limits=build_limits(form, box.viscosity, dtype),
        layout=(matching or build_matching)(body, form.theta_feedback, form.nu_c, dtype),
        nu_c=_scalar(form.nu_c, dtype),
        steric=build_steric(box.steric, dtype),
        barrier=build_barrier(box, dtype),
        energy=build_energy(box.energy, size, dtype),
        surroundings=build_surroundings(box, dtype),
    )


def build_matching(
    body: bodies.Body, theta_feedback: float, nu_c: Any, dtype: Any = jnp.float32
) -> filaments.Layout | None:
    """Build what meets constraints in closed form; None where they are swept."""
    return build_layout(body, dtype) if is_exact(body, theta_feedback, nu_c) else None


def build_soft_matching(
    body: bodies.Body, theta_feedback: float, nu_c: Any, dtype: Any = jnp.float32
) -> filaments.Layout:
    """Build shape matching in which each joint bends as softly as the body has it."""
    found = build_layout(body, dtype)
    soft = bool(np.any(body.bend < 1))
    return replace(found, bend=array(body.bend, dtype)) if soft else found


def build_layout(body: bodies.Body, dtype: Any = jnp.float32) -> filaments.Layout:
    """Build the layout of bodies as device arrays."""
    found = bodies.layout(body)
    piece = array(found.piece, jnp.int32)
    return filaments.Layout(
        angle=array(found.angle, dtype),
        rest_angle=array(found.rest_angle, dtype),
        turned=array(found.turned, dtype),
        placed=array(found.placed, dtype),
        pieces=groups.Groups(piece, int(found.piece.max()) + 1, ascending=False),
    )


def build_limits(form: spec.Coupling, viscosity: float, dtype: Any) -> world.Limits:
    return world.Limits(
        displacement=_scalar(form.displacement_limit(viscosity), dtype),
        force=_scalar(form.force_limit(viscosity), dtype),
    )


def build_steric(steric: spec.Steric | None, dtype: Any) -> fields.Steric | None:
    """Build the repulsion between nodes, if there is any."""
    if steric is None:
        return None
    return fields.Steric(
        strength=array(steric.strength, dtype),
        limit=array(steric.limit, dtype),
        gradient=SMOOTHING[steric.smoothing],
    )


def build_energy(
    energy: spec.Energy | None, size: tuple[int, int], dtype: Any
) -> fields.Energy | None:
    """Build the packets of energy, if there are any."""
    if energy is None:
        return None
    packets = fields.Packets(energy.packets, energy.width, energy.amplitude, energy.seed)
    return fields.Energy(
        start=array(fields.packets(size, packets), dtype),
        diffusion=_scalar(energy.diffusion or None, dtype),
        rate=_scalar(energy.rate if energy.consume else None, dtype),
    )


def build_rods(body: bodies.Body, dtype: Any = jnp.float32) -> filaments.Rods:
    """Build the bodies' graph as device arrays; equal bodies share their colours."""
    nodes, edges = filaments.first_chunk(body.member, body.edges, body.joints)

    def pairings(
        colours: tuple[bodies.Colour, ...], members: int
    ) -> tuple[filaments.Pairing, ...]:
        return tuple(
            filaments.Pairing(
                array(c.partner[:members]),
                array(c.constraint[:members]),
                array(c.sign[:members], dtype),
            )
            for c in colours
        )

    return filaments.Rods(
        edges=array(body.edges),
        edge_colours=pairings(body.edge_colours, nodes),
        joint_colours=pairings(body.joint_colours, edges),
        stretch=array(body.stretch, dtype),
        shear=array(body.shear, dtype),
        bend=array(body.bend, dtype),
        joints=array(body.joints, jnp.int32),
    )


def build_stroke(gait: spec.Gait, steps: int, dtype: Any = jnp.float32) -> filaments.Rest:
    """Build the rest shapes of a swimmer over time."""
    t = np.arange(steps) / gait.period
    swimmer, angle, length = strokes_of(gait, t)
    rise = t / gait.ramp if gait.ramp else np.ones(steps)
    ramp = np.minimum(1, rise)[:, None]
    body = swimmer.body
    return filaments.Rest(
        angle=array(body.rest_angle[None] + ramp * angle, dtype),
        length=array(body.rest_length[None] * (1 + ramp * length), dtype),
    )


def _scalar(value: float | None, dtype: Any) -> Any:
    return None if value is None else array(value, dtype)
