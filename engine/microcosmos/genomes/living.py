"""Creatures in slots: each with a network, a clock and actuators of its own.

`live` is the reference of the native kernel's call of the same name. In every step each creature
carries out its last command in closed loop: bent no more than its bound, no faster than its pace,
and with its lag.
"""

from dataclasses import replace
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from .. import fields
from ..filaments import Rest
from ..portable import cosine, sine
from ..world import Controller, Network, State, World, flow, grown_rods, step
from ..world.senses import Stock, sensed
from ..world.slots import (
    Living,
    Means,
    Occupant,
    Slots,
    Step,
    Tally,
    by_slot,
    flat_state,
    inhabited,
    intake,
    place_of,
    with_state,
)
from .actuators import Actuators, bent, between, towards
from .control import advance
from .cppn import CPPN, Points, evaluate
from .development import OUTPUTS, travelling
from .encoding import Drive, shifted


def occupant(driven: Drive, actuators: Actuators | None, period: float, ramp: float) -> Occupant:
    """Return what a slot holds of a creature alone; `period` and `ramp` are in steps.

    Raises `ValueError` for a creature without a network, or whose timer is not periodic.
    """
    controller, place = driven.controller, driven.world
    if not isinstance(controller, Controller) or not isinstance(controller.commands, Network):
        raise ValueError("a creature in a slot must have a network as its controller.")
    network = controller.commands
    if network.timer.shape[1] != 2:
        raise ValueError("a creature in a slot must have a sine-cosine timer.")
    layout = driven.layout
    if layout is None:
        layout = place.layout if actuators is None else actuators.layout
    if layout is None:
        raise ValueError("a creature in a slot must have a layout, got swept constraints alone.")
    dtype = network.bias.dtype
    means = Means(
        controller.angle_scale,
        controller.length_scale,
        0.0 if controller.phase is None else controller.phase,
        jnp.inf if actuators is None or actuators.max_speed is None else actuators.max_speed,
        0.0 if actuators is None else actuators.lag,
        jnp.inf if actuators is None or actuators.max_bend is None else actuators.max_bend,
        period,
        ramp,
    )
    present = place.present
    return Occupant(
        rods=replace(place.rods, edge_colours=(), joint_colours=()),
        present=jnp.ones(len(place.groups.member), bool) if present is None else present,
        layout=layout,
        rest_length=controller.rest_length,
        network=replace(network, timer=jnp.zeros((0, 2), dtype)),
        means=jax.tree.map(lambda x: jnp.asarray(x, dtype), means),
    )


def live(
    place: World, slots: Slots, living: Living, steps: int, every: int = 1
) -> tuple[Living, Tally]:
    """Return what lives after a window of steps, and the measures of each slot.

    A creature is commanded at birth and `every` so many steps after.
    """
    box = inhabited(place, slots)
    if place.layout is None:
        box = replace(box, rods=grown_rods(box.rods, box.present))
    senses = slots.occupants.network.senses

    def advanced(living: Living, _: Any) -> tuple[Living, tuple[Step, Any]]:
        flat = flat_state(living)
        rows = sensed(box, flat, senses, _stock(place, living))
        rows = rows.reshape(len(senses), *living.positions.shape[:2])
        # What an empty slot would command may be no number, which would spread.
        living = _chosen(slots.filled, _act(slots.occupants, living, rows, every), living)
        rest = Rest(living.rest.angle.reshape(-1), living.rest.length.reshape(-1))
        end, seen = step(box, flat, rest, by_slot)
        age = living.age + slots.filled.astype(living.age.dtype)
        fed, changes = _fed(box, flat, living)
        return with_state(replace(fed, age=age), end), (seen, changes)

    before = place_of(box, flat_state(living))
    after, (seen, changes) = jax.lax.scan(advanced, living, length=steps)
    # An empty slot stays as it was.
    after = _chosen(slots.filled, after, living)
    tally = _added_up(place, slots, before, seen)
    if changes is not None:
        grown, lost = (jnp.sum(one, 0) for one in changes)
        tally = replace(tally, grown=grown, lost=lost)
    return after, replace(tally, intake=intake(living, after))


def _stock(place: World, living: Living) -> Stock | None:
    food, account = living.food, living.account
    if place.food is None or food is None or account is None:
        return None
    unit, full = place.food.unit, place.food.full
    return Stock(food.astype(unit.dtype) / unit, account.astype(full.dtype) / full)


def _fed(box: World, flat: State, living: Living) -> tuple[Living, Any]:
    """Return what lives after creatures have eaten where they stood before the step, and food
    has changed; with the quanta that have grown and that are lost."""
    given, food, account, time = box.food, living.food, living.account, living.time
    if given is None or food is None or account is None or time is None:
        return living, None
    hungry = box.groups.per_node(account < fields.food.FULL_ACCOUNT)
    assert box.present is not None
    food, ate = fields.eaten(food, flat.positions, box.present & hungry, given.bite)
    time, nothing = time + 1, jnp.zeros(len(food), food.dtype)
    food, grown, lost = jax.lax.cond(
        time % given.every == 0,
        lambda: fields.changed(food, given, flow(box, flat), box.surroundings.solid),
        lambda: (food, nothing, nothing),
    )
    account = account + box.groups.total(ate)
    return replace(living, food=food, account=account, time=time), (grown, lost)


def _act(
    occupants: Occupant, living: Living, rows: Float[Array, "sense slot node"], every: int
) -> Living:
    """Return what lives with the rest shapes of a step."""

    def one(occupant: Occupant, memory: tuple[Rest, Rest, Rest], values: Any, age: Any, rows: Any):
        command, paced, rest = memory
        ordered, commanded = _command(occupant, values, age, rows)
        due = age % every == 0
        command, values = jax.tree.map(
            lambda new, old: jnp.where(due, new, old), (ordered, commanded), (command, values)
        )
        means, layout = occupant.means, occupant.layout
        paced = towards(paced, command, layout, means.max_speed, occupant.present)
        return (command, paced, between(rest, paced, 1 / (1 + means.lag))), values

    memory = living.command, living.paced, living.rest
    over = jax.vmap(one, in_axes=(0, 0, 0, 0, 1))
    (command, paced, rest), values = over(occupants, memory, living.values, living.age, rows)
    return replace(living, command=command, paced=paced, rest=rest, values=values)


def _command(
    one: Occupant, values: Any, age: Int[Array, ""], rows: Float[Array, "sense node"]
) -> tuple[Rest, Any]:
    """Return the bounded command of a creature at an age, and the values of its network."""
    network, means, dtype = one.network, one.means, one.network.bias.dtype
    steps = age.astype(dtype)
    turn = 2 * jnp.pi * jnp.mod(steps, means.period) / means.period
    timer = jnp.stack([sine(turn), cosine(turn)])[:, None]
    ramp = jnp.minimum(1.0, (steps + (means.ramp <= 0)) / jnp.maximum(means.ramp, 1.0))
    timer = jnp.asarray(shifted(timer, means.phase))
    nodes = len(one.present)
    inputs = [network.sites, jnp.repeat(timer, nodes, 1)]
    if network.lag is not None:
        inputs.append(travelling(timer, network.lag).reshape(2, nodes))
    outputs, values = _outputs(network, values, jnp.concatenate([*inputs, rows]))
    angle, length = jnp.tanh(outputs)
    ends = one.rods.edges
    length = 0.5 * (length[ends[:, 0]] + length[ends[:, 1]])
    angle = angle[network.joint_node] * network.gain
    command = Rest(
        one.layout.rest_angle + means.angle_scale * ramp * angle,
        one.rest_length * (1 + means.length_scale * ramp * length),
    )
    edges = jnp.all(one.present[ends], 1) & (ends[:, 0] != ends[:, 1])
    return bent(command, one.layout, means.max_bend, edges), values


def _outputs(network: Network, values: Any, inputs: Points) -> tuple[Points, Any]:
    cppn = _cppn(network, len(inputs))
    if not network.recurrent:
        return evaluate(cppn, inputs, OUTPUTS), values
    values = advance(cppn, values, inputs)
    return values[len(inputs) : len(inputs) + OUTPUTS], values


def _cppn(network: Network, inputs: int) -> CPPN:
    """Return a network as the genes of a CPPN."""
    rows, used = len(network.bias), network.source >= 0
    return CPPN(
        node_used=(network.activation >= 0) | (np.arange(rows) < inputs),
        node_id=jnp.arange(rows),
        activation=jnp.maximum(network.activation, 0),
        bias=network.bias,
        connection_used=used,
        innovation=jnp.zeros_like(network.source),
        source=jnp.maximum(network.source, 0),
        target=network.target,
        enabled=used,
        weight=network.weight,
    )


def _chosen(filled: Any, after: Living, before: Living) -> Living:
    def chosen(new, old):
        return jnp.where(filled.reshape(-1, *(1,) * (new.ndim - 1)), new, old)

    of_slots = {
        name: jax.tree.map(chosen, getattr(after, name), getattr(before, name))
        for name in ("command", "paced", "rest", "values", "positions", "angles", "boxes")
    }
    if after.account is not None:
        of_slots["account"] = chosen(after.account, before.account)
    if after.collected is not None:
        of_slots["collected"] = chosen(after.collected, before.collected)
    return replace(after, **of_slots)


def _added_up(place: World, slots: Slots, before: Any, seen: Step) -> Tally:
    """Return the measures of a window from those of its steps, time first."""
    size = jnp.array(place.size, seen.centre.dtype)[None, None]
    centre, boxes, heading = (
        jnp.concatenate([one[None], many])
        for one, many in zip(before, (seen.centre, seen.boxes, seen.heading), strict=True)
    )
    ways = centre[1:] - centre[:-1] + (boxes[1:] - boxes[:-1]) * size
    tally = Tally(
        displacement=centre[-1] - centre[0] + (boxes[-1] - boxes[0]) * size[0],
        path=jnp.sum(jnp.sqrt(jnp.sum(ways * ways, 2)), 0),
        turned=heading[-1] - heading[0],
        work=jnp.sum(seen.work, 0),
        contact=jnp.sum(seen.contact, 0),
        touched=jnp.sum(seen.touched, 0),
        capped=jnp.sum(seen.capped, 0),
        limited=jnp.sum(seen.limited, 0),
        mach=jnp.max(seen.mach, 0),
    )
    return jax.tree.map(
        lambda x: jnp.where(slots.filled.reshape(-1, *(1,) * (x.ndim - 1)), x, 0.0), tally
    )
