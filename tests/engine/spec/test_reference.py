"""Every field of every experiment is documented, and the committed reference is current."""

import re
from pathlib import Path

import pytest

from microcosmos.measures import MEASURES, NAMED, RECORDED
from microcosmos.spec.experiments import EXPERIMENTS
from microcosmos.spec.reference import experiment, parts, reference

pytestmark = pytest.mark.fast

DOCUMENT = Path(__file__).parents[3] / "docs" / "spec.md"

WITHOUT_UNIT = """
arms levels branches bins centroids packets placements vortices terms emitters
updates digit edges forcing_iterations constraint_iterations share seed refinement.steps
stretch shear bend gap length_scale faintest spread survival crossover learning_rate
weight_rate replace_rate activation_rate toggle_rate add_node_rate add_connection_rate
Reevaluation.viscosity Screening.unscreened Energy.rate folding.rate
CmaMegaEmitter.rate
iso line step weight_step refinement.length PopulationEmitter.threshold
Bounds.low Bounds.high Graph.nodes Polyline.points softest body_rate shape_rate segment_rate
GrownBody.segments GrownBody.copies GrownBody.limbs GrownBody.rings
LearnedAxes.axes
"""
"""Counts, shares, what genes and weights are measured in, and lists of places in cells."""


def everything():
    for name in EXPERIMENTS:
        yield experiment(name)
    yield from parts()


def test_the_document_is_what_the_schemas_give_now():
    needed = "python -m microcosmos.spec.reference > docs/spec.md"
    assert DOCUMENT.read_text() == reference(), needed


@pytest.mark.parametrize("part", list(everything()), ids=lambda part: part.name)
def test_every_field_has_a_text_and_every_number_a_unit_or_is_known_to_have_none(part):
    assert part.text
    assert [field.name for field in part.fields if not field.text] == []
    plain = WITHOUT_UNIT.split()
    # Choices are in backticks, and a name among them may hold the word.
    kinds = [(field, re.sub("`[^`]*`", "", field.kind)) for field in part.fields]
    numbers = [field for field, kind in kinds if "integer" in kind or "number" in kind]
    lacking = [f.name for f in numbers if not f.unit and f.name not in plain]
    assert [name for name in lacking if f"{part.name}.{name}" not in plain] == []


def test_a_range_a_unit_and_a_default_are_those_of_the_field():
    (world,) = [part for part in parts() if part.name == "World"]
    viscosity = {field.name: field for field in world.fields}["viscosity"]
    found = (viscosity.kind, viscosity.unit, viscosity.range, viscosity.default)
    assert found == ("number", "cells²/step", "[0.001, 2]", "0.05")
    assert world.paths == ("world",)
    folding = {field.name: field for field in experiment("folding").fields}
    assert folding["world"].default.startswith("width 128, height 128")
    assert folding["body"].default == "walk"
    assert folding["updates"].source == "Tensen et al. 2026"


def test_every_part_that_a_field_links_to_is_there():
    names = {part.name for part in parts()}
    for part in everything():
        for field in part.fields:
            for link in field.kind.split("[")[1:]:
                assert link.partition("]")[0] in names


def test_inherited_angles_are_in_rad_and_ends_of_an_axis_in_the_unit_of_its_measure():
    parts = EXPERIMENTS["quality-diversity"].spec.model_json_schema()["$defs"]
    assert parts["Direct"]["properties"]["rest_angle"]["unit"] == "rad"
    for end in ("low", "high"):
        field = parts["Descriptor"]["properties"][end]
        assert field["unit_of"] in parts["Descriptor"]["properties"]
        assert field["units"] == {name: MEASURES[name].unit for name in (*RECORDED, *NAMED)}
