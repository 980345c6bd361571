"""Closed loops: a network that senses energy steers by it, and can be differentiated."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import bodies, fields, genomes, search
from microcosmos.build import build_controls
from microcosmos.spec import Control
from validation import scenes

STEPS, SIZE, H = 60, (32, 32), 1e-5


@pytest.fixture
def network(float64):
    """A function that makes a CPPN; what it senses has a weight."""

    def cppn(inputs, sensing=0.0):
        genes, names = genomes.empty(8, 16), list(genomes.ACTIVATIONS)
        bend, stretch = inputs, inputs + 1
        links = {(0, bend): 1.5, (1, bend): 1.1, (2, bend): -0.8, (1, stretch): 0.6}
        if inputs == 4:
            links |= {(3, bend): sensing, (3, stretch): 0.5 * sensing}
        genes.node_used[: inputs + 2] = True
        genes.node_id[: inputs + 2] = np.arange(inputs + 2)
        genes.activation[bend : stretch + 1] = [names.index("sin"), names.index("tanh")]
        count = len(links)
        genes.connection_used[:count] = genes.enabled[:count] = True
        genes.innovation[:count] = np.arange(count)
        genes.source[:count], genes.target[:count] = np.transpose(list(links))
        genes.weight[:count] = list(links.values())
        return jax.tree.map(
            lambda x: jnp.asarray(x, float64 if x.dtype == np.float32 else None), genes
        )

    return cppn


@pytest.fixture
def task(float64):
    """A function that makes the task of two chains side by side among packets."""

    def make(senses, seed=3, **options):
        one = bodies.chain(8, 1.0)
        body = bodies.together([bodies.placed(one, (0.0, y)) for y in (-1.0, 1.0)])
        packets = fields.packets(SIZE, fields.Packets(3, 3.0, 1.0, seed))
        energy = fields.Energy(jnp.asarray(packets), jnp.asarray(0.05), jnp.asarray(0.1))
        box, start = scenes.immersed(body, 0.1, float64, size=SIZE, energy=energy, **options)
        control = Control(period=30, angle_scale=0.2, length_scale=0.1, sense_energy=senses)
        controls = build_controls(control, body, STEPS)
        encoding = genomes.CPPNControl(controls, (8, 16))
        return search.Task(box, start, encoding, search.Goal(1.0, 0.1))

    return make


def measured(task):
    """A function from a network, and the energy at the start, to its measures by name."""

    @jax.jit
    def found(network, energy):
        start = replace(task.start, energy=energy)
        return search.evaluate(replace(task, start=start), network)

    def named(network, energy=task.start.energy):
        evaluation = found(network, energy)
        assert evaluation.status == 0
        return dict(zip(search.MEASURES, np.asarray(evaluation.measures), strict=True))

    return named


def test_only_a_network_that_heeds_energy_moves_otherwise_than_in_an_open_loop(task, network):
    opened, closed = measured(task(False))(network(3)), measured(task(True))
    elsewhere = task(True, seed=4).start.energy
    heedless = closed(network(4, 0.0))
    assert opened["displacement"] > 0.01
    for name in ("displacement", "path_length", "bending_effort", "energy", "mach"):
        assert heedless[name] == pytest.approx(opened[name], rel=1e-9, abs=1e-12), name
    unmoved = closed(network(4, 0.0), elsewhere)["bending_effort"]
    assert unmoved == pytest.approx(opened["bending_effort"], rel=1e-12)
    here, there = closed(network(4, 1.0)), closed(network(4, 1.0), elsewhere)
    assert abs(here["bending_effort"] / there["bending_effort"] - 1) > 1e-3


def test_a_response_is_what_a_batch_develops(network, float64):
    body = bodies.chain(9, 1.0)
    controls = build_controls(Control(period=30, ramp=0.2), body, STEPS)
    developed = genomes.develop(network(3), controls)
    sensing, cppn = replace(controls, senses=True), network(4, 0.0)
    respond = jax.jit(lambda *given: genomes.respond(cppn, sensing, *given))
    for t in (0, 7, 59):
        sensed = jnp.asarray(np.random.default_rng(t).uniform(0, 2, 9))
        rest = respond(jnp.asarray(controls.timer[:, t]), jnp.asarray(controls.ramp[t]), sensed)
        np.testing.assert_allclose(rest.angle, developed.angle[t], rtol=1e-13, atol=1e-15)
        np.testing.assert_allclose(rest.length, developed.length[t], rtol=1e-13)


def test_gradients_through_a_closed_loop_agree_with_finite_differences(task, network):
    # Weak enough that no displacement is cut: a cut is a kink.
    steric = fields.Steric(jnp.asarray(0.2), jnp.asarray(0.1), fields.binomial)
    whole, cppn = task(True, steric=steric), network(4, 1.0)

    @jax.jit
    @jax.value_and_grad
    def fitness(weights):
        return search.evaluate(whole, replace(cppn, weight=weights)).fitness

    along = jnp.asarray(np.random.default_rng(1).normal(size=cppn.weight.shape))
    slope = jnp.sum(fitness(cppn.weight)[1] * along)
    ahead, behind = (fitness(cppn.weight + h * along)[0] for h in (H, -H))
    np.testing.assert_allclose(slope, (ahead - behind) / (2 * H), rtol=1e-6)
    assert abs(slope) > 1e-3
