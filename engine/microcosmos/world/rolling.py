"""Many steps of a world under control."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import jax
from jaxtyping import Array, PyTree

from .. import filaments
from .model import Measures, State, World
from .stepping import step


def follow(world: World, state: State, rest: filaments.Rest) -> filaments.Rest:
    """Open-loop control: the rest shape is what was given."""
    return rest


def keep(world: World, state: State, given: Any) -> PyTree[Array]:
    """Nothing new is remembered."""
    return state.memory


def rollout(
    world: World,
    state: State,
    inputs: PyTree[Array],
    observe: Callable[[State, Measures], Any] = lambda state, measures: None,
    control: Callable[[World, State, Any], filaments.Rest] = follow,
    remember: Callable[[World, State, Any], PyTree[Array]] = keep,
) -> tuple[State, Any]:
    """The state after all steps of `inputs` (time first), and what was observed after each.

    `control` makes the rest shape of a step from the world as it stands and the inputs of
    that time; as it is, inputs are rest shapes. Before that, `remember` says what the state's
    memory is to hold in this step.
    """

    def advance(state, given):
        state = replace(state, memory=remember(world, state, given))
        state, measures = step(world, state, control(world, state, given))
        return state, observe(state, measures)

    return jax.lax.scan(advance, state, inputs)
