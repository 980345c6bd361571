"""Every field of every experiment says what it means, and every measure its unit."""

from collections.abc import Iterator
from typing import Any

import pytest

from microcosmos.spec import EXPERIMENTS
from microcosmos.spec.measures import MEASURES

pytestmark = pytest.mark.fast

PURE = {
    "shares and probabilities": "stretch shear bend gap rate crossover survival weight_rate "
    "replace_rate activation_rate toggle_rate add_node_rate add_connection_rate share "
    "learning_rate length_scale",
    "numbers in the space of genes": "step iso line scale spread faintest threshold diversity "
    "length weight_step",
    "counts whose name says of what": "arms levels branches bins centroids terms packets "
    "placements emitters lessons forcing_iterations constraint_iterations updates digit steps",
    "names of random draws": "seed",
}
"""Numbers without a dimension; whoever adds a field decides whether it belongs here."""

NUMBERS = ("integer", "number")


def resolved(schema: dict[str, Any], root: dict[str, Any]) -> dict[str, Any]:
    if "$ref" not in schema:
        return schema
    target = root
    for key in schema["$ref"].split("/")[1:]:
        target = target[key]
    return {**target, **{key: value for key, value in schema.items() if key != "$ref"}}


def options(schema: dict[str, Any], root: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """What a value can be: itself, or any of several, or items of a list."""
    schema = resolved(schema, root)
    yield schema
    for inside in (*schema.get("anyOf", ()), *([schema["items"]] if "items" in schema else ())):
        yield from options(inside, root)


def is_number(schema: dict[str, Any]) -> bool:
    return schema.get("type") in NUMBERS and "enum" not in schema and "const" not in schema


def leaves() -> list[Any]:
    found = {}
    for experiment in EXPERIMENTS.values():
        root = experiment.spec.model_json_schema()
        for owner, part in {experiment.name: root, **root["$defs"]}.items():
            for name, field in part.get("properties", {}).items():
                if "const" not in field and "discriminator" not in field:
                    found[owner, name] = list(options(field, root))
    return [pytest.param(*key, each, id=".".join(key)) for key, each in found.items()]


@pytest.mark.parametrize(("owner", "name", "forms"), leaves())
def test_a_field_says_what_it_means(owner, name, forms):
    assert forms[0].get("description"), f"{owner}.{name} needs a docstring"


@pytest.mark.parametrize(("owner", "name", "forms"), leaves())
def test_a_number_has_a_unit_unless_it_is_pure(owner, name, forms):
    if not any(map(is_number, forms)) or owner == "Bounds":  # Whose unit is its owner's.
        return
    pure = name in " ".join(PURE.values()).split() or (owner, name) == (
        "Reevaluation",
        "viscosity",
    )
    named = any(form.get("unit") or form.get("units") for form in forms)
    assert named or pure, f"{owner}.{name} needs a unit"


def test_bounds_of_inherited_angles_are_in_rad():
    parts = EXPERIMENTS["quality-diversity"].spec.model_json_schema()["$defs"]
    for part in ("Direct", "Grown"):
        assert parts[part]["properties"]["rest_angle"]["unit"] == "rad"


def test_ends_of_an_axis_have_the_unit_of_what_is_measured():
    parts = EXPERIMENTS["quality-diversity"].spec.model_json_schema()["$defs"]
    for end in ("low", "high"):
        field = parts["Descriptor"]["properties"][end]
        assert field["unit_of"] in parts["Descriptor"]["properties"]
        assert field["units"] == {name: one.unit for name, one in MEASURES.items()}
