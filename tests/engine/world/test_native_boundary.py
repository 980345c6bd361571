"""Calls of the native kernel with wrong operands or numbers are errors, not crashes."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from kernel_scenes import SCENES

from microcosmos import world

pytest.importorskip(
    "microcosmos_kernels", reason="microcosmos-kernels is not installed: no compiler?"
)
native = world.native


@pytest.fixture
def call(monkeypatch):
    """The target, results, operands and numbers of a correct call of a rollout."""
    made = []
    monkeypatch.setattr(native, "call", lambda *given: made.append(given) or stop())
    with pytest.raises(Stop):
        native.rollout(*SCENES["energy that is taken and spreads"]())
    return made[0]


class Stop(Exception):
    """The call was recorded."""


def stop():
    raise Stop


def carry_out(target, shapes, operands, numbers):
    results = [jax.ShapeDtypeStruct(shape, jnp.float32) for shape in shapes]
    given = {name: np.int32(value) for name, value in numbers.items()}
    return jax.block_until_ready(jax.ffi.ffi_call(target, results)(*operands, **given))


def test_the_recorded_call_is_carried_out(call):
    assert all(np.isfinite(found).all() for found in carry_out(*call))


@pytest.mark.parametrize("change", ["longer", "deeper", "of integers"])
def test_an_operand_of_another_shape_or_type_is_an_error(call, change):
    target, shapes, operands, numbers = call
    for place, operand in enumerate(operands):
        if change == "longer":
            wrong = jnp.zeros((operand.shape[0] + 1, *operand.shape[1:]), operand.dtype)
        elif change == "deeper":
            wrong = operand[..., None]
        else:
            wrong = operand.astype(jnp.int16)
        given = [*operands[:place], wrong, *operands[place + 1 :]]
        with pytest.raises(Exception, match=r"must have the shape|must have two axes"):
            carry_out(target, shapes, given, numbers)


def test_an_operand_too_few_or_too_many_is_an_error(call):
    target, shapes, operands, numbers = call
    for given in (operands[:-1], [*operands, operands[-1]], []):
        with pytest.raises(Exception, match=r"there is no operand|a rollout has \d+ operands"):
            carry_out(target, shapes, given, numbers)


def test_a_result_of_another_shape_is_an_error(call):
    target, shapes, operands, numbers = call
    for place, shape in enumerate(shapes):
        wrong = [*shapes[:place], (*shape[:-1], shape[-1] + 1), *shapes[place + 1 :]]
        with pytest.raises(Exception, match="must have the shape"):
            carry_out(target, wrong, operands, numbers)


def test_a_missing_number_is_an_error(call):
    target, shapes, operands, numbers = call
    for name in numbers:
        fewer = {key: value for key, value in numbers.items() if key != name}
        with pytest.raises(Exception, match=f"there is no number {name}"):
            carry_out(target, shapes, operands, fewer)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        *((name, -1) for name in ("steps", "nodes", "edges", "joints", "rows", "links")),
        *((name, -1) for name in ("height", "commands", "projection", "delta", "sweeps")),
        *((name, 3) for name in ("commands", "projection", "delta", "layers", "timers")),
        *((name, 0) for name in ("nodes", "bodies", "iterations", "layers")),
        ("width", 3),
        ("nodes", 2**31 - 1),
    ],
)
def test_a_number_out_of_range_is_an_error(call, name, value):
    target, shapes, operands, numbers = call
    with pytest.raises(Exception, match="microcosmos-kernels: "):
        carry_out(target, shapes, operands, numbers | {name: value})
