"""Checks of gradients through coupled steps against central differences."""

from dataclasses import replace
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from microcosmos import fields, filaments, world

from . import scenes
from .rows import Result, Row, at_least, at_most, holds

H = 1e-5
"""Step of the differences: larger ones are less accurate, smaller ones round more."""

SOURCE = "central differences"
PLAIN, FIELDS = "plain", "with steric and energy"
"""Scenes of two chains side by side; energy diffuses and is consumed."""
INACTIVE, ACTIVE = (1e3, 1e3), (0.01, 0.005)
"""Limits of displacement and force."""


def scene(setting: str, steps: int, dtype: Any):
    """Return the function to differentiate, and its inputs: joint amplitudes and viscosity.

    The function also takes limits; it returns a value and the share of nodes at a limit.
    """
    size, pair = (48, 48), scenes.parallel_chains(16, 2.0)
    options: dict[str, Any] = {}
    if setting == FIELDS:
        options["steric"] = scenes.steric(0.2, dtype)
        packets = fields.packets(size, fields.Packets(6, 4.0, 1.0, 0))
        rates = (jnp.asarray(x, dtype) for x in (0.05, 0.1))
        options["energy"] = fields.Energy(jnp.asarray(packets, dtype), *rates)
    box, start = scenes.immersed(pair, 0.1, dtype, size=size, **options)
    time = jnp.arange(steps, dtype=dtype)[:, None] / 100
    joint = jnp.linspace(0, 4 * jnp.pi, len(pair.joints), dtype=dtype)[None]
    wave = jnp.minimum(time, 1.0) * jnp.sin(joint - 2 * jnp.pi * time)
    still = scenes.held(pair, steps, dtype)

    def outcome(inputs, limits):
        amplitude, viscosity = inputs
        place = replace(box, viscosity=viscosity, limits=world.Limits(*limits))
        rest = filaments.Rest(still.angle + wave * amplitude[None], still.length)
        end, held = world.rollout(place, start, rest, lambda _, measures: measures.held)
        moved = world.unwrapped(place, end) - start.positions
        value = jnp.sum((jnp.mean(moved, 0) - 0.3) ** 2)
        if end.collected is not None:
            value = value + 0.1 * jnp.sum(end.collected)
        return value, jnp.mean(held)

    return outcome, (jnp.full(len(pair.joints), 0.15, dtype), box.viscosity)


def compare(setting: str, steps: int) -> list[Row]:
    """Check slopes along a direction for each kind of input, and gradients at limits."""
    dtype = jnp.dtype("float64")
    outcome, inputs = scene(setting, steps, dtype)
    inactive, active = (
        tuple(jnp.asarray(x, dtype) for x in limits) for limits in (INACTIVE, ACTIVE)
    )
    value, slopes = jax.jit(outcome), jax.jit(jax.grad(outcome, has_aux=True))
    gradient, _ = slopes(inputs, inactive)
    direction = jnp.asarray(np.random.default_rng(1).normal(size=inputs[0].shape), dtype)
    rows, over = [], f"{setting}, {steps} steps"
    for name, along in {
        "angles": (direction, jnp.zeros((), dtype)),
        "viscosity": (jnp.zeros_like(direction), jnp.asarray(0.1, dtype)),
    }.items():
        slope = sum(float(jnp.sum(g * d)) for g, d in zip(gradient, along, strict=True))
        ahead, behind = (
            jax.tree.map(lambda x, d, h=h: x + h * d, inputs, along) for h in (H, -H)
        )
        expected = float(value(ahead, inactive)[0] - value(behind, inactive)[0]) / (2 * H)
        error = abs(slope - expected) / abs(expected)
        rows.append(at_most(f"gradient by {name}, {over}", error, 1e-6, SOURCE))
    gradient, held = slopes(inputs, active)
    fact = all(bool(jnp.all(jnp.isfinite(g)) & jnp.any(g != 0)) for g in gradient)
    rows.append(holds(f"gradients are finite with limits, {over}", fact, "definition"))
    share = "share of nodes and steps at a limit then"
    rows.append(at_least(share, float(held), 0.1, 1.0, "if always"))
    return rows


def check(steps: int = 200, settings: tuple[str, ...] = (PLAIN, FIELDS)) -> Result:
    with jax.enable_x64(True):
        return Result([row for setting in settings for row in compare(setting, steps)])
