"""What a run can be, and what is refused."""

import subprocess
import sys

import pytest
from pydantic import ValidationError

from microcosmos.spec import EXPERIMENTS, QualityDiversity, estimate, field_path, parse

pytestmark = pytest.mark.fast


def refusal(**changes) -> str:
    with pytest.raises(ValidationError) as caught:
        parse({"experiment": "quality-diversity", **changes})
    return "\n".join(f"{field_path(e['loc'])}: {e['msg']}" for e in caught.value.errors())


@pytest.mark.parametrize(
    "preset", EXPERIMENTS["quality-diversity"].presets, ids=lambda p: p.name
)
def test_a_preset_survives_json(preset):
    assert parse(preset.spec.model_dump(mode="json")) == preset.spec


def test_an_unknown_field_is_named():
    assert "world.colour" in refusal(world={"colour": "blue"})


def test_an_unknown_experiment_is_refused_with_the_known_ones():
    with pytest.raises(ValidationError, match="'quality-diversity'"):
        parse({"experiment": "astrology"})


def test_a_negative_viscosity_is_refused_with_what_was_needed():
    text = refusal(world={"viscosity": -0.1})
    assert "world.viscosity" in text
    assert "0.001" in text


def test_a_billion_nodes_are_refused():
    assert "body.nodes" in refusal(body={"nodes": 10**9})


def test_not_a_number_is_refused():
    assert "world.viscosity" in refusal(world={"viscosity": float("nan")})


def test_a_body_larger_than_its_world_is_refused_with_the_width_it_needs():
    assert "`world.width` must be at least 39" in refusal(world={"width": 32})


def test_torque_projection_with_literal_angles_is_refused():
    assert "`projection` must be" in refusal(coupling={"theta_feedback": 0})


def test_a_fixed_magic_parameter_is_refused_where_it_is_unstable():
    assert "`magic` must be" in refusal(world={"magic": "fixed", "viscosity": 0.001})


def test_one_descriptor_twice_is_refused():
    axis = {"name": "bending_effort"}
    assert "`descriptors` must not repeat" in refusal(archive={"descriptors": [axis, axis]})


def test_a_log_axis_from_zero_is_refused():
    axes = [{"name": "bending_effort", "low": 0}, {"name": "stretching_effort"}]
    assert "`low` must be above 0" in refusal(archive={"descriptors": axes})


def test_limits_follow_the_viscosity_unless_they_are_given():
    coupling = QualityDiversity().coupling
    assert coupling.displacement_limit(0.05) == 0.1
    assert coupling.force_limit(0.001) == 0.03
    assert coupling.model_copy(update={"limits": False}).force_limit(0.05) is None


def test_every_field_of_every_form_is_explained():
    definitions = QualityDiversity.model_json_schema()["$defs"]
    silent = [
        f"{part}.{field}"
        for part, schema in definitions.items()
        for field, value in schema["properties"].items()
        if "description" not in value and "$ref" not in str(value) and "const" not in value
    ]
    assert silent == []


def test_memory_grows_with_the_block_and_work_with_the_steps():
    small = QualityDiversity()
    large = parse({**small.model_dump(), "search": {"block": 1024}})
    longer = parse({**small.model_dump(), "task": {"steps": 1000}})
    assert estimate(large).memory_bytes > 32 * estimate(small).memory_bytes
    assert estimate(longer).cell_steps == 2 * estimate(small).cell_steps


@pytest.mark.parametrize(
    "module",
    ["spec", "bodies", "archive.creature", "archive.export", "cli", "client", "doctor"],
)
def test_importing_it_loads_no_jax(module):
    code = f"import sys, microcosmos.{module}; sys.exit('jax' in sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True)
