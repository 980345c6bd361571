"""Worlds in which the native kernel is compared with JAX."""

from dataclasses import replace
from functools import partial

import jax
import numpy as np
from genotypes import any_genotype

from microcosmos import (
    bodies,
    coupling,
    fields,
    filaments,
    fluid,
    groups,
    search,
    spec,
    world,
)
from microcosmos.build import build_rods, build_task
from microcosmos.build.scene import build_layout
from microcosmos.device import array

single = partial(array, dtype=np.float32)
at_rest = jax.jit(world.at_rest)
STIFF = {"stretch": 1.0, "shear": 1.0, "bend": 1.0}
OBSERVED = (
    "speed",
    "node_speed",
    "heading",
    "curvature",
    "power",
    "force",
)


def scene(body, size=(48, 48), *, matched=False, limits=(0.1, 0.1), nu_c=None, **form):
    """A body that bends in a travelling wave: world, start, rest shapes of 100 steps."""
    member = groups.Groups(array(body.member, np.int32), body.count)
    box = world.World(
        viscosity=single(0.05),
        rods=build_rods(body),
        groups=member,
        size=size,
        form=world.Form(**form),
        limits=world.Limits(*(None if one is None else single(one) for one in limits)),
        layout=build_layout(body) if matched else None,
        nu_c=None if nu_c is None else single(nu_c),
    )
    middle = body.positions - body.positions.mean(0) + np.array(size) / 2
    start = at_rest(box, single(middle))
    time = np.arange(100)[:, None] / 100
    joint, edge = (np.arange(n)[None] / (n + 1) for n in (len(body.joints), len(body.edges)))
    angle = body.rest_angle[None] + 0.1 * time * np.sin(2 * np.pi * (joint - time))
    length = body.rest_length[None] * (1 + 0.1 * time * np.sin(2 * np.pi * (edge - time)))
    return box, start, filaments.Rest(single(angle), single(length))


def controlled(**control):
    """World, start and controller of a creature."""
    scene = spec.Scene.model_validate(
        {
            "world": {"width": 24, "height": 24, "energy": {}},
            "body": {"nodes": 8},
            "control": {"period": 20} | control,
            "task": {"steps": 30},
        }
    )
    task = build_task(scene)
    genotype = any_genotype(scene, task.encoding, np.random.default_rng(0))

    @jax.jit
    def develop(genotype):
        driven = search.drive(task, genotype, differentiable=True)
        return driven.world, driven.start, driven.controller

    return develop(genotype)


def repelling(body, size=(48, 48), strength=4.0, gradient=fields.binomial, **options):
    """A scene whose nodes repel each other."""
    box, start, rest = scene(body, size, **options)
    limit, strength = single(0.1), single(strength)
    return replace(box, steric=fields.Steric(strength, limit, gradient)), start, rest


def meeting(body, size=(48, 48), strength=4.0, **options):
    """A scene whose bodies repel each other where they meet."""
    box, start, rest = scene(body, size, **options)
    contact = fields.Contact(single(strength), single(0.1))
    return replace(box, contact=contact), start, rest


def moved(given, way):
    """A scene whose bodies start elsewhere."""
    box, start, rest = given
    return box, at_rest(box, np.asarray(start.positions) + np.float32(way)[None]), rest


def fed(body, size=(48, 48), *, rate=None, diffusion=None, **options):
    """A scene with packets of energy."""
    box, start, rest = scene(body, size, **options)
    packets = single(fields.packets(size, fields.Packets(5, 3.0, 1.0, 0)))
    rate, diffusion = (None if x is None else single(x) for x in (rate, diffusion))
    box = replace(box, energy=fields.Energy(packets, diffusion, rate))
    return box, at_rest(box, start.positions), rest


def surrounded(given, *names):
    """A scene with some of the forces, walls and a sponge.

    The body in the middle touches the walls: a channel across the edges of the world, and
    pillars. The sponge covers a third of the world, and of the walls.
    """
    box, start, rest = given
    solid, strength = np.zeros(box.size, bool), np.zeros(box.size)
    solid[:, 3] = solid[:, -1] = solid[0, ::5] = True
    x, y = np.array(box.size) // 2
    solid[x - 4 : x - 1, y + 1 : y + 3] = solid[x + 7, y] = True
    strength[: box.size[0] // 3] = np.linspace(0, 0.3, box.size[0] // 3)[:, None]
    sponge = fluid.Sponge(single(strength), single([0.02, -0.01]))
    varied = fluid.vortices(box.size, 0.02, float(box.viscosity), 2).force
    parts = {
        "force": single([2e-5, -1e-5]),
        "solid": array(solid),
        "sponge": sponge,
        "force_field": single(varied),
    }
    around = fluid.Surroundings(**{name: parts[name] for name in names})
    return replace(box, surroundings=around), start, rest


def kept_out(given):
    """A scene with solid cells that keep bodies out, in the middle of the world."""
    box, start, rest = surrounded(given, "force", "solid")
    away = single(fields.away(np.asarray(box.surroundings.solid)))
    return replace(box, barrier=fields.Barrier(away, single(0.1))), start, rest


def chain(nodes=20, spacing=1.0, **stiffness):
    return bodies.chain(nodes, spacing, **{**STIFF, **stiffness})


def net():
    """Nodes on a grid of four rows and five columns, each joined to its neighbours."""
    number = np.arange(20).reshape(4, 5)
    along = np.stack([number[:, :-1].ravel(), number[:, 1:].ravel()], 1)
    across = np.stack([number[:-1].ravel(), number[1:].ravel()], 1)
    places = np.stack(np.divmod(np.arange(20), 5), 1) * 1.0
    return bodies.from_edges(places, np.concatenate([along, across]), **STIFF)


def unjointed(body):
    """A body without two of its joints: its edges turn freely there."""
    kept = np.arange(len(body.joints)) % 5 != 1
    parts = {name: getattr(body, name)[kept] for name in ("joints", "rest_angle", "bend")}
    return replace(body, **parts)


def shoal():
    """Three filaments, each turned another way."""
    places = (((12.3, 14.2), 0.3), ((35.1, 12.9), 2.1), ((24.0, 34.4), 4.0))
    return bodies.combined([bodies.placed(chain(11), *place) for place in places])


def heap():
    """Two filaments that cross."""
    places = (((24.0, 24.0), 0.3), ((26.0, 25.0), 1.8))
    return bodies.combined([bodies.placed(chain(11), *place) for place in places])


def grown(body, nodes, **options):
    """A chain of which only the first or some nodes have grown."""
    box, start, rest = scene(body, **options)
    there = range(nodes) if isinstance(nodes, int) else nodes
    return grown_alone(box, np.isin(np.arange(len(body.positions)), there)), start, rest


def grown_alone(box, present):
    """A world in which only some nodes have grown."""
    present = array(present)
    rods = jax.jit(world.grown_rods)(box.rods, present)
    return replace(box, present=present, rods=rods)


SCENES = {
    "shape matching": lambda: scene(chain(), matched=True),
    "sweeps": lambda: scene(chain()),
    "an odd number of nodes, rows that fill no vector": lambda: scene(
        chain(21, 0.8), (45, 51), matched=True
    ),
    "two nodes": lambda: scene(chain(2), matched=True),
    "two nodes, swept": lambda: scene(chain(2)),
    "a soft body": lambda: scene(chain(stretch=0.7, shear=0.4, bend=0.6)),
    "a star, matched": lambda: scene(bodies.star(4, 6, 1.0, **STIFF), matched=True),
    "a star": lambda: scene(bodies.star(4, 6, 1.0, **STIFF)),
    "a net, whose loops share edges": lambda: scene(net(), matched=True),
    "a star whose arms hang together by some joints": lambda: scene(
        unjointed(bodies.star(4, 4, 1.0, **STIFF)), matched=True
    ),
    "a ring": lambda: scene(bodies.ring(20, 1.0, **STIFF), matched=True),
    "three bodies, matched": lambda: scene(shoal(), matched=True),
    "three bodies": lambda: scene(shoal()),
    "no limits": lambda: scene(chain(), matched=True, limits=(None, None)),
    "limits that act": lambda: scene(chain(), matched=True, limits=(0.01, 0.003)),
    "two layers": lambda: scene(chain(), matched=True, layers=2),
    "Peskin's delta": lambda: scene(chain(), matched=True, kernel=coupling.PESKIN),
    "the hat": lambda: scene(chain(), matched=True, kernel=coupling.HAT),
    "the paper's literal form": lambda: scene(
        chain(bend=0.5),
        kernel=coupling.PESKIN,
        projection=coupling.unprojected,
        theta_feedback=0.0,
        force_factor=1.0,
        forcing_iterations=1,
        magic=fluid.fixed_magic,
    ),
    "no net force": lambda: scene(
        chain(), projection=coupling.force_free, theta_feedback=0.5, forcing_iterations=5
    ),
    "weak actuators": lambda: scene(chain(), nu_c=0.05),
    "actuators without strength": lambda: scene(chain(), nu_c=0.0),
    "no fluid": lambda: scene(chain(), matched=True, fluid=False),
    "repulsion": lambda: repelling(chain(), matched=True),
    "repulsion across the edges of a small world": lambda: moved(
        repelling(chain(24, 0.8), (24, 37)), (10.0, 17.0)
    ),
    "bodies that touch": lambda: repelling(heap(), matched=True),
    "bodies that touch without fluid": lambda: repelling(heap(), fluid=False),
    "repulsion by a Fourier transform": lambda: repelling(
        chain(), matched=True, gradient=fields.gaussian
    ),
    "repulsion by a Fourier transform across the edges": lambda: moved(
        repelling(chain(24, 0.8), (24, 37), gradient=fields.gaussian), (10.0, 17.0)
    ),
    "bodies that touch, by a Fourier transform": lambda: repelling(
        heap(), (45, 51), matched=True, layers=2, gradient=fields.gaussian
    ),
    "bodies that meet": lambda: meeting(heap(), matched=True),
    "soft bodies that meet, for two layers": lambda: meeting(heap(), (45, 51), layers=2),
    "a soft body that meets itself": lambda: meeting(chain(bend=0.5)),
    "bodies that meet across the edges": lambda: moved(
        meeting(heap(), matched=True), (-17.5, 23.5)
    ),
    "bodies that meet each other and walls": lambda: kept_out(meeting(heap(), matched=True)),
    "energy": lambda: fed(chain(), matched=True),
    "energy that is taken and spreads": lambda: fed(
        chain(), (45, 51), matched=True, rate=0.1, diffusion=0.05
    ),
    "energy that no node takes": lambda: fed(chain(), matched=True, rate=0.0),
    "energy for two layers": lambda: fed(chain(), matched=True, rate=0.1, layers=2),
    "energy without fluid": lambda: fed(chain(), rate=0.1, diffusion=0.05, fluid=False),
    "a uniform force": lambda: surrounded(scene(chain(), matched=True), "force"),
    "a force of its own in every cell": lambda: surrounded(
        scene(chain(), (45, 51), matched=True), "force_field"
    ),
    "both forces and walls": lambda: surrounded(
        scene(chain(), matched=True), "force", "force_field", "solid"
    ),
    "walls": lambda: surrounded(scene(chain(), matched=True), "solid"),
    "a sponge": lambda: surrounded(scene(chain(), (45, 51), matched=True), "sponge"),
    "walls for two layers": lambda: surrounded(scene(chain(), (45, 51), layers=2), "solid"),
    "a uniform force and a sponge": lambda: surrounded(
        scene(chain(), (45, 51)), "force", "sponge"
    ),
    "walls, a uniform force and a sponge": lambda: surrounded(
        scene(chain(), (45, 51), matched=True, layers=2), "force", "solid", "sponge"
    ),
    "bodies that touch each other and walls": lambda: surrounded(
        repelling(heap()), "force", "solid", "sponge"
    ),
    "a body kept out of obstacles": lambda: kept_out(scene(chain(), matched=True)),
    "bodies kept out of obstacles and of each other": lambda: kept_out(
        repelling(heap(), (45, 51))
    ),
    "a body that has grown, kept out of obstacles": lambda: kept_out(grown(chain(), 13)),
    "obstacles without fluid": lambda: kept_out(scene(heap(), fluid=False)),
    "walls without fluid": lambda: surrounded(scene(chain(), fluid=False), "force", "solid"),
    "a body beyond its box": lambda: moved(scene(chain(), matched=True), (100.3, -70.2)),
    "bodies that leave their boxes": lambda: moved(repelling(heap()), (-17.5, 23.5)),
    "a grown body that leaves its box": lambda: moved(grown(chain(), 13), (-14.5, 24.0)),
    "a body whose first nodes have not grown": lambda: moved(
        grown(chain(), range(7, 20), matched=True), (-21.5, 0.0)
    ),
    "a body that has grown": lambda: grown(chain(), 13),
    "a stiff body that has grown": lambda: grown(chain(), 13, matched=True),
}


def run(rollout, scene, steps=100):
    """Carry out the first steps of a scene; return the end and the measures."""
    box, start, rest = scene
    return jax.jit(rollout)(box, start, jax.tree.map(lambda x: np.asarray(x)[:steps], rest))


def unwrapped(box, start, observed):
    """Places from the corner of the first box: rounding decides when a body leaves a box."""
    return {
        "positions": world.unwrapped(box, observed),
        "centre": world.route(box, start, observed).places[1:],
    }


def in_jax(box, start, rest):
    return world.rollout(box, start, rest, lambda state, measures: measures)
