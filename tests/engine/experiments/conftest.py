"""The smallest run of every experiment, each carried out once per process."""

import importlib.util
import json
from dataclasses import replace
from functools import cache
from typing import Any, NamedTuple

import numpy as np
import pytest
from small_spec import SMALL_SCENE

from microcosmos.archive import creature
from microcosmos.build import build
from microcosmos.spec import parse

SMALL = SMALL_SCENE | {"seed": 3, "search": {"generations": 4, "batch": 16, "block": 8}}
NEUROEVOLUTION = SMALL | {
    "experiment": "neuroevolution",
    "seed": 5,
    "genome": {"max_nodes": 10, "max_connections": 16},
    "search": {"generations": 5, "batch": 16, "block": 8, "reevaluation": {"every": 3}},
}
TINY = SMALL | {
    "seed": 2,
    "body": {"nodes": 8},
    "task": {"steps": 20, "fitness": "displacement"},
}
NUMBERS = {"encoding": "direct", "period": 20}


LEARNING = {"generations": 5, "batch": 8, "block": 4}


def learner(control, **emitter):
    return TINY | {"control": control, "search": LEARNING | {"emitters": [emitter]}}


SPECS = {
    "quality-diversity": SMALL,
    "neuroevolution": NEUROEVOLUTION,
    "folding": {
        "experiment": "folding",
        "targets": [{"digit": 1}, {"digit": 3}],
        "world": {"width": 32, "height": 32, "fluid": False},
        "body": {"builder": "walk", "nodes": 64, "spacing": 0.5, "deviation": 0.6, "seed": 4},
    }
    | {"steps": 60, "size": 20, "width": 1.0, "updates": 20},
    "refinement": {"experiment": "refinement", "steps": 4, "block": 4},
    "gaits": {"experiment": "gaits", "swimmers": ["ray"], "period": 30, "cycles": 2, "block": 2}
    | {"forms": ["ours", "paper"], "viscosities": [0.05, 0.5, 2.0]},
    "scaling": {"experiment": "scaling", "nodes": [40, 80], "filament": 20, "all_pairs": 40}
    | {"width": 32, "height": 32, "steps": 10, "part_steps": 2},
    "cma-mae": learner(NUMBERS, operator="cma-mae"),
    "cma-mega": learner(NUMBERS, operator="cma-mega"),
    "cma-me": learner(NUMBERS, operator="cma-me", emitters=2),
}
SEVERAL = [
    {"operator": "neat", "select": "uniform", "crossover": 0.3, "share": 2},
    {"operator": "random"},
    {"operator": "neat", "select": "curiosity"},
]
SPECS["several"] = SMALL | {"search": SMALL["search"] | {"emitters": SEVERAL}}
AGAIN = {"reevaluation": {"every": 3, "samples": 2}}
SPECS["dominated-novelty"] = SMALL | {
    "archive": {"container": {"kind": "dominated-novelty", "size": 24}}
}
SPECS["fronts"] = SMALL | {
    "archive": {
        "descriptors": [{"name": "symmetry", "bins": 3}, {"name": "curvature_mean", "bins": 2}],
        "container": {"kind": "fronts", "size": 3},
    },
    "search": SMALL["search"] | AGAIN,
}
SPECS["learned"] = SMALL | {
    "archive": {"container": {"kind": "learned", "bins": 5, "first": 2, "measures": []}},
    "search": SMALL["search"] | AGAIN,
}
SPECS["zoo"] = SMALL | {
    "body": {"builder": "grown", "nodes": 26, "length": 20.0, "segments": 4, "rings": 1}
    | {"segment_nodes": 15, "limbs": 6},
    "control": {"encoding": "body-graph", "period": 20, "softest": 0.5},
    "genome": {"max_nodes": 16, "max_connections": 40},
    "archive": {
        "descriptors": [
            {"name": "free_ends", "low": -0.5, "high": 5.5, "bins": 6},
            {"name": "form_aspect", "bins": 6},
        ]
    },
    "task": {"steps": 30, "fitness": "displacement"},
    "search": {"generations": 4, "batch": 16, "block": 8}
    | {"emitters": [{"operator": "neat", "select": "curiosity", "crossover": 0.3}]},
}
SPECS["screened"] = TINY | {
    "control": {"period": 10},
    "task": {"steps": 40},
    "search": {"generations": 11, "batch": 16, "block": 8}
    | {"screening": {"rounds": 2, "candidates": 3}}
    | {
        "emitters": [
            {"operator": "neat", "select": "curiosity", "crossover": 0.3, "share": 3},
            {"operator": "random"},
        ]
    },
}
PACKAGES = {"cma-me": "qdax"}
"""Optional packages that some runs need."""


class Course(NamedTuple):
    """A whole run: its states, the initial one first, and its reports."""

    states: list[Any]
    reports: list[Any]
    experiment: Any
    spec: Any


@pytest.fixture(scope="session")
def specs():
    return SPECS


@pytest.fixture(scope="session")
def course_of(carry_out):
    """A function that gives the whole run of a spec by its name in `SPECS`."""

    @cache
    def course(name):
        document = SPECS[name]
        if name == "refinement":  # Of a creature that a search finds.
            states, _, search, _ = course("quality-diversity")
            document = document | {"creature": search.best(states[-1])}
        if importlib.util.find_spec(PACKAGES.get(name, "jax")) is None:
            pytest.skip(f"{PACKAGES[name]} is not installed: make peers")
        spec = parse(document)
        experiment = build(spec)
        return Course(*carry_out(experiment), experiment, spec)

    return course


@pytest.fixture(scope="module")
def course(request, course_of):
    """The whole run of the module's `EXPERIMENT`, or of the search that fills an archive."""
    return course_of(getattr(request.module, "EXPERIMENT", "quality-diversity"))


@pytest.fixture(scope="module")
def experiment(course):
    return course.experiment


@pytest.fixture(scope="session")
def small():
    def make(**changes):
        return parse(SMALL | {k: {**SMALL.get(k, {}), **v} for k, v in changes.items()})

    return make


@pytest.fixture(scope="session")
def finish():
    def run(experiment, state):
        while not experiment.done(state):
            state, _ = experiment.advance(state)
        return experiment.save(state)

    return run


@pytest.fixture(scope="session")
def lasting():
    """A function that changes the number of generations of a run."""

    def change(experiment, generations):
        spec = json.loads(experiment.facts.spec)
        spec["search"]["generations"] = generations
        facts = replace(experiment.facts, spec=json.dumps(spec, sort_keys=True))
        plan = replace(experiment.plan, generations=generations)
        return replace(experiment, plan=plan, facts=facts)

    return change


@pytest.fixture(scope="session")
def elite_files():
    """A function that gives creature files of elites at the end of a run, in the order of their
    cells: all, or the `most` fittest."""

    def files(course, most=None):
        state = course.states[-1]
        cells = np.flatnonzero(state.elites.occupied)
        fitness = np.asarray(state.elites.fitness)[cells]
        chosen = np.sort(cells[np.argsort(-fitness)[:most]]).tolist()
        return [creature.parse(course.experiment.creature(state, cell)) for cell in chosen]

    return files


@pytest.fixture(scope="session")
def forked_from():
    """A function that gives a run from creatures with the programs of another."""

    def fork(experiment, chosen, files):
        built = build(chosen, files)
        compiled = {"steps": experiment.plan.steps, "evaluate": experiment.plan.evaluate}
        return replace(built, plan=replace(built.plan, **compiled))

    return fork
