"""Gradients through coupled steps against central differences."""

from dataclasses import dataclass, replace
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from microcosmos import bodies, fields, filaments, world

from . import scenes
from .rows import Found, at_least, at_most, holds, precision

H = 1e-5
"""Step of the differences: larger, their own error shows; smaller, rounding does."""

SOURCE = "central differences"


@dataclass(frozen=True)
class Setting:
    """A scene of two chains side by side."""

    name: str
    fields: bool
    """Steric repulsion and energy, which diffuses and is consumed."""


PLAIN = Setting("plain", False)
FIELDS = Setting("with steric and energy", True)
INACTIVE, ACTIVE = (1e3, 1e3), (0.01, 0.005)
"""Limits of displacement and force."""


def scene(setting: Setting, steps: int, dtype: Any):
    """The function to differentiate, and its inputs: joint amplitudes and viscosity.

    It also takes limits, and returns the share of nodes at a limit beside its value.
    """
    size = (48, 48)
    one = bodies.chain(16, 1.0)
    pair = bodies.together([bodies.placed(one, (0.0, y)) for y in (-1.0, 1.0)])
    options: dict[str, Any] = {}
    if setting.fields:
        strength, limit = (jnp.asarray(x, dtype) for x in (0.2, 0.1))
        options["steric"] = fields.Steric(strength, limit, fields.gaussian)
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
        value = jnp.sum((jnp.mean(end.positions - start.positions, 0) - 0.3) ** 2)
        if end.collected is not None:
            value = value + 0.1 * jnp.sum(end.collected)
        return value, jnp.mean(held)

    return outcome, (jnp.full(len(pair.joints), 0.15, dtype), box.viscosity)


def compare(setting: Setting, steps: int, dtype: Any) -> Found:
    """Slopes along a direction, for each kind of input, and gradients where limits act."""
    outcome, inputs = scene(setting, steps, dtype)
    inactive, active = (
        tuple(jnp.asarray(x, dtype) for x in limits) for limits in (INACTIVE, ACTIVE)
    )
    value, slopes = jax.jit(outcome), jax.jit(jax.grad(outcome, has_aux=True))
    gradient, _ = slopes(inputs, inactive)
    direction = jnp.asarray(np.random.default_rng(1).normal(size=inputs[0].shape), dtype)
    rows, over = [], f"{setting.name}, {steps} steps"
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
    return Found(rows)


def check(steps: int = 200, settings: tuple[Setting, ...] = (PLAIN, FIELDS)) -> Found:
    rows = []
    for setting in settings:
        with precision("float64") as dtype:
            rows += compare(setting, steps, dtype).rows
    return Found(rows)
