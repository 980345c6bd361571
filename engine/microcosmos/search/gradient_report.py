"""Reliability of a gradient: against finite differences, over time, from other starts.

A simulation that is differentiable can still have useless gradients: limits cut them, chaos
makes them grow without bound with the horizon (Metz et al., arXiv:2111.05803).
"""

from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax.flatten_util import ravel_pytree
from jaxtyping import Array, Float

from ..device import compiler_options
from . import gradients
from .blocks import mapped
from .evaluation import motion_of
from .reevaluation import Disturbance, Spread, disturbance, moved
from .simulation import drive, simulate
from .task import Actuator, Task

STEPS = (1e-3, 1e-4, 1e-5, 1e-6)
"""Steps of finite differences in float64, as shares of the values' length; the best counts."""

HORIZONS = (1 / 4, 1 / 2)
"""Shares of the whole time, besides the whole itself."""

Build = Callable[[Any], tuple[Task, Actuator]]
"""A function from a precision to a creature in it."""


@dataclass(frozen=True)
class GradientReport:
    """The report on the gradient of one measure by some parts."""

    of: str
    by: tuple[str, ...]
    value: float
    errors: dict[str, float]
    """Relative error in float64 against finite differences, in float32 against float64.

    Float32 leaves no room for differences: rounding hides small steps, curvature spoils large.
    """
    norms: dict[int, float]
    """Length of the gradient by number of steps."""
    sign_agreement: float
    """Share of the gradient, weighted by size, with the same sign from other starts."""
    cosine: float
    """Mean cosine between gradients from other starts and the creature's own."""
    starts: int
    limited: float
    """Share of node steps at a limit, where gradients are cut."""

    def document(self) -> dict[str, Any]:
        """Return the report as JSON."""
        return asdict(self) | {"norms": [[n, norm] for n, norm in self.norms.items()]}

    def lines(self) -> list[str]:
        """Return the report as sentences."""
        about = f"{self.of} by {', '.join(self.by)}"
        grows = [f"{norm:.3g} after {steps} steps" for steps, norm in self.norms.items()]
        return [
            f"{about}: {self.value:.6g}",
            f"error in float64 against finite differences: {self.errors['float64']:.1e}",
            f"error in float32 against float64: {self.errors['float32']:.1e}",
            f"length of the gradient: {', '.join(grows)}",
            f"from {self.starts} other starts: {self.sign_agreement:.0%} of the gradient has "
            f"the same sign, cosine {self.cosine:.2f}",
            f"node steps at a limit, which cuts the gradient: {self.limited:.1%}",
        ]


def report_gradient(
    build: Build,
    of: str = "fitness",
    by: tuple[str, ...] = ("genes",),
    *,
    starts: int = 8,
) -> GradientReport:
    """Return the report for a creature; `build(dtype)` makes its task and actuator."""
    with jax.enable_x64(True):
        task, actuator = build(jnp.dtype("float64"))
        values = gradients.parts(task, actuator, by)
        program = _gradient(task, actuator, of)
        exact, error = np.asarray(program(values)[1]), _error(program, values)
    task, actuator = build(jnp.dtype("float32"))
    values, driven = (
        gradients.parts(task, actuator, by),
        drive(task, actuator, differentiable=True),
    )
    program = _gradient(task, actuator, of)
    found, own = jax.device_get(program(values))
    steps = len(jax.tree.leaves(driven.inputs)[0])
    norms = {}
    for horizon in (max(1, round(share * steps)) for share in HORIZONS):
        norms[horizon] = _length(_gradient(task, actuator, of, horizon)(values)[1])
    others = np.asarray(_from_other_starts(task, actuator, of, starts)(values))
    size = np.abs(own) / max(np.abs(own).sum(), 1e-30)
    lengths = np.linalg.norm(others, axis=1) * _length(own)
    options = compiler_options()
    end, observed = jax.jit(
        lambda: simulate(driven, differentiable=True), compiler_options=options
    )()
    return GradientReport(
        of=of,
        by=by,
        value=float(found),
        errors={"float64": error, "float32": _length(own - exact) / max(_length(exact), 1e-30)},
        norms=norms | {steps: _length(own)},
        sign_agreement=float(((np.sign(others) == np.sign(own)) @ size).mean()),
        cosine=float((others @ own / np.maximum(lengths, 1e-30)).mean()),
        starts=starts,
        limited=float(motion_of(task, driven, end, observed)["limited"]),
    )


def _length(vector: Any) -> float:
    return float(np.linalg.norm(vector))


def _flat(values: gradients.Values) -> Float[Array, "value"]:
    return ravel_pytree(values)[0]


def _gradient(
    task: Task, actuator: Actuator, of: str, horizon: int | None = None
) -> Callable[[gradients.Values], tuple[Array, Array]]:
    """Return the program from values to the measure and its gradient as one vector."""

    def both(values):
        def measure(values):
            return gradients.measures(task, actuator, values, (of,), horizon=horizon)[0]

        found, rows = jax.value_and_grad(measure)(values)
        return found, _flat(rows)

    return jax.jit(both, compiler_options=compiler_options())


def _error(program: Callable, values: gradients.Values) -> float:
    """Return the relative error of the slope along the gradient, by the best differences."""
    _, own = program(values)
    length = jnp.linalg.norm(own)
    flat, whole = ravel_pytree(values)
    direction = own / jnp.maximum(length, 1e-30)
    unit = jnp.maximum(jnp.linalg.norm(flat), 1.0)
    slopes = []
    for size in STEPS:
        ahead, behind = (program(whole(flat + s * unit * direction))[0] for s in (size, -size))
        slopes.append((ahead - behind) / (2 * size * unit))
    return min(float(abs(slope - length) / jnp.maximum(length, 1e-30)) for slope in slopes)


def _from_other_starts(
    task: Task, actuator: Actuator, of: str, starts: int
) -> Callable[[gradients.Values], Float[Array, "start value"]]:
    """Return the program from values to gradients with other phases, places and directions."""
    spread = Spread(viscosity=0.0, energy=False)
    keys = jax.random.split(jax.random.key(0), starts)
    size = task.world.size
    draws = jax.vmap(lambda key: disturbance(spread, size, key=key))(keys)

    def one(values, change: Disturbance):
        begun = replace(task, phase=change.phase, start=moved(task.start, change))

        def measure(values):
            return gradients.measures(begun, actuator, values, (of,))[0]

        return _flat(jax.grad(measure)(values))

    return jax.jit(
        lambda values: mapped(lambda change: one(values, change), draws),
        compiler_options=compiler_options(),
    )
