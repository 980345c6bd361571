"""From a spec to the experiment that carries it out."""

import json
from functools import singledispatch

import jax

from .. import device, neat, search, spec
from ..experiments import Experiment
from ..experiments.quality_diversity import Programs, QualityDiversity
from ..experiments.state import Plan
from .creatures import build_block, frame
from .emitters import build_emitters
from .scene import build_encoding
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
    emitters, axes, key = plan.emitters, plan.axes, plan.key
    # Bound one by one: a program is compiled for this run's sizes and seed.
    programs = Programs(
        emit=jax.jit(lambda *given: search.emitters.emit(emitters, *given, key=key)),
        evaluate_block=build_block(chosen.scene, room_of(chosen)),
        insert=jax.jit(lambda a, c: search.insert(a, search.named(c), axes)),
        tell=jax.jit(lambda states, told: search.emitters.tell(emitters, states, told)),
    )
    return QualityDiversity(plan, programs)


def build_plan(chosen: spec.QualityDiversity) -> Plan:
    """What the experiment needs of the spec besides programs."""
    encoding = build_encoding(chosen.scene, room_of(chosen))
    fixed = len(chosen.control.inputs), len(spec.OUTPUTS)
    return Plan(
        spec=json.dumps(chosen.model_dump(mode="json"), sort_keys=True),
        frame=frame(chosen.scene),
        seed=chosen.seed,
        generations=chosen.search.generations,
        block=chosen.search.block,
        cells=chosen.archive.cells,
        descriptors=tuple(axis.name for axis in chosen.archive.descriptors),
        axes=build_axes(chosen),
        encoding=encoding,
        emitters=build_emitters(chosen, encoding),
        counters=neat.first_counters(*fixed),
        device=device.device_kind(),
        force_free=chosen.coupling.force_free,
    )


def room_of(chosen: spec.QualityDiversity) -> tuple[int, int]:
    """Nodes and connections that networks have room for."""
    return chosen.genome.max_nodes, chosen.genome.max_connections


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
