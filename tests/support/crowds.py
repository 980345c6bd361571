"""Worlds with slots, for tests: creatures of different bodies and networks in one box."""

from dataclasses import replace
from functools import cache, partial
from types import SimpleNamespace

import jax
import jax.numpy as jnp
import numpy as np
from genotypes import any_genotype, any_network, padded

from microcosmos import fields, genomes, spec, world
from microcosmos.build import build_task
from microcosmos.genomes.living import live, newborn
from microcosmos.world import slots

PERIOD = 40.0
SLOTS = 8
ROOM = (26, 64)
BODIES = {
    "chains": ({"nodes": 12}, {}),
    "soft chains": ({"nodes": 12, "bend": 0.5}, {}),
    "stars": ({"builder": "star", "arms": 3, "arm_nodes": 4}, {"anatomy": True}),
    "rings": ({"builder": "ring", "nodes": 12}, {}),
    "recurrent networks": ({"nodes": 12}, {"recurrent": True}),
    "bodies from plans": (
        {"builder": "grown", "nodes": 32, "segment_nodes": 16, "length": 24},
        {"encoding": "body-graph"},
    ),
}
OF_SLOTS = (
    "positions",
    "angles",
    "boxes",
    "age",
    "command",
    "paced",
    "rest",
    "values",
    "collected",
    "account",
)
"""Parts of the state that have the slot as first axis."""


@cache
def task_of(name, side=48, senses=world.SENSES):
    """Return the scene and the task of the creatures of one kind, which sense."""
    body, control = BODIES[name]
    scene = spec.Scene.model_validate(
        {
            "world": {"width": side, "height": side},
            "body": body,
            "control": {"period": PERIOD} | control,
            "task": {"steps": 30},
        }
    )
    task = build_task(scene, room=ROOM)
    encoding = task.encoding
    controls = replace(encoding.controls, senses=senses)
    if isinstance(encoding, genomes.BodyGraphEncoding):
        encoding = replace(encoding, controls=controls, inputs=encoding.inputs + len(senses))
    else:
        encoding = replace(encoding, controls=controls)
    return scene, replace(task, encoding=encoding)


@cache
def newborns(name, side, senses, count, seed):
    """Return so many creatures of a kind, each with the positions of its nodes."""
    scene, task = task_of(name, side, senses)
    encoding, rng = task.encoding, np.random.default_rng(seed)

    control = SimpleNamespace(
        inputs=(*scene.control.inputs, *senses),
        outputs=scene.control.outputs,
        recurrent=getattr(scene.control, "recurrent", False),
    )

    def genotype():
        network = padded(any_network(control, rng), ROOM)
        if not isinstance(encoding, genomes.BodyGraphEncoding):
            return network
        return genomes.BodyGraph(any_genotype(scene, encoding, rng).plan, network)

    @jax.jit
    def develop(genotype):
        driven = encoding.drive(task.world, task.start, genotype, None)
        return newborn(driven, task.actuators, PERIOD, PERIOD)

    return [develop(genotype()) for _ in range(count)]


def contact(strength=4.0, limit=0.1):
    return fields.Contact(jnp.float32(strength), jnp.float32(limit))


def food(side=48, **chosen):
    """Food that regrows, decays, spreads and drifts every five steps."""
    capacity = np.full((side, side), 2**18, np.int32)
    capacity[::3] = 2**17
    numbers = {
        "bite": 2.0**13,
        "regrowth": 0.02,
        "decay": 0.01,
        "diffusion": 0.05,
        "unit": 2.0**18,
        "full": 2.0**22,
    }
    every = chosen.pop("every", 5)
    numbers = {name: jnp.float32(value) for name, value in (numbers | chosen).items()}
    return fields.Food(jnp.asarray(capacity), every=every, **numbers)


def crowd(
    name="chains",
    count=5,
    room=SLOTS,
    side=48,
    senses=world.SENSES,
    seed=0,
    touch=True,
    fed=True,
):
    """Return a world, what its slots hold, and its state: creatures at random places, of random
    ages, in random slots."""
    rng = np.random.default_rng(seed)
    _, task = task_of(name, side, senses)
    place = replace(
        task.world, contact=contact() if touch else None, food=food(side) if fed else None
    )
    held, living = slots.empty(
        place, task.start, newborns(name, side, senses, 1, seed)[0][0], room
    )
    order = rng.permutation(room)[:count]
    for number, (one, positions) in enumerate(newborns(name, side, senses, count, seed)):
        turn = rng.uniform(0, 2 * np.pi)
        turned = np.asarray(positions) @ np.array(
            [[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]]
        )
        at = np.float32(turned + rng.uniform(0, side, 2))
        account = int(rng.integers(2**20)) if fed else 0
        held, living = birth(held, living, int(order[number]), one, at, number, account)
    ages = rng.integers(0, 100, room).astype(np.int32)
    return place, held, replace(living, age=jnp.where(held.filled, ages, 0))


birth = jax.jit(slots.born)


@partial(jax.jit, static_argnames=("steps", "every"))
def in_jax(place, held, living, steps, every=1):
    return live(place, held, living, steps, every)


@partial(jax.jit, static_argnames=("steps", "every", "instruction_set", "threads"))
def in_kernel(place, held, living, steps, every=1, instruction_set=None, threads=1):
    return world.native.live(place, held, living, steps, every, instruction_set, threads)


def reordered(tree, order):
    """Return slots, their state or their measures with the slots in another order."""
    if isinstance(tree, slots.Living):
        moved = {
            name: jax.tree.map(lambda x: x[order], getattr(tree, name)) for name in OF_SLOTS
        }
        return replace(tree, **moved)
    if isinstance(tree, slots.Tally):
        rows = {name: getattr(tree, name) for name in ("grown", "lost")}
        return replace(jax.tree.map(lambda x: x[order % len(x)], tree), **rows)
    return jax.tree.map(lambda x: x[order], tree)


def same(one, other):
    """Return whether all numbers have the same bits."""
    return all(
        np.array_equal(a, b)
        for a, b in zip(jax.tree.leaves(one), jax.tree.leaves(other), strict=True)
    )


def quanta(held, living):
    """Return the quanta of a world: in its cells and in the accounts of those who live."""
    accounts = np.asarray(living.account, np.int64)[np.asarray(held.filled)]
    return int(np.asarray(living.food, np.int64).sum() + accounts.sum())


def grown(tally):
    """Return the quanta that have grown in a window, less those that are lost."""
    return fields.food.total(tally.grown) - fields.food.total(tally.lost)


WAYS = np.array([(0, 0), (1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, -1), (1, -1), (-1, 1)])


def momentum(living):
    """Return the momentum (x, y, 2) of the fluid in each cell, in double precision."""
    planes = [np.asarray(plane, float) for plane in living.populations]
    return np.einsum("pxy,pa->xya", planes, WAYS)


def ledger(simulate, windows, change=1):
    """Live in windows of five steps, with a birth or a death after every `change` of them.

    Yields whether all quanta of a window are where they should be, and the world after it.
    """
    place, held, living = crowd(count=4)
    random, before, number = np.random.default_rng(0), quanta(held, living), 4
    many = newborns("chains", 48, world.SENSES, 6, 0)
    for window in range(windows):
        living, tally = simulate(place, held, living, 5)
        before += grown(tally)
        yield quanta(held, living) == before, (place, held, living, number)
        if window % change:
            continue
        slot = int(random.integers(SLOTS))
        if held.filled[slot]:
            before -= int(living.account[slot])
            held = slots.removed(held, slot)
        else:
            one, positions = many[int(random.integers(6))]
            at = np.float32(np.asarray(positions) + random.uniform(0, 48, 2))
            account = int(random.integers(2**20))
            held, living = birth(held, living, slot, one, at, number, account)
            before, number = before + account, number + 1
