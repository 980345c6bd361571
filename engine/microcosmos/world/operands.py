"""Operands of the native kernel: bodies and controllers as arrays and numbers."""

from collections.abc import Sequence
from typing import Any

import jax.numpy as jnp
from jaxtyping import Array, Int

from .. import fields, filaments
from .controller import SENSES, Actuators, Controller, Network, Series
from .model import State, World, grown_nodes
from .slots import Living, Slots

Numbers = dict[str, int]
GIVEN, NETWORK, SERIES = range(3)
"""Sources of rest shapes, by the kernel's numbers: recorded, a network, a series."""


def body_of(
    world: World, state: State, controller: Controller | None
) -> tuple[list[Array], Numbers]:
    """Return the start, the graph and the layout of all bodies, and their sizes."""
    rods, nodes = world.rods, len(state.positions)
    actuators = None if controller is None else controller.actuators
    layout = world.layout
    if layout is None and actuators is not None:
        layout = actuators.layout
    pieces = world.groups.member if layout is None else layout.pieces.member
    assert rods.joints is not None
    graph = (rods.edges, rods.joints, world.groups.member, pieces, grown_nodes(world))
    arrays = [state.positions, state.angles, *(jnp.asarray(one, jnp.int32) for one in graph)]
    if layout is None:
        arrays += [_nothing(0), _nothing(0), jnp.zeros(0, jnp.int32)]
    else:
        bends = jnp.ones(len(rods.bend), bool) if layout.bends is None else layout.bends
        arrays += [jnp.asarray(one, jnp.float32) for one in (layout.angle, layout.rest_angle)]
        arrays.append(jnp.asarray(bends, jnp.int32))
    sizes = {
        "nodes": nodes,
        "edges": len(rods.edges),
        "joints": len(rods.bend),
        "bodies": world.groups.count,
        "matched": world.layout is not None,
        "laid_out": layout is not None,
    }
    return arrays, sizes


SHAPES = ("command", "paced", "rest")
"""Shapes that a slot remembers, by the kernel's numbers."""


def state_of(living: Living, rows: int) -> tuple[list[Array], list[tuple[int, ...]]]:
    """Return the state of slots, of networks with so many rows, in the kernel's order, and the
    shapes of its arrays."""
    shapes = [getattr(living, name) for name in SHAPES]
    slots, nodes = living.positions.shape[:2]
    width = living.populations[0].shape[1]
    values, energy, collected = living.values, living.energy, living.collected
    if collected is None and energy is not None:
        collected = _nothing(slots, nodes)
    arrays = [
        *living.populations,
        living.positions,
        living.angles,
        living.boxes,
        living.age,
        jnp.stack([one.angle for one in shapes], 1),
        jnp.stack([one.length for one in shapes], 1),
        _nothing(0, rows, nodes) if values is None else values,
        _nothing(0, width) if energy is None else energy,
        _nothing(0, nodes) if collected is None else collected,
        *_food_of(living),
    ]
    return arrays, [one.shape for one in arrays]


def _food_of(living: Living) -> list[Array]:
    food, account, time = living.food, living.account, living.time
    if food is None or account is None or time is None:
        width, nothing = living.populations[0].shape[1], jnp.zeros(0, jnp.int32)
        return [nothing.reshape(0, width), nothing, nothing]
    return [food, account, time[None]]


def rations_of(place: World) -> tuple[list[Array], Numbers]:
    """Return the capacity for food, the numbers by which it changes, and flags."""
    food = place.food
    if food is None:
        none = jnp.zeros((0, place.size[1]), jnp.int32)
        return [none, _nothing(0)], {"fed": False, "carried": False, "food_every": 1}
    values = (food.bite, food.regrowth, food.decay, food.diffusion, food.unit, food.full)
    rations = jnp.stack([jnp.asarray(one, jnp.float32) for one in values])
    numbers: Numbers = {"fed": True, "carried": food.carried, "food_every": food.every}
    return [jnp.asarray(food.capacity, jnp.int32), rations], numbers


def living_of(living: Living, arrays: Sequence[Array]) -> Living:
    """Return the state of slots from its arrays in the kernel's order."""
    positions, angles, boxes, age, angle, length, values, energy, collected = arrays[9:18]
    food, account, time = arrays[18:]
    return Living(
        tuple(arrays[:9]),
        positions,
        angles,
        boxes,
        age,
        *(filaments.Rest(angle[:, n], length[:, n]) for n in range(len(SHAPES))),
        values=None if living.values is None else values,
        energy=None if living.energy is None else energy,
        collected=None if living.collected is None else collected,
        food=None if living.food is None else food,
        account=None if living.account is None else account,
        time=None if living.time is None else time[0],
    )


def slots_of(place: World, slots: Slots) -> tuple[list[Array], Numbers]:
    """Return the contents of slots in the kernel's order, and its numbers."""
    one, network, layout = slots.occupants, slots.occupants.network, slots.occupants.layout
    rods, matched = one.rods, place.layout is not None
    count, nodes = one.present.shape
    joints, edges = rods.bend.shape[1], rods.stretch.shape[1]
    bends = jnp.ones((count, joints), bool) if layout.bends is None else layout.bends
    bend = rods.bend if layout.bend is None or not matched else layout.bend
    swept = [_nothing(0, edges), _nothing(0, joints), _nothing(0, joints)]
    if not matched:
        colours = (
            (place.rods.edge_colours, edges),
            (place.rods.joint_colours, joints),
        )
        swept = [jnp.tile(_colours(*one, one[1])[None], (count, 1)) for one in colours]
        whole = _nothing(count, joints)
        if rods.rings is not None:
            turns = jnp.concatenate([rods.rings.whole, _nothing(count, 1)], 1)
            whole = jnp.take_along_axis(turns, rods.rings.of, 1)
        swept.append(whole)
    lag = network.lag
    whole_numbers = (
        slots.filled,
        slots.number,
        rods.edges,
        rods.joints,
        layout.pieces.member,
        one.present,
    )
    arrays = [
        *(jnp.asarray(each, jnp.int32) for each in whole_numbers),
        layout.angle,
        layout.rest_angle,
        jnp.asarray(bends, jnp.int32),
        *(jnp.asarray(each, jnp.int32) for each in swept[:2]),
        swept[2],
        rods.stretch,
        rods.shear,
        bend,
        _actuation(slots),
        jnp.asarray(network.activation, jnp.int32),
        network.bias,
        jnp.asarray(network.source, jnp.int32),
        jnp.asarray(network.target, jnp.int32),
        network.weight,
        network.sites,
        _nothing(0, nodes) if lag is None else lag,
        jnp.asarray(network.joint_node, jnp.int32),
        network.gain,
        one.rest_length,
    ]
    sites = network.sites.shape[1]
    numbers = {
        "slots": count,
        "nodes": nodes,
        "edges": edges,
        "joints": joints,
        "bodies": 1,
        "matched": matched,
        "laid_out": True,
        "commands": NETWORK,
        "recurrent": network.recurrent,
        "senses": senses_number(network.senses),
        "waves": lag is not None,
        "actuated": True,
        "rows": network.bias.shape[1],
        "links": network.weight.shape[1],
        "inputs": sites + (2 if lag is None else 4) + len(network.senses),
        "sites": sites,
        "timers": 2,
        "terms": 0,
        "soft": matched and layout.bend is not None,
    }
    return arrays, numbers


def _actuation(slots: Slots) -> Array:
    """Return scales, phase, bounds and clock of each slot, in the kernel's order."""
    actuation = slots.occupants.actuation
    values = (
        actuation.angle_scale,
        actuation.length_scale,
        actuation.phase,
        actuation.max_speed,
        1 / (1 + actuation.lag),
        actuation.max_bend,
        actuation.period,
        actuation.ramp,
    )
    return jnp.stack([jnp.asarray(one, jnp.float32) for one in values], 1)


def stiffness_of(world: World) -> list[Array]:
    """Return the colours of edges and joints, the whole turns of each joint's ring, then all
    stiffnesses.

    Shape matching needs neither colours nor turns: they then have no items.
    """
    rods, nodes = world.rods, len(world.groups.member)
    stiffness = [rods.stretch, rods.shear, rods.bend]
    if world.layout is not None:
        if world.layout.bend is not None:  # Soft joints of a matched shape have their own.
            stiffness[2] = world.layout.bend
        none = jnp.zeros(0, jnp.int32)
        return [none, none, _nothing(0), *stiffness]
    # Colours may be those of the first of several chunks of equal bodies.
    chunk = len(rods.edge_colours[0].partner)
    colours = [
        _colours(pairings, count * chunk // nodes, count)
        for pairings, count in (
            (rods.edge_colours, len(rods.edges)),
            (rods.joint_colours, len(rods.bend)),
        )
    ]
    whole = _nothing(len(rods.bend))
    if rods.rings is not None:
        whole = jnp.append(rods.rings.whole, 0.0)[rods.rings.of]
    return [*colours, whole, *stiffness]


def smoothing_of(world: World) -> list[Array]:
    """Return the weights along both axes that smooth the density of nodes for repulsion."""
    if world.steric is None:
        return [_nothing(0, cells) for cells in world.size]
    weights = fields.WEIGHTS[world.steric.gradient]
    return [jnp.asarray(weights(cells), jnp.float32) for cells in world.size]


def surroundings_of(world: World) -> tuple[list[Array], Numbers]:
    """Return forces, walls, displacements at walls and the sponge, and flags of those used."""
    around, width = world.surroundings, world.size[1]
    force, solid, sponge = around.force, around.solid, around.sponge
    walls = jnp.zeros((0, width), jnp.int32) if solid is None else jnp.asarray(solid, jnp.int32)
    away = _nothing(2, 0, width) if world.barrier is None else world.barrier.away
    forces = _nothing(2, 0, width) if around.force_field is None else around.force_field
    arrays = [
        _nothing(0) if force is None else jnp.asarray(force, jnp.float32),
        jnp.asarray(forces[0], jnp.float32),
        jnp.asarray(forces[1], jnp.float32),
        walls,
        jnp.asarray(away[0], jnp.float32),
        jnp.asarray(away[1], jnp.float32),
        _nothing(0, width) if sponge is None else jnp.asarray(sponge.strength, jnp.float32),
        _nothing(0) if sponge is None else jnp.asarray(sponge.velocity, jnp.float32),
    ]
    numbers: Numbers = {
        "driven": force is not None,
        "varied": around.force_field is not None,
        "walled": solid is not None,
        "barred": world.barrier is not None,
        "damped": sponge is not None,
    }
    return arrays, numbers


def controller_of(controller: Controller | None) -> tuple[list[Array], Numbers]:
    """Return the arrays of a controller and its sizes; without one, arrays without items."""
    network = series = None
    if controller is not None:
        commands = controller.commands
        network = commands if isinstance(commands, Network) else None
        series = commands if isinstance(commands, Series) else None
    arrays = [_bounds(controller), *_network(network)]
    ramp, angle, length = (_nothing(0),) * 3
    timer = lag = sites = joint_node = gain = None
    if controller is not None:
        ramp, angle, length = controller.ramp, controller.rest_angle, controller.rest_length
    if network is not None:
        timer, lag, sites = network.timer, network.lag, network.sites
        joint_node, gain = network.joint_node, network.gain
    arrays += [
        _nothing(0, 0) if timer is None else timer,
        ramp,
        _nothing(0, 0) if sites is None else sites,
        _nothing(0) if lag is None else lag,
        jnp.asarray(() if joint_node is None else joint_node, jnp.int32),
        _nothing(0) if gain is None else gain,
        angle,
        length,
        _nothing(0, 0) if series is None else series.basis,
        _nothing(0, 0) if series is None else series.genes,
    ]
    inputs = 0
    if network is not None:
        clocks = network.timer.shape[1] * (1 if network.lag is None else 2)
        inputs = len(network.sites) + clocks + len(network.senses)
    numbers = {
        "commands": GIVEN if controller is None else SERIES if network is None else NETWORK,
        "recurrent": network is not None and network.recurrent,
        "senses": 0 if network is None else senses_number(network.senses),
        "waves": lag is not None,
        "actuated": controller is not None and controller.actuators is not None,
        "rows": 0 if network is None else len(network.bias),
        "links": 0 if network is None else len(network.weight),
        "inputs": inputs,
        "sites": 0 if sites is None else len(sites),
        "timers": 0 if timer is None else timer.shape[1],
        "terms": 0 if series is None else series.basis.shape[1],
    }
    return arrays, numbers


def senses_number(senses: tuple[str, ...]) -> int:
    """Return the kernel's number of senses: a bit for each."""
    return sum(1 << SENSES.index(one) for one in senses)


def _bounds(controller: Controller | None) -> Array:
    """Return scales, phase and bounds, in the kernel's order."""
    if controller is None:
        return _nothing(6)
    actuators = controller.actuators
    phase = 0.0 if controller.phase is None else controller.phase
    values: list[Any] = [controller.angle_scale, controller.length_scale, phase]
    if isinstance(actuators, Actuators):
        share = 1 / (1 + actuators.lag)
        values += [actuators.max_speed or 0.0, share, actuators.max_bend or 0.0]
    else:
        values += [0.0, 1.0, 0.0]
    return jnp.stack([jnp.asarray(one, jnp.float32) for one in values])


def _network(network: Network | None) -> list[Array]:
    if network is None:
        none = jnp.zeros(0, jnp.int32)
        return [none, _nothing(0), none, none, _nothing(0)]
    return [
        jnp.asarray(network.activation, jnp.int32),
        network.bias,
        jnp.asarray(network.source, jnp.int32),
        jnp.asarray(network.target, jnp.int32),
        network.weight,
    ]


def _nothing(*shape: int) -> Array:
    return jnp.zeros(shape, jnp.float32)


def _colours(
    colours: tuple[filaments.Pairing, ...], chunk: int, count: int
) -> Int[Array, "constraint"]:
    """Return the colour of each of `count` constraints from those of the first chunk."""
    numbers = jnp.zeros(chunk, jnp.int32)
    for number, one in enumerate(colours):
        # A pair names its constraint twice, and members without one name any: only the first
        # of a pair (sign 1) writes; the others point beyond the end, where writes are dropped.
        at = jnp.where(one.sign > 0, one.constraint, chunk)
        numbers = numbers.at[at].set(number, mode="drop")
    return jnp.tile(numbers, -(-count // max(chunk, 1)))[:count]
