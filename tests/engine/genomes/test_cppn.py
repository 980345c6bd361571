"""CPPNs compute the recursion over their genes and control bodies within their scales."""

import json
import math
import runpy
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import bodies, genomes, naming, neat
from microcosmos.build import build_controls
from microcosmos.spec import Chain, Control, shape

INPUTS, OUTPUTS = 3, 2

RATES = neat.Rates(0.5, 0.5, 0.1, 0.3, toggle=0.2, add_node=0.6, add_connection=0.8)

FUNCTIONS = {
    "identity": lambda z: z,
    "sigmoid": lambda z: 1 / (1 + math.exp(-z)),
    "tanh": math.tanh,
    "relu": lambda z: max(z, 0.0),
    "sin": math.sin,
    "cos": math.cos,
    "gaussian": lambda z: math.exp(-z * z),
    "abs": abs,
    "square": lambda z: z * z,
}


@pytest.fixture(scope="module")
def networks():
    @jax.jit
    @jax.vmap
    def grow(key):
        def mutated(step, network):
            return neat.mutate(network, RATES, INPUTS, key=jax.random.fold_in(key, step))[0]

        first = neat.minimal(key, INPUTS, OUTPUTS, 16, 40)
        return jax.lax.fori_loop(0, 10, mutated, first)

    grown = jax.device_get(grow(jax.random.split(jax.random.key(1), 40)))
    return [genomes.take(grown, i) for i in range(40)]


def by_recursion(network, inputs):
    """The outputs for one point, from the definition, in double precision."""
    names = list(FUNCTIONS)

    def value(node):
        if node < INPUTS:
            return float(inputs[node])
        z = float(network.bias[node])
        for row in np.flatnonzero(network.connection_used & network.enabled):
            if network.target[row] == node:
                z += float(network.weight[row]) * value(network.source[row])
        return FUNCTIONS[names[network.activation[node]]](z)

    return [value(INPUTS + output) for output in range(OUTPUTS)]


def test_a_network_equals_the_recursion_over_its_genes(networks):
    assert tuple(genomes.ACTIVATIONS) == naming.ACTIVATIONS == tuple(FUNCTIONS)
    inputs = np.random.default_rng(0).uniform(-1, 1, (INPUTS, 5)).astype(np.float32)
    program = jax.jit(lambda network, x: genomes.evaluate(network, x, OUTPUTS))
    for network in networks:
        expected = np.transpose([by_recursion(network, point) for point in inputs.T])
        np.testing.assert_allclose(program(network, inputs), expected, rtol=2e-4, atol=2e-4)


def test_growing_squares_stay_finite():
    network = genomes.empty(16, 40)
    network.node_used[:15] = True
    network.activation[3:15] = list(FUNCTIONS).index("square")
    chain = [0, *range(5, 15), 3]
    for row, (source, target) in enumerate(pairwise(chain)):
        network.source[row], network.target[row] = source, target
        network.weight[row] = 10
        network.connection_used[row] = network.enabled[row] = True
    network = jax.tree.map(jnp.asarray, network)
    out = genomes.evaluate(network, jnp.full((INPUTS, 1), 100.0), OUTPUTS)
    assert np.isfinite(out).all()


def test_genes_survive_the_file(networks):
    for network in networks:
        node_id = np.where(network.node_used, np.arange(16) * 3, 0)
        innovation = np.where(network.connection_used, np.arange(40) * 2, 0)
        numbers = {"node_id": jnp.asarray(node_id), "innovation": jnp.asarray(innovation)}
        numbered = jax.device_get(replace(jax.tree.map(jnp.asarray, network), **numbers))
        back = genomes.from_genes(genomes.to_genes(numbered), 16, 40)
        for name, values in vars(numbered).items():
            np.testing.assert_array_equal(getattr(back, name), values, err_msg=name)
    # Zero has one form.
    assert naming.encode(np.array([-0.0])) == naming.encode(np.array([0.0]))


BODY = shape(Chain(nodes=12))
STEPS = 120


def controls(**changes):
    return build_controls(Control(period=40, **changes), BODY, STEPS)


@pytest.fixture(scope="module")
def network():
    return neat.minimal(jax.random.key(2), 5, 2, 8, 10)


@pytest.mark.long
def test_actuation_grows_from_the_rest_shape_over_the_ramp_and_repeats(network):
    rest = genomes.develop(network, controls(ramp=2))
    np.testing.assert_array_equal(rest.angle[0], BODY.rest_angle)
    np.testing.assert_array_equal(rest.length[0], BODY.rest_length)
    full = genomes.develop(network, controls(ramp=0))
    np.testing.assert_allclose(rest.angle[20], 0.25 * full.angle[20], rtol=1e-6)
    np.testing.assert_array_equal(rest.angle[80:], full.angle[80:])
    # A periodic timer repeats the shape.
    np.testing.assert_allclose(full.angle[:40], full.angle[40:80], atol=1e-5)


def test_a_linear_timer_and_positions_run_from_zero_or_minus_one_to_one():
    found = controls(timer="linear", position="unit")
    np.testing.assert_allclose(found.sites, BODY.arc[None])
    np.testing.assert_allclose(found.timer, np.arange(STEPS)[None] / STEPS)
    (position,) = controls().sites
    assert (position[0], position[-1]) == (-1, 1)


def test_a_second_sine_and_cosine_travel_along_the_body():
    found = controls(ramp=0, wave_number=1.5, angle_scale=0.5)
    assert found.inputs == 5
    # A network that hands on its fourth input commands a travelling wave.
    network = neat.minimal(jax.random.key(0), 5, 2, 8, 10, palette=(0,))
    chosen = (network.source == 3) & (network.target == 5)
    network = replace(
        network,
        bias=jnp.zeros_like(network.bias),
        weight=jnp.where(chosen, 0.1, 0.0),
    )
    rest = genomes.develop(network, found)
    at = BODY.arc[found.joint_nodes]
    phase = 2 * np.pi * (np.arange(STEPS)[:, None] / 40 - 1.5 * at[None])
    expected = 0.5 * np.tanh(0.1 * np.sin(phase)) + BODY.rest_angle
    np.testing.assert_allclose(rest.angle, expected, atol=1e-6)
    assert controls(wave_number=None).inputs == 3
    assert controls(timer="linear").inputs == 2


WEB = Path(__file__).parents[3] / "web"


@pytest.mark.optimised
def test_the_fixture_of_the_page_is_what_the_engine_computes_now():
    kept = json.loads((WEB / "src" / "decode" / "networks.fixture.json").read_text())
    cases = runpy.run_path(str(WEB / "scripts" / "networks.py"))["cases"]()
    made = json.loads(json.dumps(cases))
    assert [case["genome"] for case in made] == [case["genome"] for case in kept]
    for now, then in zip(made, kept, strict=True):
        np.testing.assert_allclose(now["expected"], then["expected"], rtol=1e-4, atol=1e-4)


def test_a_gain_multiplies_what_bends_a_joint_and_one_changes_no_bit(network):
    plain = controls(ramp=0)
    rest = genomes.develop(network, plain)
    gain = np.where(np.arange(10) < 4, -1.0, 0.25)
    found = genomes.develop(network, replace(plain, gain=gain))
    bent = rest.angle - BODY.rest_angle[None]
    np.testing.assert_allclose(
        found.angle - BODY.rest_angle[None], gain[None] * bent, atol=1e-6
    )
    np.testing.assert_array_equal(found.length, rest.length)
    same = genomes.develop(network, replace(plain, gain=np.ones(10)))
    np.testing.assert_array_equal(same.angle, rest.angle)


STAR = bodies.star(5, 6, 1.0)


def test_waves_run_outward_along_every_arm_of_a_star_with_anatomy():
    found = build_controls(Control(wave_number=1.5, anatomy=True), STAR, STEPS)
    outward = np.r_[0, np.tile(np.arange(1, 7) / 6, 5)]
    np.testing.assert_allclose(found.wave, 2 * np.pi * 1.5 * outward)
    unit = build_controls(Control(position="unit", anatomy=True), STAR, STEPS)
    np.testing.assert_allclose(unit.sites[0], outward, atol=1e-12)
