"""Write networks with the outputs that the engine computes, for tests of the page.

`.venv/bin/python web/scripts/networks.py > web/src/decode/networks.fixture.json`. A test of the
engine computes the numbers again and compares them, so that the file stays up to date.
"""

import json
from dataclasses import replace
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from microcosmos import genomes, neat
from microcosmos.naming import encode

ROWS, COLUMNS = 48, 96
"""Places along the body and times of the page's pictures."""
COMPARED = np.ix_([0, 5, 31, 95], [0, 17, 30, 47])
"""Columns and rows of the compared values."""
PERIOD, STEPS = 20, 60
NAMES = ("position", "sine", "cosine")
WITH_WAVE = (*NAMES, "wave_sine", "wave_cosine")
WAVES = 1.5
OUTPUTS = ("rest_angle", "rest_length")
RATES = neat.Rates(0.5, 0.5, 0.1, 0.3, toggle=0.2, add_node=0.6, add_connection=0.8)
PLACES = np.linspace(-1, 1, ROWS)


def cases() -> list[dict[str, Any]]:
    """Networks of each kind with their outputs at some places and times."""
    forward = [_forward(network) for network in _grown(6)]
    return [*forward, _recurrent()]


def _grown(count: int) -> list[genomes.CPPN]:
    def grow(key):
        def mutated(network, step):
            key_now = jax.random.fold_in(key, step)
            return neat.mutate(network, RATES, len(WITH_WAVE), key=key_now)[0], None

        first = neat.minimal(key, len(WITH_WAVE), len(OUTPUTS), 16, 40)
        return jax.lax.scan(mutated, first, jnp.arange(10))[0]

    whole = jax.jit(jax.vmap(grow))(jax.random.split(jax.random.key(1), count))
    return [genomes.take(whole, i) for i in range(count)]


def _grid() -> jnp.ndarray:
    """Inputs (input, point) of one period, times first; the last two travel."""
    phase = np.repeat(2 * np.pi * np.arange(COLUMNS) / COLUMNS, ROWS)
    places = np.tile(PLACES, COLUMNS)
    lagging = phase - 2 * np.pi * WAVES * (places + 1) / 2
    rows = [places, np.sin(phase), np.cos(phase), np.sin(lagging), np.cos(lagging)]
    return jnp.asarray(np.stack(rows), jnp.float32)


@jax.jit
def _evaluate(network: genomes.CPPN, inputs: jax.Array) -> jax.Array:
    return genomes.evaluate(network, inputs, len(OUTPUTS))


def _forward(network: genomes.CPPN) -> dict[str, Any]:
    # A generation numbers new genes. Short fractions do not show how a machine rounds.
    network = replace(
        jax.tree.map(jnp.asarray, network),
        node_id=jnp.arange(network.node_id.shape[0]),
        innovation=jnp.arange(network.innovation.shape[0]),
        weight=_shortened(network.weight),
        bias=_shortened(network.bias),
    )
    outputs = _evaluate(network, _grid())
    control = {"wave_number": WAVES}
    return _case(genomes.to_genes(network), control, np.asarray(outputs), WITH_WAVE)


def _shortened(values: np.ndarray) -> jnp.ndarray:
    return jnp.round(values * 1024) / 1024


def _recurrent() -> dict[str, Any]:
    """A network with cycles over three periods, of which the last is compared."""
    links = {(0, 5): 1.2, (1, 5): -0.7, (2, 6): 0.5, (5, 5): 0.8, (5, 6): 1.1, (6, 5): -0.6,
             (6, 3): 0.9, (5, 4): 0.5, (3, 6): 0.4}  # fmt: skip
    genes = {
        "nodes": {
            "id": list(range(7)),
            "activation": ["identity"] * 3 + ["tanh", "sin", "gaussian", "sin"],
            "bias": encode(np.array([0, 0, 0, 0.1, -0.2, 0.3, 0.05])),
        },
        "connections": {
            "innovation": list(range(len(links))),
            "source": [source for source, _ in links],
            "target": [target for _, target in links],
            "enabled": [True] * len(links),
            "weight": encode(np.array(list(links.values()))),
        },
    }
    network = jax.tree.map(jnp.asarray, genomes.from_genes(genes, 8, 12))
    values, outputs = jnp.zeros((8, ROWS), jnp.float32), []
    advance = jax.jit(genomes.advance)
    for sine, cosine in genomes.sine_cosine(STEPS, float(PERIOD)).T:
        clock = np.repeat([[sine], [cosine]], ROWS, 1)
        inputs = jnp.asarray(np.concatenate([PLACES[None], clock]), jnp.float32)
        values = advance(network, values, inputs)
        outputs.append(np.asarray(values[3:5]))
    steps = STEPS - PERIOD + np.arange(COLUMNS) * PERIOD // COLUMNS
    found = np.stack(outputs)[steps].swapaxes(0, 1).reshape(2, -1)
    return _case(genes, {"recurrent": True}, found)


def _case(
    genes: dict[str, Any],
    control: dict[str, Any],
    outputs: np.ndarray,
    inputs: tuple[str, ...] = NAMES,
) -> dict[str, Any]:
    clock = {"timer": "sine-cosine", "period": PERIOD, "position": "signed"}
    common = {"encoding": "cppn", "inputs": inputs, "outputs": OUTPUTS}
    values = outputs.reshape(len(OUTPUTS), COLUMNS, ROWS)
    return {
        "genome": {**common, "control": {**clock, **control}, **genes},
        "steps": STEPS,
        "expected": [output[COMPARED].tolist() for output in values],
    }


def main() -> None:
    print(json.dumps(cases()))


if __name__ == "__main__":
    main()
