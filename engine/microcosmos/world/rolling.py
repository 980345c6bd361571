"""Rollouts: many steps of a world under control."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, PyTree

from .. import filaments
from .model import Measures, State, World
from .stepping import step


def follow(world: World, state: State, rest: filaments.Rest) -> filaments.Rest:
    """Open-loop control: inputs are rest shapes."""
    return rest


def keep_memory(world: World, state: State, given: Any) -> PyTree[Array]:
    return state.memory


def rollout(
    world: World,
    state: State,
    inputs: PyTree[Array],
    observe: Callable[[State, Measures], Any] = lambda state, measures: None,
    control: Callable[[World, State, Any], filaments.Rest] = follow,
    remember: Callable[[World, State, Any], PyTree[Array]] = keep_memory,
    segment: int | None = None,
) -> tuple[State, Any]:
    """Return the state after all steps of `inputs` (time first), and observations of each.

    In each step `remember` sets the state's memory, then `control` makes the rest shape from
    the world, the state and the inputs. With `segment`, reverse mode keeps the state only
    after every `segment` steps and repeats the steps (Griewank and Walther, ACM Trans. Math.
    Softw. 26, 19, 2000, with two levels).
    """

    def advance(state, given):
        state = replace(state, memory=remember(world, state, given))
        state, measures = step(world, state, control(world, state, given))
        return state, observe(state, measures)

    if segment is None:
        return jax.lax.scan(advance, state, inputs)
    steps = len(jax.tree.leaves(inputs)[0])
    whole = steps - steps % segment

    def cut(x):
        return x[:whole].reshape(whole // segment, segment, *x.shape[1:])

    def joined(many, few):
        return jnp.concatenate([many.reshape(-1, *many.shape[2:]), few])

    # XLA does not merge repeated steps across a loop.
    segments = jax.checkpoint(partial(jax.lax.scan, advance), prevent_cse=False)
    state, seen = jax.lax.scan(segments, state, jax.tree.map(cut, inputs))
    state, last = jax.lax.scan(advance, state, jax.tree.map(lambda x: x[whole:], inputs))
    return state, jax.tree.map(joined, seen, last)
