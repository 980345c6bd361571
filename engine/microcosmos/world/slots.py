"""Slots: places for creatures of different bodies and networks in one world.

The contents of slots and their state are arrays with the slot as first axis. A birth or a death
puts other numbers into the same arrays and compiles nothing, and the arrays are a checkpoint.
"""

from dataclasses import replace

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from .. import fields, filaments, fluid
from ..groups import Groups
from ..units import mach
from .controller import Network
from .model import State, World, grown_rods, present_edges
from .stepping import Pushed


class Actuation(eqx.Module):
    """Scales, clock and actuators of one creature. A bound of infinity is none."""

    angle_scale: Float[Array, "*slot"]
    """Largest angle that is added to a rest angle, rad."""
    length_scale: Float[Array, "*slot"]
    """Largest share that is added to a rest length."""
    phase: Float[Array, "*slot"]
    """Lead of the timer, rad."""
    max_speed: Float[Array, "*slot"]
    """Cells a step of the fastest node, in the frame that moves and turns with the body."""
    lag: Float[Array, "*slot"]
    """Time constant of the first-order response, in steps."""
    max_bend: Float[Array, "*slot"]
    """Largest angle that is added between any two edges, rad."""
    period: Float[Array, "*slot"]
    """Steps of a stroke."""
    ramp: Float[Array, "*slot"]
    """Steps in which the stroke grows after birth."""


class Occupant(eqx.Module):
    """The contents of a slot: a body alone, the network at its nodes, and its actuation.

    In a world with slots all arrays have the slot as first axis. Colours of swept bodies are
    those of the world, whose bodies then are all equal.
    """

    rods: filaments.Rods
    present: Bool[Array, "node"]
    layout: filaments.Layout
    rest_length: Float[Array, "edge"]
    network: Network
    """Its timer is that of the actuation."""
    actuation: Actuation


class Slots(eqx.Module):
    """The contents of all slots."""

    occupants: Occupant
    filled: Bool[Array, "slot"]
    number: Int[Array, "slot"]
    """Of each creature: the kernel adds up in this order, so the order of slots has no effect
    on its bits."""


class Living(eqx.Module):
    """The state of a world with slots, after a step."""

    populations: fluid.Populations
    positions: Float[Array, "slot node 2"]
    """In cells, from the corner of the box that holds the creature's anchor."""
    angles: Float[Array, "slot edge"]
    boxes: Float[Array, "slot 2"]
    """See `State.boxes`."""
    age: Int[Array, "slot"]
    """Steps since birth."""
    command: filaments.Rest
    """Last command (slot, joint) and (slot, edge), within the bound on the bend."""
    paced: filaments.Rest
    """The command after the bound on speed."""
    rest: filaments.Rest
    """The rest shape after the lag."""
    values: Float[Array, "slot row node"] | None = None
    """Values of recurrent networks."""
    energy: Float[Array, "x y"] | None = None
    collected: Float[Array, "slot node"] | None = None
    """Energy that each node has taken since birth."""
    food: Int[Array, "x y"] | None = None
    """Quanta in each cell."""
    account: Int[Array, "slot"] | None = None
    """Quanta that each creature has."""
    time: Int[Array, ""] | None = None
    """Steps since the start of a world with food."""


class Tally(eqx.Module):
    """Measures of each slot in a window; 0 where it is empty."""

    displacement: Float[Array, "slot 2"]
    """Of the mean of the nodes, in cells."""
    path: Float[Array, "slot"]
    """Length of the way of that mean, in cells."""
    turned: Float[Array, "slot"]
    """Turn of the mean direction of the edges, in rad."""
    work: Float[Array, "slot"]
    """Work on the fluid; a cell's mass is 1."""
    contact: Float[Array, "slot"]
    """Way that contact with others and with obstacles moved its nodes, in cells."""
    touched: Float[Array, "slot"]
    """Steps in which it touched others, where the world has `contact`."""
    capped: Float[Array, "slot"]
    """Those in which contact moved it less than it would: one of its cluster was at the
    limit."""
    limited: Float[Array, "slot"]
    """Sum over steps of the share of nodes at a limit."""
    mach: Float[Array, "slot"]
    """Largest Mach number of the fluid at its nodes."""
    intake: Float[Array, "slot"] | Int[Array, "slot"] | None = None
    """Energy or quanta that it has taken; None in a world without."""
    grown: fields.food.Rows | None = None
    """Quanta of food that have grown in each row of cells."""
    lost: fields.food.Rows | None = None
    """Those that have decayed."""


def inhabited(place: World, slots: Slots) -> World:
    """Return the world with the bodies of all slots: nodes, edges and joints slot by slot."""
    one = slots.occupants
    count, nodes = one.present.shape
    edges = one.rods.edges.shape[1]
    number = jnp.arange(count)[:, None, None]
    assert one.rods.joints is not None
    rods = filaments.Rods(
        edges=_flat(one.rods.edges + nodes * number),
        edge_colours=place.rods.edge_colours,
        joint_colours=place.rods.joint_colours,
        stretch=_flat(one.rods.stretch),
        shear=_flat(one.rods.shear),
        bend=_flat(one.rods.bend),
        joints=_flat(one.rods.joints + edges * number),
        rings=None if one.rods.rings is None else _rings(one.rods.rings, count),
    )
    layout, pieces = one.layout, one.layout.pieces
    piece = pieces.member + pieces.count * jnp.arange(count)[:, None]
    matched = filaments.Layout(
        angle=_flat(layout.angle),
        rest_angle=_flat(layout.rest_angle),
        turned=layout.turned,
        placed=layout.placed,
        pieces=Groups(_flat(piece), count * pieces.count, ascending=False),
        bends=None if layout.bends is None else _flat(layout.bends),
        bend=None if layout.bend is None else _flat(layout.bend),
    )
    present = _flat(one.present & slots.filled[:, None])
    return replace(
        place,
        # Constraints on what has not grown, or of an empty slot, are not swept.
        rods=rods if place.layout is not None else grown_rods(rods, present),
        groups=Groups(jnp.repeat(jnp.arange(count, dtype=jnp.int32), nodes), count),
        layout=None if place.layout is None else matched,
        present=present,
        order=slots.number,
    )


def _rings(rings: filaments.Rings, count: int) -> filaments.Rings:
    at = jnp.arange(count)[:, None]
    of = jnp.where(rings.of < rings.count, rings.of + rings.count * at, count * rings.count)
    of = of.astype(rings.of.dtype)
    return filaments.Rings(
        _flat(of), _flat(rings.sign), _flat(rings.whole), count * rings.count
    )


def flat_state(living: Living) -> State:
    """Return the same state for the world of `inhabited`."""
    return State(
        living.populations,
        _flat(living.positions),
        _flat(living.angles),
        living.boxes,
        living.energy,
        None if living.collected is None else _flat(living.collected),
    )


def with_state(living: Living, state: State) -> Living:
    """Return the state of slots with the bodies, the fluid and the energy of `state`."""
    collected = living.collected
    return replace(
        living,
        populations=state.populations,
        positions=state.positions.reshape(living.positions.shape),
        angles=state.angles.reshape(living.angles.shape),
        boxes=state.boxes,
        energy=state.energy,
        collected=None
        if collected is None or state.collected is None
        else state.collected.reshape(collected.shape),
    )


def _flat(values: Array) -> Array:
    return values.reshape(-1, *values.shape[2:])


def empty(place: World, start: State, one: Occupant, count: int) -> tuple[Slots, Living]:
    """Return slots that hold nothing, in the fluid and the energy of `start`.

    `one` is any creature of the size that slots have.
    """

    def room(x):
        return jnp.zeros((count, *jnp.shape(x)), jnp.asarray(x).dtype)

    nodes, edges, joints = len(one.present), len(one.rods.edges), len(one.rods.bend)
    dtype, rows = start.positions.dtype, len(one.network.bias)
    shape = filaments.Rest(jnp.zeros((count, joints), dtype), jnp.zeros((count, edges), dtype))
    living = Living(
        start.populations,
        jnp.zeros((count, nodes, 2), dtype),
        jnp.zeros((count, edges), dtype),
        jnp.zeros((count, 2), dtype),
        jnp.zeros(count, jnp.int32),
        *(shape,) * 3,
        values=jnp.zeros((count, rows, nodes), dtype) if one.network.recurrent else None,
        energy=start.energy,
        collected=None if start.energy is None else jnp.zeros((count, nodes), dtype),
        **({} if place.food is None else _fed(place.food, count)),
    )
    slots = Slots(jax.tree.map(room, one), jnp.zeros(count, bool), jnp.zeros(count, jnp.int32))
    return slots, living


def _check_size(occupants: Occupant, one: Occupant) -> None:
    if jax.tree.structure(occupants) != jax.tree.structure(one):
        raise ValueError(
            "a creature must have the senses, and the parts of body and network, of its slot."
        )
    ways = jax.tree_util.tree_flatten_with_path(occupants)[0]
    for (way, there), new in zip(ways, jax.tree.leaves(one), strict=True):
        if there.shape[1:] != jnp.shape(new):
            name = jax.tree_util.keystr(way, simple=True, separator=".")
            raise ValueError(
                f"`{name}` must have the shape {there.shape[1:]} of a slot, "
                f"got {jnp.shape(new)}."
            )


def check_window(place: World, living: Living, steps: int, every: int) -> None:
    """Raise `ValueError` where a window cannot be simulated, see `genomes.living.live`."""
    for name, value in (("steps", steps), ("every", every)):
        if value < 1:
            raise ValueError(f"`{name}` must be at least 1, got {value}.")
    if place.food is None:
        return
    if living.food is None or living.account is None or living.time is None:
        raise ValueError("`living` must have food, accounts and a time in a world with food.")
    # Each row of cells may grow wholly each time: see `fields.food.Rows`.
    times = steps // place.food.every + 1
    if times * place.size[1] * fields.food.MOST >= 2**43:
        raise ValueError(
            f"`steps` must be fewer in a window: the sum of {times} changes of food in "
            f"{place.size[1]} cells could be too large, got {steps}."
        )


def _fed(food: fields.Food, count: int) -> dict[str, Array]:
    nothing = jnp.zeros((), jnp.int32)
    return {
        "food": jnp.asarray(food.capacity, jnp.int32),
        "account": jnp.zeros(count, jnp.int32),
        "time": nothing,
    }


def born(
    slots: Slots,
    living: Living,
    slot: Int[Array, ""] | int,
    one: Occupant,
    positions: Float[Array, "node 2"],
    number: Int[Array, ""] | int,
    account: Int[Array, ""] | int = 0,
) -> tuple[Slots, Living]:
    """Return a world in which a slot holds a newborn at `positions`, in cells.

    `slot` must be one of the slots: JAX drops what is written elsewhere. Whoever lives there is
    lost, with its account. No other creature may have the `number`. The newborn is at rest in
    the shape in which it stands; the quanta of its `account` have to come from elsewhere.

    Raises `ValueError` for a creature of another size or form than those of the slots.
    """
    _check_size(slots.occupants, one)
    angles = filaments.edge_angles(positions, one.rods)
    rest = filaments.standing(positions, angles, one.rods, one.layout)

    def put(into, what):
        return jax.tree.map(lambda x, y: x.at[slot].set(y), into, what)

    held = Slots(
        put(slots.occupants, one),
        slots.filled.at[slot].set(True),
        slots.number.at[slot].set(number),
    )
    values, collected = (
        None if x is None else x.at[slot].set(0.0) for x in (living.values, living.collected)
    )
    return held, replace(
        living,
        positions=living.positions.at[slot].set(positions),
        angles=living.angles.at[slot].set(angles),
        boxes=living.boxes.at[slot].set(0.0),
        age=living.age.at[slot].set(0),
        **{name: put(getattr(living, name), rest) for name in ("command", "paced", "rest")},
        values=values,
        collected=collected,
        account=None if living.account is None else living.account.at[slot].set(account),
    )


def removed(slots: Slots, slot: Int[Array, ""] | int) -> Slots:
    """Return slots of which one is empty. Its account stays in the state, for its heirs."""
    return replace(slots, filled=slots.filled.at[slot].set(False))


def intake(before: Living, after: Living) -> Array | None:
    """Return the energy or the quanta that each creature has taken between two states."""
    if before.account is not None and after.account is not None:
        return after.account - before.account
    if before.collected is not None and after.collected is not None:
        return jnp.sum(after.collected - before.collected, 1)
    return None


class StepTally(eqx.Module):
    """The measures of a step that `Tally` adds up."""

    centre: Float[Array, "slot 2"]
    boxes: Float[Array, "slot 2"]
    heading: Float[Array, "slot"]
    work: Float[Array, "slot"]
    contact: Float[Array, "slot"]
    touched: Float[Array, "slot"]
    capped: Float[Array, "slot"]
    limited: Float[Array, "slot"]
    mach: Float[Array, "slot"]


def by_slot(world: World, end: State, _: filaments.Rest, pushed: Pushed) -> StepTally:
    """Return the measures of a step by slot, for `step`."""
    groups, layers = world.groups, world.form.layers
    assert world.present is not None
    weights = world.present.astype(end.positions.dtype)
    points = groups.repeated(layers)
    here = jnp.repeat(world.present, layers)
    drift = pushed.repelled.drift
    speed = jnp.where(here, jnp.sum(pushed.velocity * pushed.velocity, 1), 0.0)
    return StepTally(
        *place_of(world, end),
        work=points.total(jnp.sum(pushed.forcing * pushed.target, 1)),
        contact=groups.mean(jnp.sqrt(jnp.sum(drift * drift, 1) + 1e-24), weights),
        touched=_steps(pushed.repelled.touched, groups, weights),
        capped=_steps(pushed.repelled.limited, groups, weights),
        limited=groups.mean(pushed.held, weights),
        mach=mach(jnp.sqrt(jnp.maximum(points.largest(speed), 0.0) + 1e-24)),
    )


def _steps(
    which: Bool[Array, "slot"] | None, groups: Groups, weights: Float[Array, "node"]
) -> Float[Array, "slot"]:
    if which is None:
        return jnp.zeros(groups.count, weights.dtype)
    return which.astype(weights.dtype)


def place_of(world: World, state: State):
    """Return the mean of each slot's nodes, its boxes, and the mean direction of its edges."""
    groups, edges = world.groups, present_edges(world)
    assert world.present is not None
    assert edges is not None
    weights = world.present.astype(state.positions.dtype)
    of_edge = replace(groups, member=groups.member[world.rods.edges[:, 0]])
    heading = of_edge.mean(state.angles, edges.astype(state.angles.dtype))
    return groups.mean(state.positions, weights), state.boxes, heading
