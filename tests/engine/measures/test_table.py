"""The table of measures: one place for names, titles, units, groups and axes."""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import get_args

import pytest

from microcosmos import measures, search, spec
from microcosmos.exports.run_file import fitness_of
from microcosmos.measures import MEASURES, NAMED, RECORDED, derived
from microcosmos.units import DIMENSIONLESS, UNITS

pytestmark = pytest.mark.fast

ROOT = Path(__file__).parents[3]


def test_a_spec_may_name_every_measure_of_a_creature_and_no_other():
    assert get_args(measures.MeasureName) == (*RECORDED, *NAMED)
    for name in (*RECORDED, *NAMED):
        axis, measure = spec.Descriptor.model_validate({"name": name}), MEASURES[name]
        assert (axis.low, axis.high, axis.scale) == (measure.low, measure.high, measure.scale)
    with pytest.raises(ValueError, match="cycle_x"):
        spec.Descriptor.model_validate({"name": "cycle_x"})


def test_measures_of_every_evaluation_come_first_in_a_fixed_order():
    assert search.MEASURES == RECORDED
    assert tuple(MEASURES)[: len(RECORDED)] == RECORDED
    # Archive files hold columns in this order.
    assert RECORDED[:3] == ("displacement", "bending_effort", "stretching_effort")
    assert RECORDED[-1] == "crossing"
    assert len(RECORDED) == 40


def test_every_measure_is_described_and_has_a_known_unit_and_group():
    for one in MEASURES.values():
        assert one.about.endswith("."), one.name
        assert one.unit in UNITS or one.unit in DIMENSIONLESS, one.name
        assert one.group in measures.GROUPS, one.name
    assert tuple(measures.GROUPS) == get_args(measures.Group)
    titles = [one.title for one in MEASURES.values()]
    assert len(set(titles)) == len(titles)


def test_units_follow_from_the_physics():
    """Momentum is mass × speed, power is momentum × speed / time, in a plane of mass cells²."""
    momentum, power, work = (
        UNITS[MEASURES[name].unit] for name in ("impulse", "power", "cost_of_transport")
    )
    speed = UNITS[MEASURES["mean_speed"].unit]
    assert momentum.cells == 2 + speed.cells
    assert momentum.steps == speed.steps
    assert power.cells == momentum.cells + speed.cells
    assert power.steps == momentum.steps + speed.steps - 1
    assert (work.cells, work.steps, work.lengths) == (power.cells, power.steps + 1, -1)
    for fitness, name in (("cost_of_transport", "cost_of_transport"), ("upstream", "advance")):
        assert fitness_of({"fitness": fitness}, {}) == MEASURES[name].unit


def test_named_measures_have_functions_and_their_own_docstring():
    assert NAMED
    for name in NAMED:
        one = MEASURES[name]
        assert one.of is not None
        assert one.about == " ".join(one.of.__doc__.split())
        assert (one.source, one.recorded) == ("motion", "named")
    assert not {*NAMED} & {*measures.SUMMARISED}, "the kernel does not compute them"


@pytest.mark.parametrize("ends", [(1.0, 1.0, "linear"), (0.0, 1.0, "log10")])
def test_a_declaration_has_an_axis_of_some_length(ends):
    with pytest.raises(ValueError, match="must be above"):
        replace(MEASURES["mach"], **dict(zip(("low", "high", "scale"), ends, strict=True)))


def test_reading_the_table_loads_neither_jax_nor_pydantic():
    code = "import sys, microcosmos.measures; print({'jax', 'pydantic'} & {*sys.modules})"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, check=True)
    assert found.stdout.strip() == b"set()"


@pytest.mark.parametrize(
    ("path", "written"),
    [
        ("engine/kernels/src/measures.h", derived.index),
        ("web/src/api/measures.json", derived.page),
    ],
)
def test_the_files_that_follow_from_the_table_are_current(path, written):
    kind = written.__name__
    assert (ROOT / path).read_text() == written(), (
        f"python -m microcosmos.measures {kind} > {path}"
    )


def test_the_documentation_has_every_measure_and_unit():
    table = derived.table()
    for name, one in MEASURES.items():
        assert f"| `{name}`" in table, name
        assert one.about in table
    assert "| lengths/1,000 steps | m/s | ℓ / (1,000 t) | `speed`, `advance` |" in table
    assert "| mass · cells/step | m^3/s | x³ / t | `impulse`:" in table
