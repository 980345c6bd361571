"""Build the world, the body and the task of a scene, its creatures' identities and programs."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import jax
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
    naming,
    search,
    spec,
    world,
)
from ..bodies import extent, is_exact
from ..device import array
from ..fields import steric
from ..measures import FORMS
from ..spec.control import NetworkInputs
from ..spec.search import MEASURED
from .encodings import build_encoding
from .plugins import build_measures, strokes_of


def build_surroundings(box: spec.World, dtype: Any = jnp.float32) -> fluid.Surroundings:
    """Build the walls of the fluid, and the force that keeps a flow up."""
    solid, flow = box.solid, build_flow(box)
    around = fluid.Surroundings(solid=None if solid is None else array(solid))
    if flow is None:
        return around
    # The kernel has a collision for a uniform force and another for a field (docs/physics.md).
    force = array(flow.force, dtype)
    return replace(around, **{"force" if force.ndim == 1 else "force_field": force})


def build_flow(box: spec.World) -> fluid.Developed | None:
    """Build the flow of a box; None if the fluid starts at rest."""
    flow, size = box.flow, (box.width, box.height)
    if flow is None:
        return None
    if flow.kind == "vortices":
        return fluid.vortices(size, flow.speed, box.viscosity, flow.vortices)
    kind = fluid.poiseuille if flow.kind == "poiseuille" else fluid.shear
    return kind(size, flow.speed, box.viscosity)


def build_start(box: spec.World, place: world.World, positions: np.ndarray) -> world.State:
    """Build the start: bodies at `positions`, the fluid at rest or in its flow.

    Around obstacles the flow starts as it is without them.
    """
    dtype = place.viscosity.dtype
    at_rest = jax.jit(world.at_rest)  # One program instead of forty.
    start = at_rest(place, array(positions, dtype))
    flow = build_flow(box)
    if flow is None:
        return start
    solid = place.surroundings.solid
    planes = fluid.developed(flow, box.viscosity)
    if solid is not None:
        planes = tuple(jnp.where(solid, 0.0, plane) for plane in planes)
    planes = tuple(jnp.asarray(plane, dtype) for plane in planes)
    return replace(start, populations=planes)


def build_barrier(box: spec.World, dtype: Any) -> fields.Barrier | None:
    """Build the barrier that keeps bodies out of solid cells; None without such cells."""
    solid = box.solid
    if solid is None:
        return None
    away = array(fields.away(solid), dtype)
    return fields.Barrier(away, array(steric.LIMIT, dtype))


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
        named_measures=build_measures(scene),
        actuators=build_actuators(scene.control, body, dtype),
        period=build_period(scene.control),
        form=build_form(body),
        trials=scene.task.trials,
    )


def build_form(body: bodies.Body) -> tuple[float, ...]:
    """Build the measures of form of a body that does not grow."""
    pieces = len(np.unique(bodies.pieces(body.edges, len(body.positions))))
    every = np.ones(len(body.positions), bool), np.ones(len(body.edges), bool)
    measures = bodies.growth.form(body.positions, body.edges, *every, pieces=pieces)
    return tuple(float(np.float32(measures[name])) for name in FORMS)


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
    """Return the builder of a body's shape matching; grown bodies may have soft joints."""
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
    """Build the layout that meets constraints in closed form; None where they are swept."""
    return build_layout(body, dtype) if is_exact(body, theta_feedback, nu_c) else None


def build_soft_matching(
    body: bodies.Body, theta_feedback: float, nu_c: Any, dtype: Any = jnp.float32
) -> filaments.Layout:
    """Build shape matching in which each joint bends as softly as the body has it."""
    layout = build_layout(body, dtype)
    soft = bool(np.any(body.bend < 1))
    return replace(layout, bend=array(body.bend, dtype)) if soft else layout


def build_layout(body: bodies.Body, dtype: Any = jnp.float32) -> filaments.Layout:
    """Build the layout of bodies as device arrays."""
    layout = bodies.layout(body)
    piece = array(layout.piece, jnp.int32)
    return filaments.Layout(
        angle=array(layout.angle, dtype),
        rest_angle=array(layout.rest_angle, dtype),
        turned=array(layout.turned, dtype),
        placed=array(layout.placed, dtype),
        pieces=groups.Groups(piece, int(layout.piece.max()) + 1, ascending=False),
    )


def build_limits(form: spec.Coupling, viscosity: float, dtype: Any) -> world.Limits:
    return world.Limits(
        displacement=_scalar(form.displacement_limit(viscosity), dtype),
        force=_scalar(form.force_limit(viscosity), dtype),
    )


def build_steric(steric: spec.Steric | None, dtype: Any) -> fields.Steric | None:
    """Build the repulsion between nodes; None without it."""
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
    """Build the packets of energy; None without them."""
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
        rings=_rings(body, dtype),
    )


def _rings(body: bodies.Body, dtype: Any) -> filaments.Rings | None:
    of, sign, count = bodies.rings(body.edges, body.joints)
    if count == 0:
        return None
    sums = np.bincount(of, sign * body.rest_angle, count + 1)[:count]
    whole = 2 * np.pi * np.round(sums / (2 * np.pi))
    parts = array(of, jnp.int32), array(sign, dtype), array(whole, dtype)
    return filaments.Rings(*parts, count)


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


# `array` moves a number to the device; `jnp.asarray` of a Python number compiles a program.
def _scalar(value: float | None, dtype: Any) -> Any:
    return None if value is None else array(value, dtype)


def identity_template(scene: spec.Scene) -> dict[str, Any]:
    """Return the identity of a scene's creatures without their genes; a gait has none."""
    whole = scene.model_dump(mode="json")
    # Limits as numbers: the default of an empty limit must not change a creature.
    limits = {
        "max_displacement": scene.coupling.displacement_limit(scene.world.viscosity),
        "max_force": scene.coupling.force_limit(scene.world.viscosity),
    }
    return {
        "format": naming.FORMAT,
        "genome": _genome(scene.control),
        "world": whole["world"] | {"coupling": whole["coupling"] | limits},
        "body": whole["body"],
        "task": whole["task"],
    }


def _genome(control: spec.Controller | spec.Gait | spec.Fold) -> dict[str, Any]:
    written = control.model_dump(mode="json")
    if isinstance(control, spec.Gait):
        return {"encoding": "gait", **written}
    genome: dict[str, Any] = {"encoding": control.encoding, "control": written}
    if isinstance(control, NetworkInputs):
        genome |= {"inputs": list(control.inputs), "outputs": list(control.outputs)}
    return genome


def build_block(scene: spec.Scene, room: tuple[int, int] | None = None):
    """Build the compiled program that evaluates a block of genotypes in a scene."""
    task = build_task(scene, room=room)
    return search.block_program(partial(search.evaluate, task))


def build_disturbed_block(scene: spec.Scene, room: tuple[int, int] | None = None):
    """Build the compiled program that evaluates genotypes under disturbed conditions."""
    task = build_task(scene, room=room)
    return search.block_program(
        lambda given: search.disturbance.evaluate_disturbed(task, *given)
    )


def build_stroke_block(scene: spec.Scene):
    """Build the compiled program that simulates a scene's gait in a block of conditions."""
    gait = scene.control
    assert isinstance(gait, spec.Gait)
    rest = build_stroke(gait, scene.task.steps)
    task = build_task(scene)
    return search.block_program(partial(search.swim, task, rest, period=gait.period))


def build_point(scene: spec.Scene) -> search.Conditions:
    """Build the conditions of one point of a gait sweep."""
    viscosity = scene.world.viscosity
    limits = build_limits(scene.coupling, viscosity, jnp.float32)
    return search.Conditions(jnp.float32(viscosity), limits)
