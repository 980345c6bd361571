"""A search of your own on networks, and on simulations, where it is an experiment's loop."""

import jax
import numpy as np
import pytest

from microcosmos import neat, search
from microcosmos.search import emitters

NETWORKS = search.Networks(inputs=2, outputs=1, nodes=8, connections=16)
CORNERS = np.array([[0, 0], [0, 1], [1, 0], [1, 1]], np.float32)
PAPER = neat.PRESETS["paper"]
SIZES = search.Grid((search.Axis(0, -0.5, 5.5, bins=6),))


def on_networks(emitter, seed=0):
    return search.Search(NETWORKS, SIZES, [emitter], seed=seed)


def learn_xor(loop, generations):
    """Fitness is 4 less the absolute errors, the measure the number of hidden nodes."""
    for _ in range(generations):
        networks = loop.ask()
        outputs = np.asarray(NETWORKS.outputs_of(networks, CORNERS))[:, :, 0]
        error = np.abs(outputs - [0, 1, 1, 0]).sum(1)
        hidden = np.sum(networks.node_used, 1) - 3
        loop.tell(4 - error, hidden[:, None])
    return loop


@pytest.mark.long
@pytest.mark.parametrize(
    ("emitter", "generations"),
    [
        (emitters.Neat(64, NETWORKS, PAPER.rates, 2, select="mixed"), 60),
        (emitters.PopulationNeat(150, NETWORKS, PAPER, 2, 1), 40),
    ],
    ids=["neat", "population"],
)
def test_neat_learns_xor_with_the_same_bytes_after_a_restart(emitter, generations):
    loop = learn_xor(on_networks(emitter), 4)
    halfway = loop.save()
    learn_xor(loop, generations - 4)
    assert loop.best.fitness > 3.0  # A line comes to 2 at most.
    found = jax.tree.map(lambda x: x[None], loop.best.genotypes)
    outputs = NETWORKS.outputs_of(found, CORNERS)[0, :, 0]
    assert (outputs.round() == np.array([0, 1, 1, 0])).all()
    again = on_networks(emitter)
    again.restore(halfway)
    assert learn_xor(again, generations - 4).save() == loop.save()
