"""Derivatives of a creature's measures, by reverse mode through the whole simulation.

Variables are its genes, rest shape and stiffnesses, and the fluid's viscosity. Differentiation
treats as constant: the length of a displacement at its limit, the cells that a point acts on,
the share of time at a limit, counts of nodes and connections. See `docs/gradients.md`.

A simulation that is differentiable can still have useless gradients: limits cut them, chaos
makes them grow without bound with the horizon (Metz et al., arXiv:2111.05803). A report
compares them with finite differences, over time, and from other starts.
"""

from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jax.flatten_util import ravel_pytree
from jaxtyping import Array, Bool, Float

from ..device import compiler_options
from ..filaments import Rest
from ..genomes import CPPN, SEGMENT, BodyGraph, Drive, Genotype, Vector
from ..measures import WITHOUT_GRADIENT
from ..world import State, World
from .blocks import mapped
from .disturbance import Disturbance, Spread, disturbance, moved
from .evaluation import fitness_of, in_trials, motion_of
from .simulation import drive, shift_energy, simulate
from .task import Actuator, Task

SHAPED = ("angle", "curl", "stiffness")
"""Genes of segments on which a body depends smoothly, between plans that grow differently."""

STIFFNESSES = ("stretch", "shear", "bend")

Values = dict[str, Float[Array, "..."]]


def parts(task: Task, actuator: Actuator, names: tuple[str, ...] | None = None) -> Values:
    """Return the present values of parts of a creature; None: of all that it has.

    `genes` are the weights, then the biases of a network, or a vector's numbers.
    `rest_angle` in rad is added to every joint's rest angle and `rest_length` to the logarithm
    of every edge's rest length, at all times: both are 0 as the creature is. A plan has
    `segment_angle`, `segment_curl` and `segment_stiffness` in place of a body's stiffnesses.
    """
    dtype = task.start.positions.dtype
    rods = jax.eval_shape(lambda: drive(task, actuator, differentiable=True).world.rods)
    values = {
        "rest_angle": jnp.zeros(rods.bend.shape, dtype),
        "rest_length": jnp.zeros(rods.stretch.shape, dtype),
        "viscosity": task.world.viscosity,
    }
    if isinstance(actuator, BodyGraph):
        genes = ((name, jnp.asarray(getattr(actuator.plan, name), dtype)) for name in SHAPED)
        values |= {SEGMENT + name: column for name, column in genes}
    else:
        values |= {name: getattr(task.world.rods, name) for name in STIFFNESSES}
    if not isinstance(actuator, Rest):
        values["genes"] = genes_of(actuator).astype(dtype)
    unknown = [name for name in names or () if name not in values]
    if unknown:
        raise ValueError(f"`by` must be of {', '.join(values)}, got {', '.join(unknown)}")
    return {name: values[name] for name in names or values}


def changed(task: Task, actuator: Actuator, values: Values) -> Drive:
    """Return the simulation of a creature whose parts have other values.

    Stiffnesses are those of the body before a genotype grows it.
    """
    world, rods = task.world, task.world.rods
    stiffness = {n: values[n] for n in STIFFNESSES if n in values}
    if stiffness:  # Softer bodies are swept.
        world = replace(world, rods=replace(rods, **stiffness), layout=None)
    if "viscosity" in values:
        world = replace(world, viscosity=values["viscosity"])
    if "genes" in values:
        actuator = with_genes(actuator, values["genes"])
    if isinstance(actuator, BodyGraph):
        shaped = {name: values[SEGMENT + name] for name in SHAPED if SEGMENT + name in values}
        actuator = replace(actuator, plan=actuator.plan._replace(**shaped))
    driven = drive(replace(task, world=world), actuator, differentiable=True)
    if not {"rest_angle", "rest_length"} & values.keys():
        return driven

    def control(world: World, state: State, given: Any) -> Rest:
        rest = driven.control(world, state, given)
        angle, length = values.get("rest_angle", 0.0), values.get("rest_length", 0.0)
        return Rest(rest.angle + angle, rest.length * jnp.exp(length))

    return replace(driven, control=control)


def measures(
    task: Task,
    actuator: Actuator,
    values: Values,
    of: tuple[str, ...] = ("fitness",),
    *,
    horizon: int | None = None,
    segment: int | None = None,
) -> Float[Array, "output"]:
    """Return fitness and measures of the creature with parts changed, after `horizon` steps.

    Raises `ValueError` for names that are unknown or have no derivative.
    """

    def measure(task: Task, driven: Drive) -> dict[str, Any]:
        end, observed = simulate(driven, segment=segment, differentiable=True)
        values_of_motion = motion_of(task, driven, end, observed)
        return {**values_of_motion, "fitness": fitness_of(task, values_of_motion)}

    def measured(task: Task) -> dict[str, Any]:
        driven = changed(task, actuator, values)
        if horizon is not None:
            driven = replace(driven, inputs=jax.tree.map(lambda x: x[:horizon], driven.inputs))
        if task.placements is None:
            return measure(task, driven)
        # Checkpointed: what reverse mode keeps is one simulation's, not all of them.
        anew = jax.checkpoint(lambda x: measure(task, shift_energy(driven, x)))
        return _mean(jax.lax.map(anew, task.placements))

    if task.trials == 1:
        results = measured(task)
    else:
        results = _mean(in_trials(task, jax.checkpoint(measured)))
    known = [name for name in results if name not in WITHOUT_GRADIENT]
    unknown = [name for name in of if name not in known]
    if unknown:
        raise ValueError(f"`of` must be of {', '.join(known)}, got {', '.join(unknown)}")
    return jnp.stack([results[name] for name in of])


def _mean(results: dict[str, Any]) -> dict[str, Any]:
    return jax.tree.map(lambda x: jnp.mean(x, 0), results)


def value_and_jacobian(
    task: Task,
    actuator: Actuator,
    values: Values,
    of: tuple[str, ...] = ("fitness",),
    *,
    horizon: int | None = None,
    segment: int | None = None,
) -> tuple[Float[Array, "output"], Values]:
    """Return the result of `measures`, and its derivatives by each of `values`, outputs first.

    `segment` is that of `world.rollout`: without it the memory grows with the horizon.
    """
    # One simulation forwards serves the derivatives of all outputs.
    results, pull = jax.vjp(
        lambda values: measures(task, actuator, values, of, horizon=horizon, segment=segment),
        values,
    )
    rows = mapped(lambda one: pull(one)[0], jnp.eye(len(of), dtype=results.dtype))
    return results, rows


def genes_of(actuator: Any) -> Float[Array, "gene"]:
    """Return genes as one vector: a network's weights and biases, or a vector's values."""
    if isinstance(actuator, Vector):
        return jnp.asarray(actuator.values)
    if isinstance(actuator, BodyGraph):
        return genes_of(actuator.network)
    return jnp.concatenate([jnp.asarray(actuator.weight), jnp.asarray(actuator.bias)])


def with_genes(actuator: Any, genes: Float[Array, "gene"]) -> Any:
    """Return the actuator with other genes; see `genes_of`."""
    if isinstance(actuator, Vector):
        return Vector(genes)
    if isinstance(actuator, BodyGraph):
        return replace(actuator, network=with_genes(actuator.network, genes))
    assert isinstance(actuator, CPPN)
    weights = actuator.weight.shape[0]
    return replace(actuator, weight=genes[:weights], bias=genes[weights:])


class Slopes(eqx.Module):
    """Derivatives by genes: of fitness first, then of every descriptor."""

    rows: Float[Array, "*block output gene"]
    finite: Bool[Array, "*block"]
    """True if the simulation and all derivatives stayed finite."""


def slopes(
    task: Task, genotype: Genotype, descriptors: tuple[str, ...], segment: int | None = None
) -> Slopes:
    """Return derivatives of fitness and of descriptors, by name, of one creature."""
    values = parts(task, genotype, ("genes",))
    of = ("fitness", *descriptors)
    results, rows = value_and_jacobian(task, genotype, values, of, segment=segment)
    finite = jnp.all(jnp.isfinite(results)) & jnp.all(jnp.isfinite(rows["genes"]))
    return Slopes(jnp.nan_to_num(rows["genes"]), finite)


def unit(rows: Float[Array, "*block gene"]) -> Float[Array, "*block gene"]:
    """Scale rows to length 1; those of length 0 stay."""
    # The constant stands inside: the root has no finite derivative at 0.
    length = jnp.sqrt(jnp.sum(rows * rows, -1, keepdims=True) + 1e-30)
    return rows / length


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
        values = parts(task, actuator, by)
        program = _gradient(task, actuator, of)
        exact, error = np.asarray(program(values)[1]), _error(program, values)
    task, actuator = build(jnp.dtype("float32"))
    values, driven = (
        parts(task, actuator, by),
        drive(task, actuator, differentiable=True),
    )
    program = _gradient(task, actuator, of)
    value, own = jax.device_get(program(values))
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
        value=float(value),
        errors={"float64": error, "float32": _length(own - exact) / max(_length(exact), 1e-30)},
        norms=norms | {steps: _length(own)},
        sign_agreement=float(((np.sign(others) == np.sign(own)) @ size).mean()),
        cosine=float((others @ own / np.maximum(lengths, 1e-30)).mean()),
        starts=starts,
        limited=float(motion_of(task, driven, end, observed)["limited"]),
    )


def _length(vector: Any) -> float:
    return float(np.linalg.norm(vector))


def _flat(values: Values) -> Float[Array, "value"]:
    return ravel_pytree(values)[0]


def _gradient(
    task: Task, actuator: Actuator, of: str, horizon: int | None = None
) -> Callable[[Values], tuple[Array, Array]]:
    """Return the program from values to the measure and its gradient as one vector."""

    def both(values):
        def measure(values):
            return measures(task, actuator, values, (of,), horizon=horizon)[0]

        value, rows = jax.value_and_grad(measure)(values)
        return value, _flat(rows)

    return jax.jit(both, compiler_options=compiler_options())


def _error(program: Callable, values: Values) -> float:
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
) -> Callable[[Values], Float[Array, "start value"]]:
    """Return the program from values to gradients with other phases, places and directions."""
    spread = Spread(viscosity=0.0, energy=False)
    keys = jax.random.split(jax.random.key(0), starts)
    size = task.world.size
    draws = jax.vmap(lambda key: disturbance(spread, size, key=key))(keys)

    def one(values, change: Disturbance):
        begun = replace(task, phase=change.phase, start=moved(task.start, change))

        def measure(values):
            return measures(begun, actuator, values, (of,))[0]

        return _flat(jax.grad(measure)(values))

    return jax.jit(
        lambda values: mapped(lambda change: one(values, change), draws),
        compiler_options=compiler_options(),
    )
