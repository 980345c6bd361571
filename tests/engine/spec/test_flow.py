"""Flows of a spec: refusal of what cannot be."""

import pytest
from pydantic import ValidationError

from microcosmos import spec

pytestmark = pytest.mark.fast


@pytest.mark.parametrize(
    ("world", "message"),
    [
        ({"flow": {"speed": 0.06}}, "less than or equal to 0.05"),
        ({"flow": {"kind": "vortices", "vortices": 3}}, "multiple of 2"),
        ({"flow": {}, "fluid": False}, "`flow` must be empty where `fluid` is false"),
    ],
)
def test_impossible_flows_are_refused(world, message):
    with pytest.raises(ValidationError, match=message):
        spec.World.model_validate(world)
