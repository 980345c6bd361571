"""Checks that bodies take their rest shape, by constraint projection without a fluid."""

from dataclasses import replace
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from microcosmos import bodies, world
from microcosmos.bodies import swimmers

from . import scenes
from .paths import JAX, Path, roll
from .rows import Result, at_most

REST = "rest shape"


def taken(
    body: bodies.Body,
    positions: np.ndarray,
    dtype: Any,
    path: Path,
    *,
    turn: np.ndarray | float = 0.0,
    sweeps: int | None = None,
) -> np.ndarray:
    """Return the positions after one step without a fluid, with `turn` added to rest angles.

    The body takes its rest shape by so many `sweeps` over the constraints; None: by matching.
    """
    form = world.Form(fluid=False, constraint_iterations=sweeps or 1)
    box, _ = scenes.immersed(body, 1.0, dtype, form=form)
    box = box if sweeps is None else replace(box, layout=None)
    start = world.at_rest(box, jnp.asarray(positions, dtype))
    shape = scenes.rest(body, np.zeros((1, len(body.joints))) + turn, dtype)
    end, _ = roll(path, box, start, shape)
    return scenes.unwrapped(box, end.positions, end.boxes)


def errors(body: bodies.Body, positions: np.ndarray) -> tuple[float, float]:
    """Return root mean square errors of angles (radians) and lengths (shares)."""
    v = positions[body.edges[:, 1]] - positions[body.edges[:, 0]]
    theta = np.arctan2(v[:, 1], v[:, 0])
    bend = theta[body.joints[:, 1]] - theta[body.joints[:, 0]] - body.rest_angle
    bend = bend - 2 * np.pi * np.round(bend / (2 * np.pi))
    length = np.hypot(v[:, 0], v[:, 1]) / body.rest_length - 1
    return float(np.sqrt(np.mean(bend**2))), float(np.sqrt(np.mean(length**2)))


def circle(nodes: int, iterations: int, dtype: Any, path: Path = JAX) -> tuple[float, float]:
    """Return the errors of a straight chain whose rest shape is a circle."""
    straight = bodies.chain(nodes, 1.0)
    round_body = replace(straight, rest_angle=np.full(nodes - 2, 2 * np.pi / nodes))
    return errors(
        round_body, taken(round_body, straight.positions, dtype, path, sweeps=iterations)
    )


def branched(
    noise: float, iterations: int, dtype: Any, seed: int = 0, path: Path = JAX
) -> tuple[float, float]:
    """Return the errors of a ring with hairs whose nodes start displaced by `noise` cells."""
    body = swimmers.cilia().body
    moved = np.random.default_rng(seed).normal(size=body.positions.shape)
    return errors(
        body, taken(body, body.positions + noise * moved, dtype, path, sweeps=iterations)
    )


LENGTH, BEND = 30.0, 0.15
"""Length of a worm in cells, and the amplitude of its curvature in 1/cells."""
SPACINGS = (0.5, 1.0, 1.5)


def worm(spacing: float) -> swimmers.Swimmer:
    """Return a worm with the same curvature over its length at any node spacing."""
    body = bodies.chain(round(LENGTH / spacing) + 1, spacing)
    share = body.arc[body.joint_nodes]

    def gait(time):
        wave = np.sin(2 * np.pi * (share[None] - np.asarray(time)[:, None]))
        return BEND * spacing * wave, np.zeros((len(wave), len(body.edges)))

    return swimmers.Swimmer("worm", body, gait)


def curve(points: int, time: float, fine: int = 20_000) -> np.ndarray:
    """Return even points of the curve with the worm's curvature, relative to their mean."""
    s = (np.arange(fine) + 0.5) / fine
    turn = BEND * LENGTH / (2 * np.pi)
    angle = turn * (np.cos(2 * np.pi * time) - np.cos(2 * np.pi * (s - time)))
    step = LENGTH / fine * np.stack([np.cos(angle), np.sin(angle)], 1)
    whole = np.concatenate([np.zeros((1, 2)), np.cumsum(step, 0)])
    chosen = whole[np.linspace(0, fine, points).astype(int)]
    return chosen - chosen.mean(0)


def shape_error(spacing: float, times: int = 8, path: Path = JAX) -> float:
    """Return the largest distance of the matched worm from its curve, over its length."""
    swimmer, largest = worm(spacing), 0.0
    angle, _ = swimmer.gait(np.arange(times) / times)
    for number in range(times):
        points = curve(len(swimmer.body.positions), number / times)
        # The body starts on the curve, so matching turns it to fit.
        worm_nodes = taken(swimmer.body, points, "float32", path, turn=angle[number])
        largest = max(largest, float(np.max(np.hypot(*(worm_nodes - points).T))) / LENGTH)
    return largest


def check_matching(path: Path = JAX) -> Result:
    """Check shape matching at three node spacings against the curve that nodes stand for."""
    return Result(
        [
            at_most(f"worm, spacing {spacing:g}: distance / length",
                    shape_error(spacing, path=path), 0.01, "the curve of the same curvature")
            for spacing in SPACINGS
        ]
    )  # fmt: skip


def check_circle(nodes: int = 32, iterations: int = 1000, path: Path = JAX) -> Result:
    bend, _ = circle(nodes, iterations, "float32", path)
    what = f"chain to circle, after {iterations:,} sweeps: joint error (rad)"
    return Result([at_most(what, bend, 2e-3, REST)])


def check_branches(iterations: int = 1000, dtype: Any = "float64", path: Path = JAX) -> Result:
    with jax.enable_x64(dtype == "float64"):
        angles, lengths = branched(0.3, iterations, dtype, path=path)
    what = f"ring with branches, {dtype}, after {iterations:,} sweeps"
    return Result(
        [
            at_most(f"{what}: angles (rad)", angles, 1e-5, REST),
            at_most(f"{what}: lengths", lengths, 1e-5, REST),
        ]
    )
