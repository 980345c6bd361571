"""From a spec to the experiment that carries it out."""

import json
from functools import singledispatch

import jax

from .. import device, neat, search, spec
from ..experiments import Experiment
from ..experiments.quality_diversity import Programs, QualityDiversity
from ..experiments.state import Plan
from .creatures import build_block, frame
from .tables import build_gaits, build_scaling


@singledispatch
def build(chosen: spec.Spec) -> Experiment:
    """The experiment that a spec describes, its programs ready to be compiled."""
    raise TypeError(f"`spec` must be an experiment's, got {type(chosen).__name__}")


build.register(build_gaits)
build.register(build_scaling)


@build.register
def build_quality_diversity(chosen: spec.QualityDiversity) -> QualityDiversity:
    plan = build_plan(chosen)
    genes, axes, batch = plan.genes, plan.axes, plan.batch
    key = jax.random.key(chosen.seed, impl="threefry2x32")
    # Bound one by one: a program is compiled for this run's sizes and seed.
    programs = Programs(
        newcomers=jax.jit(lambda g: search.newcomers(g, genes, key=key, batch=batch)),
        vary=jax.jit(lambda a, c, g: search.vary(a, c, g, genes, key=key, batch=batch)),
        evaluate_block=build_block(chosen.scene),
        insert=jax.jit(lambda a, c: search.insert(a, search.named(c), axes)),
    )
    return QualityDiversity(plan, programs)


def build_plan(chosen: spec.QualityDiversity) -> Plan:
    """What the experiment needs of the spec besides programs."""
    return Plan(
        spec=json.dumps(chosen.model_dump(mode="json"), sort_keys=True),
        frame=frame(chosen.scene),
        seed=chosen.seed,
        generations=chosen.search.generations,
        batch=chosen.search.batch,
        block=chosen.search.block,
        variation=chosen.search.variation,
        cells=chosen.archive.cells,
        descriptors=tuple(axis.name for axis in chosen.archive.descriptors),
        axes=build_axes(chosen),
        genes=build_genes(chosen),
        device=device.device_kind(),
        force_free=chosen.coupling.force_free,
    )


def build_genes(chosen: spec.QualityDiversity) -> search.Genes:
    """Sizes of networks and rates of their mutations."""
    genome = chosen.genome
    return search.Genes(
        inputs=len(chosen.control.inputs),
        outputs=len(spec.OUTPUTS),
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


def build_axes(chosen: spec.QualityDiversity) -> tuple[search.Axis, ...]:
    """The archive's axes over recorded features."""
    return tuple(
        search.Axis(
            feature=search.FEATURES.index(axis.name),
            low=axis.low,
            high=axis.high,
            bins=axis.bins,
            logarithmic=axis.scale == "log10",
        )
        for axis in chosen.archive.descriptors
    )
