"""Calls of the native kernel with wrong operands or numbers are errors, not crashes."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from kernel_scenes import SCENES, controlled, run

from microcosmos import world
from microcosmos.search.window import summarise

pytest.importorskip(
    "microcosmos_kernels", reason="microcosmos-kernels is not installed: no compiler?"
)
native = world.native

PLANES = ["a plane"] * 9
BODY = ["positions", "angles", "edges", "joints", "member", "piece", "present"]
LAYOUT = ["layout angles", "layout rest angles", "bends"]
CONTROLLER = [
    "bounds of the controller",
    *["activations", "biases", "sources", "targets", "weights", "timer", "ramp"],
    "sites",
    "lags",
    "nodes of joints",
    "gains of joints",
    "rest angles of the body",
    "rest lengths of the body",
    "basis",
    "genes",
]
OPERANDS = {
    "rollout": [
        *PLANES,
        *BODY,
        *LAYOUT,
        "colours of edges",
        "colours of joints",
        "whole turns",
        *["stretch", "shear", "bend", "parameters", "boxes", "energy", "collected"],
        "smoothing across rows",
        "smoothing along rows",
        "uniform force",
        "forces across rows",
        "forces along rows",
        "walls",
        "displacements across rows",
        "displacements along rows",
        "strength of the sponge",
        "velocity of the sponge",
        "rest angles",
        "rest lengths",
        *CONTROLLER,
    ],
    "develop": [*BODY, *LAYOUT, *CONTROLLER],
    "summarise": [
        *PLANES,
        *["uniform force", "forces across rows", "forces along rows", "walls"],
        *["positions", "angles", "edges", "joints", "member", "present", "boxes", "collected"],
        "rest angles",
        "rest lengths",
        *("centre", "path", "speed", "node speed", "held", "heading", "curvature", "power"),
        *("force", "box", "clock", "scales"),
    ],
}
"""Names of operands in errors, in their order."""


def rollout():
    native.rollout(*SCENES["energy that is taken and spreads"]())


def closed_loop():
    """A rollout of a network that senses, carried out by actuators."""
    native.rollout(*controlled(sense_energy=True))


def develop():
    native.develop(*controlled())


def develop_genes():
    native.develop(*controlled(encoding="direct"))


def summary():
    box, start, rest = SCENES["energy that is taken and spreads"]()
    end, observed = run(native.rollout, (box, start, rest))
    summarise(box, start, end, observed, jnp.arange(1.0, 101), 20.0, 20.0)


CALLS = {
    "rollout": rollout,
    "rollout in closed loop": closed_loop,
    "develop": develop,
    "develop genes": develop_genes,
    "summarise": summary,
}


@pytest.fixture(params=["rollout", "develop", "summarise"])
def name(request):
    return request.param


@pytest.fixture
def call(name, monkeypatch):
    """The target, results, operands and numbers of a correct call."""
    made, carry_out = [], native.call

    def record(*given):
        made.append(given)
        return carry_out(*given)

    monkeypatch.setattr(native, "call", record)
    CALLS[name]()
    target, shapes, operands, numbers = made[-1]
    return target, shapes, [np.asarray(operand) for operand in operands], numbers


def carry_out(target, shapes, operands, numbers):
    results = [jax.ShapeDtypeStruct(shape, jnp.float32) for shape in shapes]
    given = {name: np.int32(value) for name, value in numbers.items()}
    return jax.block_until_ready(jax.ffi.ffi_call(target, results)(*operands, **given))


def test_the_recorded_call_is_carried_out(call):
    assert all(np.isfinite(found).all() for found in carry_out(*call))


@pytest.mark.long
@pytest.mark.parametrize("change", ["longer", "deeper", "of integers"])
def test_an_operand_of_another_shape_or_type_is_an_error_that_names_it(name, call, change):
    target, shapes, operands, numbers = call
    for place, (label, operand) in enumerate(zip(OPERANDS[name], operands, strict=True)):
        if change == "longer":
            wrong = np.zeros((operand.shape[0] + 1, *operand.shape[1:]), operand.dtype)
        elif change == "deeper":
            wrong = operand[..., None]
        else:
            wrong = np.zeros(operand.shape, np.int16)
        given = [*operands[:place], wrong, *operands[place + 1 :]]
        with pytest.raises(
            Exception, match=f"microcosmos-kernels: {label} must have the shape"
        ):
            carry_out(target, shapes, given, numbers)


def test_a_result_of_another_shape_is_an_error(call):
    target, shapes, operands, numbers = call
    for place, shape in enumerate(shapes):
        wrong = [*shapes[:place], (*shape[:-1], shape[-1] + 1), *shapes[place + 1 :]]
        with pytest.raises(Exception, match="must have the shape"):
            carry_out(target, wrong, operands, numbers)


COUNTS = {
    *("steps", "nodes", "edges", "joints", "bodies", "rows", "links", "sites", "timers"),
    *("terms", "height", "width"),
}


@pytest.mark.parametrize("value", [-1, "one more", 2**31 - 1])
def test_a_count_out_of_range_is_an_error(call, value):
    target, shapes, operands, numbers = call
    for one in COUNTS & set(numbers):
        wrong = numbers[one] + 1 if value == "one more" else value
        if one == "bodies" and "develop" in target and value == "one more":
            continue  # One that has no nodes changes nothing there.
        with pytest.raises(Exception, match="microcosmos-kernels: "):
            carry_out(target, shapes, operands, numbers | {one: wrong})


@pytest.mark.parametrize("name", CALLS)
@pytest.mark.parametrize("value", [-2, 2**31 - 1])
def test_a_reference_to_what_is_not_there_is_an_error(call, value):
    target, shapes, operands, numbers = call
    for place, operand in enumerate(operands):  # No world here has walls.
        if operand.dtype != np.int32 or not operand.size:
            continue
        for at in (0, operand.size - 1):
            wrong = operand.copy()
            wrong.flat[at] = value
            given = [*operands[:place], wrong, *operands[place + 1 :]]
            with pytest.raises(Exception, match="refers to what it lacks"):
                carry_out(target, shapes, given, numbers)


@pytest.mark.parametrize("name", CALLS)
def test_other_numbers_in_operands_never_crash(call):
    """What is drawn is within the counts, but no sensible body, network or motion."""
    target, shapes, operands, numbers = call
    rng = np.random.default_rng(0)
    for _ in range(20):
        given = [scrambled(operand, rng) for operand in operands]
        carry_out(target, shapes, given, numbers)


def scrambled(operand, rng):
    """Return an operand with other references, or with numbers of any size and none."""
    if not operand.size or np.min(operand) == -1:  # Inputs of a network have no activation.
        return operand
    if operand.dtype == np.int32:
        return rng.permutation(np.ravel(operand)).reshape(operand.shape)
    odd = rng.choice(np.float32([np.nan, np.inf, -np.inf, 1e30, -1e30, 0]), operand.shape)
    return np.where(rng.random(operand.shape) < 0.02, odd, operand)
