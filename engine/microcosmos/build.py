"""From a spec to the objects that carry it out: the only place where pydantic meets JAX."""

import json
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from . import bodies, coupling, device, filaments, fluid, genomes, neat, search, world
from .archive import naming
from .experiments.quality_diversity import Programs, QualityDiversity
from .experiments.state import Plan
from .spec import OUTPUTS, Body, Control, Coupling, Genome, Spec
from .spec import World as WorldSpec

PROJECTIONS = {
    "none": coupling.unprojected,
    "force": coupling.force_free,
    "force+torque": coupling.torque_free,
}
MAGIC = {"capped": fluid.capped_magic, "fixed": fluid.fixed_magic}
TIMERS = {"sine-cosine": genomes.sine_cosine, "linear": genomes.linear}


def build(spec: Spec) -> QualityDiversity:
    """The experiment that a spec describes, its programs ready to be compiled."""
    plan = build_plan(spec)
    genes, axes, batch = plan.genes, plan.axes, plan.batch
    key = jax.random.key(spec.seed, impl="threefry2x32")
    # Bound one by one: a program is compiled for this run's sizes and seed.
    programs = Programs(
        newcomers=jax.jit(lambda g: search.newcomers(g, genes, key=key, batch=batch)),
        vary=jax.jit(lambda a, c, g: search.vary(a, c, g, genes, key=key, batch=batch)),
        evaluate_block=build_block(spec),
        insert=jax.jit(lambda a, c: search.insert(a, search.named(c), axes)),
    )
    return QualityDiversity(plan, programs)


def build_block(spec: Spec):
    """The compiled program that evaluates a block of the spec's creatures."""
    return search.block_program(build_task(spec), search.evaluate, device.compiler_options())


def build_plan(spec: Spec) -> Plan:
    """What the experiment needs of the spec besides programs."""
    return Plan(
        spec=json.dumps(spec.model_dump(mode="json"), sort_keys=True),
        frame=frame(spec),
        seed=spec.seed,
        generations=spec.search.generations,
        batch=spec.search.batch,
        block=spec.search.block,
        variation=spec.search.variation,
        cells=spec.archive.cells,
        descriptors=tuple(axis.name for axis in spec.archive.descriptors),
        axes=build_axes(spec),
        genes=build_genes(spec),
        device=device.device_kind(),
    )


def frame(spec: Spec) -> dict[str, Any]:
    """The identity of the spec's creatures but for their genes."""
    place, form = spec.world.model_dump(mode="json"), spec.coupling.model_dump(mode="json")
    # In numbers: a creature must not change with what an empty limit stands for.
    form["max_displacement"] = spec.coupling.displacement_limit(spec.world.viscosity)
    form["max_force"] = spec.coupling.force_limit(spec.world.viscosity)
    return {
        "format": naming.FORMAT,
        "genome": {
            "encoding": "cppn",
            "inputs": list(spec.control.inputs),
            "outputs": list(OUTPUTS),
            "control": spec.control.model_dump(mode="json"),
        },
        "world": place | {"coupling": form},
        "body": spec.body.model_dump(mode="json"),
        "task": spec.task.model_dump(mode="json"),
    }


def build_task(spec: Spec, dtype: Any = jnp.float32) -> search.Task:
    """The world with the body at rest in its middle, and the controls of all steps."""
    body = build_body(spec.body)
    place = build_world(spec.world, spec.coupling, body, dtype)
    middle = np.array([spec.world.width, spec.world.height]) / 2
    positions = body.positions - body.positions.mean(0) + middle
    start = world.at_rest(place, jnp.asarray(positions, dtype))
    return search.Task(place, start, build_controls(spec.control, body, spec.task.steps))


def build_body(body: Body) -> bodies.Body:
    """The body's graph."""
    return bodies.chain(
        body.nodes, body.spacing, stretch=body.stretch, shear=body.shear, bend=body.bend
    )


def build_world(
    place: WorldSpec, form: Coupling, body: bodies.Body, dtype: Any = jnp.float32
) -> world.World:
    """The box of fluid around a body."""
    return world.World(
        viscosity=jnp.asarray(place.viscosity, dtype),
        rods=build_rods(body, dtype),
        size=(place.width, place.height),
        form=world.Form(
            projection=PROJECTIONS[form.projection],
            force_factor=float(form.force_factor),
            theta_feedback=float(form.theta_feedback),
            forcing_iterations=form.forcing_iterations,
            constraint_iterations=form.constraint_iterations,
            displacement_limit=form.displacement_limit(place.viscosity),
            force_limit=form.force_limit(place.viscosity),
            magic=MAGIC[place.magic],
        ),
    )


def build_rods(body: bodies.Body, dtype: Any = jnp.float32) -> filaments.Rods:
    """The body's graph as device arrays."""

    def pairings(colours: tuple[bodies.Colour, ...]) -> tuple[filaments.Pairing, ...]:
        return tuple(
            filaments.Pairing(
                jnp.asarray(c.partner), jnp.asarray(c.constraint), jnp.asarray(c.sign, dtype)
            )
            for c in colours
        )

    return filaments.Rods(
        edges=jnp.asarray(body.edges),
        edge_colours=pairings(body.edge_colours),
        joint_colours=pairings(body.joint_colours),
        stretch=jnp.asarray(body.stretch, dtype),
        shear=jnp.asarray(body.shear, dtype),
        bend=jnp.asarray(body.bend, dtype),
    )


def build_controls(control: Control, body: bodies.Body, steps: int) -> genomes.Controls:
    """Inputs of the CPPN at all nodes and times, and what its outputs mean."""
    position = body.arc if control.position == "unit" else 2 * body.arc - 1
    rise = np.maximum(control.ramp * control.period, 1)
    return genomes.Controls(
        inputs=genomes.network_inputs(position, TIMERS[control.timer](steps, control.period)),
        ramp=np.minimum(1, (np.arange(steps) + (control.ramp == 0)) / rise),
        edges=body.edges,
        joint_nodes=body.edges[body.joints[:, 0], 1],
        rest_angle=body.rest_angle,
        rest_length=body.rest_length,
        angle_scale=control.angle_scale,
        length_scale=control.length_scale,
    )


def build_genes(spec: Spec) -> search.Genes:
    """Sizes of networks and rates of their mutations."""
    genome: Genome = spec.genome
    return search.Genes(
        inputs=len(spec.control.inputs),
        outputs=len(OUTPUTS),
        max_nodes=genome.max_nodes,
        max_connections=genome.max_connections,
        rates=neat.Rates(
            weight=genome.weight_rate,
            weight_step=genome.weight_step,
            replace=genome.replace_rate,
            activation=genome.activation_rate,
            toggle=genome.toggle_rate,
            add_node=genome.add_node_rate,
            add_connection=genome.add_connection_rate,
        ),
    )


def build_axes(spec: Spec) -> tuple[search.Axis, ...]:
    """The archive's axes over recorded features."""
    return tuple(
        search.Axis(
            feature=search.FEATURES.index(axis.name),
            low=axis.low,
            high=axis.high,
            bins=axis.bins,
            logarithmic=axis.scale == "log10",
        )
        for axis in spec.archive.descriptors
    )
