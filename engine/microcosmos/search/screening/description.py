"""Description of a creature before its simulation: numbers from which a model predicts."""

from collections.abc import Mapping
from typing import Any

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ... import exact
from ...genomes import Drive, Genotype
from ...measures import FORMS
from ...portable import arctangent, cosine, long_product, sine
from ...world import grown_nodes, present_edges, present_joints
from ..measures import along, along_joints, axis, curvature, symmetry
from ..task import Task
from .stroke import PHASES, Stroke, Strokes, Swim, swim

HARMONICS, WAVES = 4, 3
"""Harmonics in time, from 0, and waves along the body of the modes of bending."""

Inputs = Float[Array, "input"]
Spectrum = Float[Array, "harmonic joint"]


class Described(eqx.Module):
    """The description of a creature before it is simulated."""

    inputs: Float[Array, "*block input"]
    known: Float[Array, "*block axis"]
    """Values on the archive's axes; NaN where only a simulation tells."""


def describe(strokes: Strokes, axes: tuple[str, ...], genotype: Genotype) -> Described:
    """Return the inputs for a model, and values on axes where they need no simulation."""
    driven, stroke = strokes.of(genotype)
    known = _known(strokes.task, driven, genotype)
    values = [jnp.asarray(known.get(name, jnp.nan), jnp.float32) for name in axes]
    return Described(inputs_of(strokes, driven, stroke), jnp.stack(values))


def _known(task: Task, driven: Drive, genotype: Genotype) -> dict[str, Array]:
    """Return the measures that need no simulation."""
    assert task.encoding is not None
    hidden, connections = task.encoding.size(genotype)
    form: Mapping[str, Any] = dict(zip(FORMS, task.form, strict=True))
    form = form if driven.form is None else driven.form
    nodes = task.copies * jnp.sum(grown_nodes(driven.world))  # `driven` is one copy alone.
    return {"hidden_nodes": hidden, "connections": connections, "nodes": nodes, **form}


def inputs_of(strokes: Strokes, driven: Drive, stroke: Stroke) -> Inputs:
    """Return numbers about a creature: its speed by resistive force theory, its shapes, its
    form, and the modes of its bending."""
    world = driven.world
    grown = present_edges(world)
    edges = jnp.ones(len(world.rods.edges)) if grown is None else grown.astype(jnp.float32)
    moved = swim(stroke, world.rods.edges, edges)
    real, imaginary = _spectrum(driven, stroke)
    length = strokes.task.length if driven.length is None else driven.length
    numbers = [
        *_swimming(strokes, driven, stroke, moved, jnp.asarray(length, jnp.float32)),
        *_shape(driven, stroke, moved, edges),
        *_waves(driven, real, imaginary),
        *(() if driven.form is None else [driven.form[name] for name in FORMS]),
    ]
    columns = jnp.stack([jnp.asarray(one, jnp.float32) for one in numbers])
    columns = jnp.concatenate([columns, *_modes(driven, real, imaginary)])
    # Quotients of a body that does not move may be 0 by 0.
    return jnp.clip(jnp.nan_to_num(columns, nan=0.0), -1e4, 1e4)


def _swimming(
    strokes: Strokes, driven: Drive, stroke: Stroke, moved: Swim, length: Array
) -> list[Array]:
    """Return speeds, in 0.01 cells a step or lengths, and times."""
    took = jnp.sum(stroke.took)
    many = strokes.steps / took
    whole = jnp.maximum(jnp.floor(many) - 1, 0.0)
    x, y = moved.displacement / length
    stride, half = jnp.sqrt(x * x + y * y + 1e-12), jnp.abs(moved.turn) / 2
    # The chord of that many equal strokes, each turned from the one before.
    chord = jnp.abs(sine(whole * half)) / jnp.maximum(jnp.abs(sine(half)), 1e-3)
    chord = jnp.where(half > 1e-3, chord, whole)
    v = moved.velocity
    squares = jnp.sum(v * v, 2) * grown_nodes(driven.world)[None]
    speeds = 100 * jnp.sqrt(squares + 1e-20)
    return [
        1000 * stride * chord / jnp.maximum(whole, 1) / took,
        1000 * stride / took,
        1000 * x / took,
        1000 * y / took,
        stride,
        jnp.abs(moved.turn),
        took / 100,
        whole,
        jnp.max(speeds),
        jnp.mean(speeds),
        jnp.sqrt(jnp.max(jnp.sum(speeds * speeds, 1))),
        jnp.max(jnp.abs(jnp.diff(speeds, axis=0))),
        jnp.log(jnp.mean(moved.power) + 1e-9),
        100 * jnp.max(jnp.abs(moved.rigid[:, :2])),
        100 * jnp.max(jnp.abs(moved.rigid[:, 2])),
        jnp.log(length),
    ]


def _shape(
    driven: Drive, stroke: Stroke, moved: Swim, grown: Float[Array, "edge"]
) -> list[Array]:
    """Return measures of the visible motion, and sizes of the actuators' movements."""
    world, rest = driven.world, stroke.rest
    nodes, joints = grown_nodes(world), present_joints(world)
    count = jnp.sum(grown)
    lengths = jnp.sum(rest.length * grown[None], 1) / count
    bends = rest.angle / jnp.mean(lengths)
    c, s = cosine(moved.heading)[:, None], sine(moved.heading)[:, None]
    x, y = stroke.shapes[..., 0], stroke.shapes[..., 1]
    seen = jnp.stack([c * x - s * y, s * x + c * y], 2)
    seen = jnp.where(nodes[None, :, None], seen, 0.0)
    bent = bends if joints is None else jnp.where(joints[None], bends, 0.0)
    return [
        *curvature(bends, joints),
        symmetry(bends, joints),
        *axis(seen, moved.displacement + 1e-6, world.present),
        jnp.mean(lengths),
        jnp.max(lengths) - jnp.min(lengths),
        jnp.max(jnp.abs(jnp.sum(bent, 1))),
        jnp.max(jnp.abs(bent)),
        jnp.log(jnp.sum(nodes).astype(jnp.float32)),
    ]


def _waves(driven: Drive, real: Spectrum, imaginary: Spectrum) -> list[Array]:
    """Return beats a stroke, waves from one joint to the next and their direction, as
    `measures.waves` does, here of the first harmonic."""
    power = jnp.sum(real * real + imaginary * imaginary, 1)[1:]
    rates = jnp.arange(1.0, HARMONICS, dtype=power.dtype)
    beats = jnp.sum(rates * power) / jnp.maximum(jnp.sum(power), 1e-20)
    size, step, turned = along_joints(real[1], imaginary[1], along(driven.world))
    return [beats, arctangent(step, 2 * size), -turned / (size * step)]


def _spectrum(driven: Drive, stroke: Stroke) -> tuple[Spectrum, Spectrum]:
    """Return real and imaginary parts of the harmonics of every joint's angle, 0 if absent."""
    angle, joints = stroke.rest.angle, present_joints(driven.world)
    if joints is not None:
        angle = jnp.where(joints[None], angle, 0.0)
    phase = 2 * np.pi * np.arange(PHASES) / PHASES
    parts = [
        [
            jnp.mean(angle * f(k * phase).astype(np.float32)[:, None], 0)
            for k in range(HARMONICS)
        ]
        for f in (exact.cosine, exact.sine)
    ]
    return jnp.stack(parts[0]), jnp.stack(parts[1])


def _modes(driven: Drive, real: Spectrum, imaginary: Spectrum) -> list[Float[Array, "number"]]:
    """Return amplitudes of bending in modes of space and time, and how the modes of the first
    harmonic lead one another."""
    joints, count = present_joints(driven.world), real.shape[1]
    grown = jnp.ones(count) if joints is None else joints.astype(real.dtype)
    count = jnp.maximum(jnp.sum(grown), 1.0)
    place = np.pi * (jnp.cumsum(grown) - 0.5) / count
    basis = [jnp.ones_like(place)]
    basis += [f(k * place) for k in range(1, WAVES + 1) for f in (cosine, sine)]
    basis = jnp.stack(basis, 1) * (grown / count)[:, None]
    real, imaginary = long_product(real, basis), long_product(imaginary, basis)
    ahead = real[1, 1:] * imaginary[1, :-1] - imaginary[1, 1:] * real[1, :-1]
    alike = real[1, 1:] * real[1, :-1] + imaginary[1, 1:] * imaginary[1, :-1]
    sizes = jnp.sqrt(real * real + imaginary * imaginary + 1e-16)
    return [real[0], alike, ahead, *sizes]
