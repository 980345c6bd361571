"""The value that an error states is enough: a person sets it, and the field is accepted."""

import json
import re

import pytest
from pydantic import ValidationError

from microcosmos import spec
from microcosmos.spec import World, parse, paths
from microcosmos.spec.base import enough

pytestmark = pytest.mark.fast

SCHOOLS = [
    {"arrangement": arrangement, "count": count, "spacing": spacing}
    for arrangement in ("row", "column", "grid")
    for count, spacing in ((3, 2), (5, 21.337))
]
BODIES = [
    {"nodes": 12},
    {"builder": "polyline", "points": [[0, 0], [9, 5.013]], "spacing": 1.1},
    {"builder": "tadpole"},
    {"builder": "jellyfish"},
]
STATED = re.compile(r"`([\w.]+)` must be at least ([\d.]+) ")


def refusal(document):
    """Return the first error of a spec, None if it is accepted."""
    try:
        parse(document)
    except ValidationError as error:
        return error.errors()[0]["msg"]
    return None


def mended(document):
    """Set what errors state until there are none, each at once; return the fields."""
    done, before = [], None
    while message := refusal(document):
        rule = re.sub(r"[\d.]+", "", message)
        assert rule != before, message
        path, value = STATED.search(message).groups()
        document = paths.replaced(document, path, json.loads(value))
        before = rule
        done.append(path)
    return set(done)


@pytest.mark.parametrize("body", BODIES, ids=lambda body: body.get("builder", "default"))
@pytest.mark.parametrize(
    "school", SCHOOLS, ids=lambda one: f"{one['arrangement']}{one['count']}"
)
@pytest.mark.parametrize("trials", [1, 3])
def test_what_a_school_needs_is_enough(body, school, trials):
    document = {
        "experiment": "quality-diversity",
        "world": {"width": 32, "height": 32, "copies": school},
        "body": body,
        "task": {"trials": trials},
    }
    assert mended(document) & {"world.copies.spacing", "world.width", "world.height"}


def test_the_memory_that_a_folding_needs_is_enough():
    document = spec.experiments.presets()["folding/demo"].model_dump(mode="json")
    assert mended(document | {"memory": 1e-9}) == {"memory"}


@pytest.mark.parametrize(
    ("needed", "text"),
    [(19.2551, "19.26"), (19.26, "19.27"), (20.0, "20"), (0.001234501, "0.001235")],
)
def test_digits_are_rounded_up(needed, text):
    """The float 19.26 lies above the decimal."""
    assert enough(needed) == text
    assert float(text) >= needed


def test_a_faint_field_is_refused_with_another_number_than_the_needed_one():
    with pytest.raises(ValidationError, match=r"must be 1e-6 or more.*got 9\.999997e-07"):
        World(energy={"consume": True, "rate": 0.7, "amplitude": 1.428571e-6})
