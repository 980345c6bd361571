"""A model that learns from a run's own evaluations: ridge regression on random features.

The basis functions are cosines of random directions, which approximate a Gaussian kernel
(Rahimi and Recht, NeurIPS 2007), beside the inputs themselves. Recursive least squares
(Plackett, Biometrika 37, 149 (1950)) takes one evaluation after another, so that the size of
the model and the time of an update do not grow with a run. Learning is in double precision,
element by element; bits do not depend on the processor.
"""

from dataclasses import dataclass, replace

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int, PRNGKeyArray

from ...portable import cosine, long_product

COSINES = 256
"""Random features."""
WIDTH = 1.5
"""Width of the kernel, in standard deviations of an input times the root of their number."""
GAIN = 5.0
"""Size of all random features together, beside inputs of size 1."""
RIDGE = 1.0
"""Weight of the penalty on squared weights, in evaluations."""
READY = 128
"""Evaluations before predictions are used."""
WINDOW = 4096
"""Evaluations from which the model is learned anew, the newest."""
CLIP = 5.0
"""Largest standardised input."""
NEWEST = 0.2
"""Weight of a generation's squared errors in their running mean."""

Rows = Float[Array, "row input"]
Outputs = Float[Array, "row output"]


class Model(eqx.Module):
    """The learned regression; arrays of NumPy in double precision."""

    count: Int[np.ndarray, ""]
    """Evaluations learned."""
    inputs: Float[np.ndarray, "row input"]
    outputs: Float[np.ndarray, "row output"]
    """The newest evaluations, at most `WINDOW`."""
    middle: Float[np.ndarray, "input"]
    scale: Float[np.ndarray, "input"]
    """Mean and standard deviation of inputs when the model was last learned anew."""
    level: Float[np.ndarray, "output"]
    spread: Float[np.ndarray, "output"]
    """The same of outputs."""
    inverse: Float[np.ndarray, "function function"]
    """Inverse of Σ φ φᵀ + λ I over the evaluations since then, with basis functions φ."""
    weights: Float[np.ndarray, "function output"]
    errors: Float[np.ndarray, "output"]
    """Running mean of squared errors of predictions."""

    @property
    def ready(self) -> bool:
        """True once enough evaluations are learned for predictions to be used."""
        return bool(self.count >= READY)

    @property
    def predictor(self) -> "Model":
        """The model without its evaluations, whose number would compile programs anew."""
        return replace(self, inputs=self.inputs[:0], outputs=self.outputs[:0])


@dataclass(frozen=True)
class Regression:
    """The basis functions of a model, which follow from a key."""

    inputs: int
    outputs: int
    key: PRNGKeyArray

    def init(self) -> Model:
        """Return the model before any evaluation."""
        functions = COSINES + 1 + self.inputs
        return Model(
            count=np.zeros((), np.int64),
            inputs=np.zeros((0, self.inputs)),
            outputs=np.zeros((0, self.outputs)),
            middle=np.zeros(self.inputs),
            scale=np.ones(self.inputs),
            level=np.zeros(self.outputs),
            spread=np.ones(self.outputs),
            inverse=np.eye(functions) / RIDGE,
            weights=np.zeros((functions, self.outputs)),
            errors=np.zeros(self.outputs),
        )

    def basis(self, rows: Rows, model: Model) -> Float[Array, "row function"]:
        """Return the basis functions of inputs: cosines, 1, and the standardised inputs."""
        direction_key, phase_key = jax.random.split(self.key)
        directions = jax.random.normal(direction_key, (self.inputs, COSINES))
        directions = directions / (WIDTH * np.float32(np.sqrt(self.inputs)))
        phases = jax.random.uniform(phase_key, (COSINES,), maxval=2 * np.pi)
        middle, scale = (jnp.asarray(x, jnp.float32) for x in (model.middle, model.scale))
        standard = jnp.clip((rows - middle[None]) / scale[None], -CLIP, CLIP)
        waves = cosine(long_product(standard, directions) + phases[None])
        waves = GAIN * np.float32(np.sqrt(2 / COSINES)) * waves
        return jnp.concatenate([waves, jnp.ones_like(standard[:, :1]), standard], 1)

    def predict(self, rows: Rows, model: Model) -> Outputs:
        """Return predicted outputs."""
        level, spread, weights = (
            jnp.asarray(x, jnp.float32) for x in (model.level, model.spread, model.weights)
        )
        return level[None] + spread[None] * long_product(self.basis(rows, model), weights)


def learned(
    regression: Regression, model: Model, inputs: np.ndarray, outputs: np.ndarray
) -> Model:
    """Return the model after evaluations (row, input) and (row, output), in their order.

    Whenever the evaluations have doubled it is learned anew, with new scales, from the newest:
    a run's first creatures are not like its later ones.
    """
    count = int(model.count) + len(inputs)
    kept = np.concatenate([model.inputs, inputs.astype(float)])[-WINDOW:]
    known = np.concatenate([model.outputs, outputs.astype(float)])[-WINDOW:]
    anew = _doublings(count) > _doublings(int(model.count))
    model = replace(model, count=np.asarray(count), inputs=kept, outputs=known)
    if anew:
        # Scales that stay those of the first 128 creatures cost 6 % of the QD score (127
        # against 136, docs/evolution.md, "Screening").
        first, inputs, outputs = not _doublings(count - len(inputs)), kept, known
        model = _scaled(regression, model, first)
    if not model.ready:
        return model
    basis = np.asarray(regression.basis(jnp.asarray(inputs, jnp.float32), model))
    return _updated(model, basis.astype(float), outputs.astype(float))


def _doublings(count: int) -> int:
    """Return how often the evaluations have reached `READY` or its double, and so on."""
    return (count // READY).bit_length()


def _scaled(regression: Regression, model: Model, first: bool) -> Model:
    """Return a model that has learned nothing, with the scales of its newest evaluations."""
    (middle, scale), (level, spread) = _scales(model.inputs), _scales(model.outputs)
    empty = regression.init()
    return replace(
        empty,
        count=model.count,
        inputs=model.inputs,
        outputs=model.outputs,
        middle=middle,
        scale=scale,
        level=level,
        spread=spread,
        errors=spread * spread if first else model.errors,
    )


def _updated(model: Model, basis: np.ndarray, outputs: np.ndarray) -> Model:
    inverse, weights = model.inverse.copy(), model.weights.copy()
    standard = (outputs - model.level) / model.spread
    for phi, y in zip(basis, standard, strict=True):
        # Sums over the first axis add row after row on every processor.
        gain = np.sum(inverse * phi[:, None], 0)
        size = 1 + np.sum((gain * phi)[:, None], 0)
        inverse -= (gain / size)[:, None] * gain[None]
        weights += (gain / size)[:, None] * (y - np.sum(phi[:, None] * weights, 0))[None]
    return replace(model, inverse=inverse, weights=weights)


def with_errors(model: Model, predicted: np.ndarray, outputs: np.ndarray) -> Model:
    """Return the model with the errors of a generation's predictions.

    An error counts as at most three times their root mean square, so that a single creature
    does not make all others look uncertain.
    """
    if not len(predicted):
        return model
    squares = (predicted.astype(float) - outputs) ** 2
    new = np.sum(np.minimum(squares, 9 * model.errors), 0) / len(squares)
    return replace(model, errors=(1 - NEWEST) * model.errors + NEWEST * new)


def _scales(rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return means and standard deviations, at least a millionth."""
    rows = rows.astype(float)
    mean = np.sum(rows, 0) / len(rows)
    return mean, np.sqrt(np.sum((rows - mean) ** 2, 0) / len(rows)) + 1e-6
