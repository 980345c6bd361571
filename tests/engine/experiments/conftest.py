"""A run small enough to be carried out many times."""

import json
from dataclasses import replace

import pytest

from microcosmos.build import build
from microcosmos.spec import parse

SMALL = {
    "experiment": "quality-diversity",
    "seed": 3,
    "world": {"width": 32, "height": 32},
    "body": {"nodes": 12},
    "control": {"period": 30},
    "task": {"steps": 60},
    "search": {"generations": 4, "batch": 16, "block": 8},
}


@pytest.fixture(scope="session")
def small():
    """A function that makes the small spec, parts of it changed."""

    def make(**changes):
        return parse(SMALL | {k: {**SMALL.get(k, {}), **v} for k, v in changes.items()})

    return make


@pytest.fixture(scope="session")
def experiment(small):
    return build(small())


@pytest.fixture(scope="session")
def carry_out():
    """A function that gives states and reports of a whole run, the initial state first."""

    def run(experiment):
        states, reports = [experiment.init()], []
        while not experiment.done(states[-1]):
            state, report = experiment.advance(states[-1])
            states.append(state)
            reports.append(report)
        return states, reports

    return run


@pytest.fixture(scope="session")
def finish():
    """A function that carries a run on to its end; the file."""

    def run(experiment, state):
        while not experiment.done(state):
            state, _ = experiment.advance(state)
        return experiment.save(state)

    return run


@pytest.fixture(scope="session")
def lasting():
    """A function that gives an experiment another number of generations, and its programs."""

    def change(experiment, generations):
        spec = json.loads(experiment.plan.spec)
        spec["search"]["generations"] = generations
        text = json.dumps(spec, sort_keys=True)
        return replace(
            experiment, plan=replace(experiment.plan, generations=generations, spec=text)
        )

    return change


@pytest.fixture(scope="session")
def course(experiment, carry_out):
    """States and reports of the whole run, the initial state first."""
    return carry_out(experiment)
