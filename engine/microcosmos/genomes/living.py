"""Creatures in slots: each with a network, a clock and actuators of its own.

`live` is the reference of the native kernel's call of the same name. In every step each
creature carries out its last command in closed loop: bent no more than its bound, no faster
than its pace, and with its lag.
"""

from dataclasses import replace
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from .. import fields
from ..filaments import Rest
from ..portable import cosine, sine
from ..world import Controller, Network, State, World, flow, grown_nodes, mean, step
from ..world.senses import Stock, sensed
from ..world.slots import (
    Actuation,
    Living,
    Occupant,
    Slots,
    StepTally,
    Tally,
    by_slot,
    check_window,
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


def newborn(
    driven: Drive, actuators: Actuators | None, period: float, ramp: float
) -> tuple[Occupant, Float[Array, "node 2"]]:
    """Return the contents of a slot for a creature alone, and the positions of its nodes about
    their mean, in cells; `period` and `ramp` are in steps.

    Raises `ValueError` for a creature without a network, whose timer is not periodic, or
    without a layout.
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
        raise ValueError("a creature in a slot must have a layout, got none.")
    dtype = network.bias.dtype

    def number(value: Any) -> Array:
        return jnp.asarray(value, dtype)

    def bound(value: Any) -> Array:
        return number(jnp.inf if value is None else value)

    own = Actuators(layout) if actuators is None else actuators
    present = grown_nodes(place)
    middle = mean(driven.start.positions, present)
    return Occupant(
        rods=replace(place.rods, edge_colours=(), joint_colours=()),
        present=present,
        layout=layout,
        rest_length=controller.rest_length,
        network=replace(network, timer=jnp.zeros((0, 2), dtype)),
        actuation=Actuation(
            angle_scale=number(controller.angle_scale),
            length_scale=number(controller.length_scale),
            phase=number(0.0 if controller.phase is None else controller.phase),
            max_speed=bound(own.max_speed),
            lag=number(own.lag),
            max_bend=bound(own.max_bend),
            period=number(period),
            ramp=number(ramp),
        ),
    ), driven.start.positions - middle[None]


def live(
    place: World, slots: Slots, living: Living, steps: int, every: int = 1
) -> tuple[Living, Tally]:
    """Return the state after a window of steps, and the measures of each slot.

    The network of a creature commands at birth and `every` so many steps after. In single
    precision the clock is exact up to an age of 2²⁴ steps; that of the kernel is always.

    Raises `ValueError` for numbers of steps that are not positive, for food without its state,
    and for a window so long that the sums of grown food could be too large.
    """
    check_window(place, living, steps, every)
    box = inhabited(place, slots)
    senses = slots.occupants.network.senses

    def advanced(living: Living, _: Any) -> tuple[Living, tuple[StepTally, Any]]:
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
        grown, lost = (fields.food.added(one, 0) for one in changes)
        tally = replace(tally, grown=grown, lost=lost)
    return after, replace(tally, intake=intake(living, after))


def _stock(place: World, living: Living) -> Stock | None:
    food, account = living.food, living.account
    if place.food is None or food is None or account is None:
        return None
    unit, full = place.food.unit, place.food.full
    return Stock(food.astype(unit.dtype) / unit, account.astype(full.dtype) / full)


def _fed(box: World, flat: State, living: Living) -> tuple[Living, Any]:
    """Return the state after creatures have eaten where they stood before the step, and food
    has changed; with the quanta that have grown and that are lost."""
    given, food, account, time = box.food, living.food, living.account, living.time
    if given is None or food is None or account is None or time is None:
        return living, None  # `check_window` has refused all but the first.
    hungry = grown_nodes(box) & box.groups.per_node(account < fields.food.FULL_ACCOUNT)
    left, ate = fields.eaten(food, flat.positions, hungry, given.bite)
    time, nothing = time + 1, jnp.zeros((len(food), 2), food.dtype)
    left, grown, lost = jax.lax.cond(
        time % given.every == 0,
        lambda: fields.changed(left, given, flow(box, flat), box.surroundings.solid),
        lambda: (left, nothing, nothing),
    )
    account = account + box.groups.total(ate)
    return replace(living, food=left, account=account, time=time), (grown, lost)


def _act(
    occupants: Occupant, living: Living, rows: Float[Array, "sense slot node"], every: int
) -> Living:
    """Return the state with the rest shapes of a step."""

    def one(
        occupant: Occupant, memory: tuple[Rest, Rest, Rest], values: Any, age: Any, rows: Any
    ):
        command, paced, rest = memory
        ordered, commanded = _command(occupant, values, age, rows)
        due = age % every == 0
        command, values = jax.tree.map(
            lambda new, old: jnp.where(due, new, old), (ordered, commanded), (command, values)
        )
        actuation, layout = occupant.actuation, occupant.layout
        paced = towards(paced, command, layout, actuation.max_speed, occupant.present)
        shapes = command, paced, between(rest, paced, 1 / (1 + actuation.lag))
        edges = _grown_edges(occupant)
        return tuple(map(partial(_where_grown, occupant, edges), shapes, memory)), values

    memory = living.command, living.paced, living.rest
    over = jax.vmap(one, in_axes=(0, 0, 0, 0, 1))
    (command, paced, rest), values = over(occupants, memory, living.values, living.age, rows)
    return replace(living, command=command, paced=paced, rest=rest, values=values)


def _grown_edges(one: Occupant) -> Bool[Array, "edge"]:
    ends = one.rods.edges
    return jnp.all(one.present[ends], 1) & (ends[:, 0] != ends[:, 1])


def _where_grown(one: Occupant, edges: Bool[Array, "edge"], new: Rest, old: Rest) -> Rest:
    """Return a shape that stays as it was where the body has not grown."""
    assert one.rods.joints is not None
    joints = jnp.all(edges[one.rods.joints], 1)
    if one.layout.bends is not None:
        joints = joints & one.layout.bends
    angle = jnp.where(joints, new.angle, old.angle)
    return Rest(angle, jnp.where(edges, new.length, old.length))


def _command(
    one: Occupant, values: Any, age: Int[Array, ""], rows: Float[Array, "sense node"]
) -> tuple[Rest, Any]:
    """Return the bounded command of a creature at an age, and the values of its network."""
    network, actuation, dtype = one.network, one.actuation, one.network.bias.dtype
    steps = age.astype(dtype)
    turn = 2 * jnp.pi * jnp.mod(steps, actuation.period) / actuation.period
    timer = jnp.stack([sine(turn), cosine(turn)])[:, None]
    ramp = jnp.minimum(1.0, (steps + (actuation.ramp <= 0)) / jnp.maximum(actuation.ramp, 1.0))
    timer = jnp.asarray(shifted(timer, actuation.phase))
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
        one.layout.rest_angle + actuation.angle_scale * ramp * angle,
        one.rest_length * (1 + actuation.length_scale * ramp * length),
    )
    return bent(command, one.layout, actuation.max_bend, _grown_edges(one)), values


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


def _added_up(place: World, slots: Slots, before: Any, seen: StepTally) -> Tally:
    """Return the measures of a window from those of its steps, time first."""
    size = jnp.array(place.size, seen.centre.dtype)[None, None]
    centre, boxes, heading = (
        jnp.concatenate([one[None], many])
        for one, many in zip(before, (seen.centre, seen.boxes, seen.heading), strict=True)
    )
    ways = centre[1:] - centre[:-1] + (boxes[1:] - boxes[:-1]) * size
    tally = Tally(
        displacement=centre[-1] - centre[0] + (boxes[-1] - boxes[0]) * size[0],
        # The constant keeps the root differentiable where nothing moves.
        path=jnp.sum(jnp.sqrt(jnp.sum(ways * ways, 2) + 1e-24), 0),
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
