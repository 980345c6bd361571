"""Captions of groups state physical units that follow from the numbers by hand."""

import pytest
from typer.testing import CliRunner

import microcosmos as mc
from microcosmos.archive.quantities import Real
from microcosmos.cli import app
from microcosmos.statistics import RunRecord, compare, named
from microcosmos.statistics.effects import Bootstrap
from microcosmos.viz.figures import real
from microcosmos.viz.figures.groups import grouped

REAL = Real(1e-3, 0.5)
PERIOD, NODES = 200, 21
"""A body of 20 cells is 1 mm and 200 steps are 0.5 s: a cell is 50 µm, a step 2.5 ms."""
ELITES = [{"cell": 0, "fitness": 1.0}]


@pytest.fixture
def run(made):
    def make(best, seed, **more):
        parts = {"body": {"nodes": NODES}, "control": {"period": PERIOD}} | more
        return made(ELITES, seed=seed, best=(best / 2, best), **parts)

    return make


@pytest.fixture
def record(run):
    def make(best, seed, **more):
        found = run(best, seed, **more)
        name = f"{best}-{seed}.h5"
        return RunRecord(name, found.document, found.curves, "1", found.devices, "finished")

    return make


def of(record, measures, **groups):
    runs = {
        name: [record(*one, **more) for one in given] for name, (given, more) in groups.items()
    }
    return real.of_comparison(compare(named(runs), measures, Bootstrap(99)), REAL)


def test_a_speed_of_lengths_is_in_metres_and_seconds(record):
    seeds = ([(0.1, 0), (0.5, 1), (0.9, 2)], {"world": {"viscosity": 0.1}})
    fast = ([(0.2, 0), (1.0, 1), (3.0, 2)], {"world": {"viscosity": 0.4}})
    text = of(record, ["best", "coverage"], slow=seeds, fast=fast)
    # 0.5 lengths in 1,000 steps are 0.5 mm in 2.5 s; ν = 0.1 (50 µm)² / 2.5 ms.
    assert text == (
        " With a body of 1 mm and a stroke of 500 ms, the median best fitness is 200 µm/s "
        "(slow), 400 µm/s (fast), and the kinematic viscosity is 0.1 mm²/s, less than common "
        "liquids: that of acetone is 3.9 times as high (slow), 0.4 mm²/s, as acetone (fast)."
    )


def test_a_value_to_reach_is_in_units_and_equal_numbers_stand_once(record):
    same = {"world": {"viscosity": 0.4}}
    runs = {"a": ([(0.5, 0)], same), "b": ([(0.7, 1)], same)}
    text = of(record, ["best>=0.5"], **runs)
    assert (
        "the best fitness of 0.5 is 200 µm/s, and the kinematic viscosity is 0.4 mm²/s" in text
    )


def test_a_displacement_needs_the_length_of_the_body(record):
    task = {"task": {"fitness": "displacement", "steps": 400}}
    assert "the median best fitness is 200 µm," in of(record, ["best"], a=([(4.0, 0)], task))
    grown = task | {
        "body": {"builder": "grown"},
        "control": {"encoding": "body-graph", "period": PERIOD},
    }
    text = of(record, ["best"], a=([(4.0, 0)], grown))
    assert text.endswith("500 ms, no number of this figure has a physical unit.")
    swims = of(record, ["best"], a=([(0.5, 0)], grown | {"task": {"fitness": "speed"}}))
    assert swims.endswith("the median best fitness is 200 µm/s.")


def test_a_cost_of_transport_has_no_prefix(record):
    """Its unit has the power 3: 1 mass · cells²/step² per length is a⁴/(τ² L) = 1e-9 m³/s²
    with a = 50 µm, τ = 2.5 ms and L = 1 mm."""
    task = {"task": {"fitness": "cost_of_transport", "steps": 400}}
    text = of(record, ["best"], a=([(-112.0, 0)], task))
    assert "the median best fitness is -1.12e-07 m^3/s^2, over density and depth" in text


def test_curves_state_the_last_median_of_each_group(run):
    runs = [run(0.5, 0), run(0.7, 1), run(0.9, 2)]
    text = real.of_curves(grouped(runs), ["best", "qd_score"], REAL)
    assert "the median best fitness at the end is 280 µm/s, and the kinematic" in text


def test_a_group_without_elites_has_no_number_in_units(run):
    runs = [run(0.5, 0), run(0.5, 1, world={"viscosity": 0.4})]
    for one in runs[1:]:
        one.curves["coverage"][:] = 0
    text = real.of_curves(grouped(runs), ["best"], REAL)
    assert "the median best fitness at the end is 200 µm/s (world viscosity 0.05), and" in text


def test_worlds_without_a_fluid_are_refused(record):
    with pytest.raises(ValueError, match=r"`world.fluid` must be true for physical units"):
        of(record, ["best"], a=([(0.5, 0)], {"world": {"fluid": False}}))


SPEC = {
    "experiment": "quality-diversity",
    "world": {"width": 32, "height": 32},
    "body": {"nodes": 11},
    "control": {"period": 20},
    "task": {"steps": 60},
    "search": {"generations": 1, "batch": 8, "block": 8, "feasible": False},
}


@pytest.mark.parametrize("figure", [["curves"], ["box"], ["parameter", "world.viscosity"]])
def test_the_commands_take_a_length_and_a_period(files, tmp_path, figure):
    out = tmp_path / "a.png"
    command = ["figure", *figure, *map(str, files), str(out), "--length", "1mm"]
    refused = CliRunner().invoke(app, command)
    assert "`length` and `period` must be given together, got `length` '1mm'" in refused.output
    done = CliRunner().invoke(app, [*command, "--period", "0.5s"])
    assert done.exit_code == 0, done.output
    caption = out.with_suffix(".caption.txt").read_text()
    assert "With a body of 1 mm and a stroke of 500 ms, the median best" in caption


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    found = []
    for viscosity in (0.1, 0.4):
        path = tmp_path_factory.mktemp("runs") / f"{viscosity}.h5"
        world = SPEC["world"] | {"viscosity": viscosity}
        mc.evolve(mc.parse(SPEC | {"world": world}), path)
        found.append(path)
    return found
