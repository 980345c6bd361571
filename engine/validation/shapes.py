"""Constraint projection without a fluid: bodies take their rest shape."""

from dataclasses import replace
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from microcosmos import bodies, filaments
from microcosmos.bodies import swimmers
from microcosmos.build import build_layout, build_rods

from .rows import Result, at_most

REST = "rest shape"


def projected(
    body: bodies.Body, positions: np.ndarray, iterations: int, dtype: Any
) -> np.ndarray:
    """Return the positions after some sweeps towards the rest shape."""
    rods = build_rods(body, dtype)
    shape = (body.rest_angle, body.rest_length)
    rest = filaments.Rest(*(jnp.asarray(values, dtype) for values in shape))
    start = jnp.asarray(positions, dtype)
    project = jax.jit(filaments.project, static_argnames="iterations")
    angles = filaments.edge_angles(start, rods)
    return np.asarray(project(start, angles, rods, rest, iterations=iterations)[0], float)


def errors(body: bodies.Body, positions: np.ndarray) -> tuple[float, float]:
    """Root mean square errors of angles (radians) and lengths (shares)."""
    v = positions[body.edges[:, 1]] - positions[body.edges[:, 0]]
    theta = np.arctan2(v[:, 1], v[:, 0])
    bend = theta[body.joints[:, 1]] - theta[body.joints[:, 0]] - body.rest_angle
    bend = bend - 2 * np.pi * np.round(bend / (2 * np.pi))
    length = np.hypot(v[:, 0], v[:, 1]) / body.rest_length - 1
    return float(np.sqrt(np.mean(bend**2))), float(np.sqrt(np.mean(length**2)))


def circle(nodes: int, iterations: int, dtype: Any) -> tuple[float, float]:
    """Errors of a straight chain whose rest shape is a circle."""
    straight = bodies.chain(nodes, 1.0)
    round_body = replace(straight, rest_angle=np.full(nodes - 2, 2 * np.pi / nodes))
    return errors(round_body, projected(round_body, straight.positions, iterations, dtype))


def branched(noise: float, iterations: int, dtype: Any, seed: int = 0) -> tuple[float, float]:
    """Errors of a ring with hairs whose nodes start displaced by `noise` cells."""
    body = swimmers.cilia().body
    moved = np.random.default_rng(seed).normal(size=body.positions.shape)
    return errors(body, projected(body, body.positions + noise * moved, iterations, dtype))


LENGTH, BEND = 30.0, 0.15
"""Length of a worm in cells, and the amplitude of its curvature in 1/cells."""
SPACINGS = (0.5, 1.0, 1.5)


def worm(spacing: float) -> swimmers.Swimmer:
    """A worm with the same curvature over its length at any node spacing."""
    body = bodies.chain(round(LENGTH / spacing) + 1, spacing)
    share = body.arc[body.joint_nodes]

    def gait(time):
        wave = np.sin(2 * np.pi * (share[None] - np.asarray(time)[:, None]))
        return BEND * spacing * wave, np.zeros((len(wave), len(body.edges)))

    return swimmers.Swimmer("worm", body, gait)


def curve(points: int, time: float, fine: int = 20_000) -> np.ndarray:
    """Evenly spaced points of the curve with the worm's curvature, relative to their mean."""
    s = (np.arange(fine) + 0.5) / fine
    turn = BEND * LENGTH / (2 * np.pi)
    angle = turn * (np.cos(2 * np.pi * time) - np.cos(2 * np.pi * (s - time)))
    step = LENGTH / fine * np.stack([np.cos(angle), np.sin(angle)], 1)
    whole = np.concatenate([np.zeros((1, 2)), np.cumsum(step, 0)])
    found = whole[np.linspace(0, fine, points).astype(int)]
    return found - found.mean(0)


def shape_error(spacing: float, times: int = 8) -> float:
    """Largest distance of the matched worm from its curve, turned to fit, over its length."""
    swimmer, largest = worm(spacing), 0.0
    layout = build_layout(swimmer.body, "float64")
    angle, _ = swimmer.gait(np.arange(times) / times)
    for number in range(times):
        points = curve(len(swimmer.body.positions), number / times)
        turned = swimmer.body.rest_angle + angle[number]
        rest = filaments.Rest(*map(jnp.asarray, (turned, swimmer.body.rest_length)))
        away = filaments.matched(jnp.asarray(points), rest, layout) - points
        largest = max(largest, float(jnp.max(jnp.hypot(*away.T))) / LENGTH)
    return largest


def check_matching() -> Result:
    """Shape matching at three node spacings, against the curve that the nodes stand for."""
    with jax.enable_x64(True):
        return Result(
            [
                at_most(f"worm, spacing {spacing:g}: distance / length", shape_error(spacing),
                        0.01, "the curve of the same curvature")
                for spacing in SPACINGS
            ]
        )  # fmt: skip


def check(nodes: int = 32, iterations: int = 1000) -> Result:
    bend, _ = circle(nodes, iterations, "float32")
    with jax.enable_x64(True):
        angles, lengths = branched(0.3, iterations, "float64")
    sweeps = f"after {iterations:,} sweeps"
    rows = [
        at_most(f"chain to circle, {sweeps}: joint error (rad)", bend, 2e-3, REST),
        at_most(f"ring with branches, {sweeps}: angles (rad)", angles, 1e-5, REST),
        at_most(f"ring with branches, {sweeps}: lengths", lengths, 1e-5, REST),
    ]
    return Result(rows)
