"""Variants of a simulation, by which the audit tells swimming from artefacts."""

from dataclasses import replace
from typing import Any

import jax.numpy as jnp
import numpy as np

from .. import bodies, build, search, spec, world
from ..bodies import extent
from ..filaments import Rest
from ..genomes import Drive
from ..viz.replay import graph_among, present_parts


def alone(scene: spec.Scene) -> spec.Scene:
    """Return the scene with one copy of the creature."""
    box = scene.world.model_copy(update={"copies": None})
    return scene.model_copy(update={"world": box})


def body_of(scene: spec.Scene, driven: Drive) -> tuple[bodies.Body, np.ndarray, np.ndarray]:
    """Return the developed body, and masks of its world's joints and edges that it has.

    Its rest shape is its shape at the start. Raises `ValueError` if it is no valid body.
    """
    body, rods = spec.shape(scene.body), driven.world.rods
    nodes = np.asarray(world.grown_nodes(driven.world))
    graph = np.asarray(rods.edges), np.asarray(rods.joints)
    edges, joints = present_parts(*graph, nodes)
    edge_pairs, joint_pairs = graph_among(*graph, nodes)
    positions = np.asarray(driven.start.positions, float)[nodes]
    given = body.rest_angle if driven.layout is None else driven.layout.rest_angle
    length, angle = _geometry(positions, edge_pairs, joint_pairs, np.asarray(given)[joints])
    return (
        bodies.Body(
            positions=positions,
            edges=edge_pairs,
            joints=joint_pairs,
            rest_length=length,
            rest_angle=angle,
            stretch=np.asarray(rods.stretch, float)[edges],
            shear=np.asarray(rods.shear, float)[edges],
            bend=np.asarray(rods.bend, float)[joints],
            arc=np.linspace(0, 1, len(positions)),
            member=np.asarray(driven.world.groups.member)[nodes],
            crossing=body.crossing,
        ),
        joints,
        edges,
    )


def _geometry(
    positions: np.ndarray, edges: np.ndarray, joints: np.ndarray, given: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the lengths of edges, and the angles at joints on the branch of those given."""
    x, y = (positions[edges[:, 1]] - positions[edges[:, 0]]).T
    direction = np.arctan2(y, x)
    error = direction[joints[:, 1]] - direction[joints[:, 0]] - given
    return np.hypot(x, y), given + error - 2 * np.pi * np.round(error / (2 * np.pi))


def refine(
    scene: spec.Scene, rest: Rest, body: bodies.Body | None = None
) -> tuple[search.Task, Rest]:
    """Return the same body and gait on half the grid spacing with a quarter of the step.

    Lengths in cells double, times in steps quadruple, speeds halve and the viscosity in cells²
    a step stays: errors of resolution, of the step and of compressibility all fall fourfold.
    The chain has twice the joints, and sweeps relax a bend in the same time. Repulsion keeps
    its width in cells, and so reaches half as far; its speed halves as others do. A body with
    soft joints that a plan grew bends in the middle of its edges too, as softly as beside it.
    """
    body = spec.shape(scene.body) if body is None else body
    half = bodies.subdivided(body)
    place, form = scene.world, scene.coupling
    wide = place.model_copy(
        update={
            "width": 2 * place.width,
            "height": 2 * place.height,
            "energy": None,
            "obstacles": tuple(one.scaled(2) for one in place.obstacles),
            "flow": _halved(place.flow),
            "steric": place.steric and _slower(place.steric),
        }
    )
    fine = form.model_copy(
        update={
            "max_displacement": _scaled(form.displacement_limit(place.viscosity), 0.5),
            "max_force": _scaled(form.force_limit(place.viscosity), 0.5),
        }
    )
    if isinstance(scene.body, spec.GrownBody):
        half = replace(half, body=replace(half.body, bend=_soft(body)))
    box = build.build_world(wide, fine, half.body, matching=build.matching_of(scene.body))
    middle = np.array([wide.width, wide.height]) / 2
    positions = half.body.positions - half.body.positions[half.nodes].mean(0) + middle
    start = build.build_start(wide, box, positions)
    angle = np.tile(half.body.rest_angle, (4 * len(rest.angle), 1))
    # Twice halfway between times: four fine steps for each coarse one.
    angle[:, half.joints] = _between(_between(np.asarray(rest.angle)))
    length = _between(_between(np.asarray(rest.length)))[:, half.edges]
    task = search.Task(box, start, None, length=2 * extent(body))
    return task, Rest(jnp.asarray(angle, jnp.float32), jnp.asarray(length, jnp.float32))


def other_delta(scene: spec.Scene) -> str:
    """Return the delta that the creature was not measured with."""
    return "roma" if scene.coupling.kernel == "peskin" else "peskin"


def with_other_delta(scene: spec.Scene, body: bodies.Body | None = None) -> search.Task:
    """Return the scene with another delta."""
    return _with(scene, body, kernel=other_delta(scene))


def with_limits(
    scene: spec.Scene, body: bodies.Body | None, factor: float | None
) -> search.Task:
    """Return the scene with limits times `factor`, or without limits."""
    form, viscosity = scene.coupling, scene.world.viscosity
    if factor is None:
        return _with(scene, body, limits=False)
    return _with(
        scene,
        body,
        max_displacement=_scaled(form.displacement_limit(viscosity), factor),
        max_force=_scaled(form.force_limit(viscosity), factor),
    )


def turned(scene: spec.Scene, body: bodies.Body | None, angle: float) -> search.Task:
    """Return the scene with the body turned about its middle at the start, by rad."""
    task = _with(scene, body)
    turn = jnp.asarray(angle, task.start.positions.dtype)
    return replace(task, start=search.turned(task.start, turn))


def at_full_strength(scene: spec.Scene, body: bodies.Body | None = None) -> search.Task:
    """Return the scene with actuators of full strength.

    A soft body lags behind its rest shape: its motion is not reciprocal although the gait is.
    """
    if body is not None and isinstance(scene.body, spec.GrownBody):
        body = replace(body, bend=np.ones(len(body.bend)))
    return _with(scene, body, nu_c=None)


def reciprocal(rest: Rest) -> Rest:
    """Return the first half of the rest shapes, then the same shapes back again."""
    steps = len(rest.angle)
    number = np.arange(steps)
    times = np.minimum(number, steps - 1 - number)
    return Rest(jnp.asarray(rest.angle)[times], jnp.asarray(rest.length)[times])


def _with(scene: spec.Scene, body: bodies.Body | None, **form: Any) -> search.Task:
    coupling = scene.coupling.model_copy(update=form)
    changed = scene.model_copy(update={"coupling": coupling})
    # The rest shapes are given: no genome develops.
    return replace(build.build_task(changed, body=body), encoding=None)


def _halved(flow: spec.Flow | None) -> spec.Flow | None:
    """Return the flow at half its speed in cells a step."""
    return flow and flow.model_copy(update={"speed": flow.speed / 2})


def _soft(body: bodies.Body) -> np.ndarray:
    """Return the stiffness of the refined joints, which yield as much under the same load.

    A step multiplies an error by 1 − b = 1 / (1 + k Δt): implicit Euler at the rate k, of which
    b / (1 − b) = k Δt. A new joint, in the middle of an edge, is as stiff as those at its ends
    in the mean.
    """
    stiff = body.bend / (4 - 3 * body.bend)
    ends, count = body.joints.ravel(), len(body.edges)
    total = np.bincount(ends, np.repeat(stiff, 2), count)
    between = total / np.maximum(np.bincount(ends, minlength=count), 1)
    return np.concatenate([stiff, between])


def _slower(steric: spec.Steric) -> spec.Steric:
    """Return repulsion at half the speed, in cells a step."""
    half = {name: 0.5 * getattr(steric, name) for name in ("strength", "limit")}
    return steric.model_copy(update=half)


def _scaled(limit: float | None, factor: float) -> float | None:
    return None if limit is None else factor * limit


def _between(values: np.ndarray) -> np.ndarray:
    """Return values at twice as many times: each, and its mean with the next."""
    after = np.concatenate([values[1:], values[-1:]])
    return np.stack([values, 0.5 * (values + after)], 1).reshape(-1, values.shape[1])
