"""Estimates of the memory and work of a run."""

from dataclasses import dataclass
from functools import singledispatch
from math import ceil

from ..bodies.layout import MAX_NODES as LAID_OUT
from . import reverse
from .body import Body, GrownBody, estimated_shape
from .containers import DominatedNovelty
from .creature import room, scene_of
from .emitters import CmaMaeEmitter, CmaMeEmitter
from .encodings import Direct, gene_count
from .evolution import Evolution
from .experiments import Spec
from .folding import Folding
from .gaits import Gaits
from .refinement import Refinement, parsed
from .reverse import FLOAT
from .scaling import Scaling
from .scene import Scene, places
from .world import World

PLANES = 9
WINDOW = 16
"""Cells in the coupling window of a node."""
POSE = 4 * 64
"""Bytes of a node in a pose stream."""
PATH = 8 * 65
"""Bytes of the path in a pose stream."""
# Measured: 6.5 to 7.4 times, see docs/gradients.md.
GRADIENT = 7
"""Time of a gradient relative to the simulation alone."""
SEGMENT = 11
"""Genes of a segment."""
INPUTS = 96
"""Numbers that describe a candidate of screening."""
MODEL = 2**23
"""Bytes of the model of screening."""
# Measured of cma-mae with 100 and 400 genes: 4.4 for four strategies, 7 for one.
MATRICES = 8
"""Matrices of a strategy in and between its steps."""
CHUNK = 2**13
"""Nodes processed at a time."""


@dataclass(frozen=True)
class Estimate:
    memory_bytes: int
    evaluations: int
    cell_steps: int
    """Fluid cells times steps of the whole run: the work that dominates."""


@singledispatch
def estimate(spec: Spec) -> Estimate:
    """Return an upper estimate of a worker's memory, and the work of the whole run.

    The evaluations of a search include reevaluations.
    Memory counts one block: the populations before, during and after a step, the coupling's
    windows of 16 cells per node, and the controls of all steps; for an archive also the
    offspring and their variation. It leaves out the memory of JAX itself.
    """
    raise TypeError(f"`spec` must be an experiment's, got {type(spec).__name__}")


@estimate.register
def _(spec: Evolution) -> Estimate:
    search = spec.search
    rows = 3 * spec.genome.max_nodes + 5 * spec.genome.max_connections
    if isinstance(spec.body, GrownBody):
        rows += SEGMENT * spec.body.segments
    genome = FLOAT * (gene_count(spec.control, estimated_shape(spec.body)) or rows)
    count = simulated_nodes(spec.scene)
    archive = 4 * (spec.archive.places + 2 * search.batch) * (genome + 160)
    archive += 2 * spec.archive.places * (POSE * count + PATH)
    vary = 4 * search.batch * spec.genome.max_nodes**2 * FLOAT
    gradients = sum(spec.gradients) * search.generations
    again = reevaluations(spec)
    evaluations = search.batch * search.generations + gradients + again
    record = 2 * (48 * search.generations + 96 * min(evaluations, 4 * spec.archive.places))
    # The last block is padded and simulated whole.
    computed = ceil(search.batch / search.block) * search.block * search.generations
    one = simulation_bytes(spec.scene, spec.genome.max_nodes)
    memory = search.block * one + archive + vary + record + emitter_gradient_bytes(spec)
    memory += screening_bytes(spec, genome) + strategy_bytes(spec, genome)
    memory += novelty_bytes(spec)
    cell_steps = (computed + again + GRADIENT * gradients) * cell_steps_of(spec.scene)
    return Estimate(memory, evaluations, cell_steps)


def reevaluations(spec: Evolution) -> int:
    """Return the reevaluations of a search with a full archive."""
    search, again = spec.search, spec.search.reevaluation
    if again is None:
        return 0
    times = ceil(search.generations / again.every)
    elites = min(spec.archive.places, search.batch * search.generations)
    return again.samples * times * elites


def screening_bytes(spec: Evolution, genome: int) -> int:
    """Return the bytes of all candidates, of the variation of a round, and of a model."""
    asked = getattr(spec.search, "screening", None)
    if asked is None:
        return 0
    batch = spec.search.batch * asked.candidates
    vary = 4 * batch * spec.genome.max_nodes**2 * FLOAT
    return 2 * asked.rounds * batch * (genome + 4 * INPUTS) + vary + MODEL


def strategy_bytes(spec: Evolution, genome: int) -> int:
    """Return the bytes of the matrices of evolution strategies, which are genes × genes."""
    kinds = CmaMaeEmitter, CmaMeEmitter
    count = sum(one.emitters for one in spec.emitters if isinstance(one, kinds))
    return MATRICES * count * genome**2 // FLOAT


def novelty_bytes(spec: Evolution) -> int:
    """Return the bytes of the distances between all that compete in dominated novelty."""
    container = spec.archive.container
    if not isinstance(container, DominatedNovelty):
        return 0
    pool = container.size + spec.search.batch
    return FLOAT * pool * (pool + 2 * container.neighbours)


@estimate.register
def _(spec: Folding) -> Estimate:
    cells, count = spec.world.width * spec.world.height, node_count(spec.body)
    in_flight = spec.block * (fluid_bytes(cells) + node_bytes(count * spec.coupling.layers))
    updates = spec.updates * ceil(len(spec.targets) / spec.block) * spec.block
    return Estimate(
        memory_bytes=in_flight + spec.gradient_bytes + 64 * FLOAT * count * len(spec.targets),
        evaluations=spec.updates * len(spec.targets),
        cell_steps=updates * spec.steps * GRADIENT * (cells if spec.world.fluid else count),
    )


@estimate.register
def _(spec: Refinement) -> Estimate:
    file = parsed(spec.creature)
    scene = scene_of(file)
    nodes, _ = room(file) or (0, 0)
    return Estimate(
        memory_bytes=spec.block * simulation_bytes(scene, nodes)
        + gradient_bytes(scene, spec.segment),
        evaluations=1 + spec.steps * (1 + spec.block),
        cell_steps=cell_steps_of(scene) * (1 + spec.steps * (GRADIENT + spec.block)),
    )


@estimate.register
def _(spec: Gaits) -> Estimate:
    block, points = len(spec.viscosities), len(spec.viscosities) * len(spec.strokes)
    scenes = [spec.scene(*stroke, 0.1) for stroke in spec.strokes]
    largest = max(simulation_bytes(scene, 0) for scene in scenes)
    memory = min(spec.block, block) * largest
    return Estimate(memory, points, points * cell_steps_of(scenes[0]))


@estimate.register
def _(spec: Scaling) -> Estimate:
    cells, most = spec.width * spec.height, max(spec.nodes)
    pairs = 64 * min(spec.all_pairs, most) * CHUNK // 16
    steps = spec.steps + 3 * spec.part_steps
    return Estimate(
        memory_bytes=fluid_bytes(cells) + node_bytes(most) + pairs,
        evaluations=len(spec.nodes),
        cell_steps=len(spec.nodes) * cells * steps,
    )


def emitter_gradient_bytes(spec: Evolution) -> int:
    """Return the bytes of the gradients that emitters compute at once."""
    scene, block = spec.scene, spec.search.block
    pairs = zip(spec.emitters, spec.gradients, strict=True)
    segments = [(getattr(emitter, "segment", None), count) for emitter, count in pairs if count]
    needed = (gradient_bytes(scene, one) * min(count, block) for one, count in segments)
    return max(needed, default=0)


def placements(world: World) -> int:
    """Return the number of worlds per creature."""
    return world.energy.placements if world.energy else 1


def cell_steps_of(scene: Scene) -> int:
    """Return the fluid cells times steps of one creature."""
    world = scene.world
    simulated = placements(world) * scene.task.trials
    return simulated * world.width * world.height * scene.task.steps


def gradient_bytes(scene: Scene, segment: int | None) -> int:
    """Return the bytes that one creature's gradient keeps."""
    count = simulated_nodes(scene)
    step = reverse.step_bytes(scene.world, scene.coupling, count)
    state = reverse.state_bytes(scene.world, count)
    return reverse.total_bytes(scene.task.steps, segment, step, state)


def simulated_nodes(scene: Scene) -> int:
    """Return the nodes of all copies of a creature, also those that may not grow."""
    return node_count(scene.body) * len(places(scene.world))


def simulation_bytes(scene: Scene, network_nodes: int) -> int:
    """Return the bytes of one simulated creature, or of its school."""
    count = simulated_nodes(scene)
    # A batched choice among activations computes all of them.
    weights = scene.control.weights if isinstance(scene.control, Direct) else 0
    width = max(network_nodes, weights) + 2
    controls = 10 * scene.task.steps * count * width * FLOAT
    if isinstance(scene.control, Direct):
        controls += 4 * min(count, LAID_OUT) ** 2 * FLOAT
        if scene.control.rest_angle or scene.control.rest_length:  # Its form is measured.
            controls += 8 * node_count(scene.body) ** 2 * FLOAT
    if isinstance(scene.body, GrownBody):
        controls += (8 + 4 * scene.body.rings) * count**2 * FLOAT
    poses = 3 * scene.task.steps * count * FLOAT
    cells = scene.world.width * scene.world.height
    return fluid_bytes(cells) + node_bytes(count * scene.coupling.layers) + controls + poses


def node_count(body: Body) -> int:
    """Return the nodes that a simulation of the body holds, also those that may not grow."""
    if isinstance(body, GrownBody):
        return body.capacity.nodes
    return len(estimated_shape(body).positions)


def fluid_bytes(cells: int) -> int:
    """Return the bytes of populations before, in and after a step, and of scalar fields."""
    return (4 * PLANES + 8) * cells * FLOAT


def node_bytes(count: int) -> int:
    """Return the bytes of windows, transfers by chunks, constraints and positions."""
    return (4 * WINDOW * count + 8 * WINDOW * min(count, CHUNK) + 60 * count) * FLOAT
