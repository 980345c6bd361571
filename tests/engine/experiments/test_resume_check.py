"""Files of earlier versions of the program: which specs go on, and which are refused."""

import json

import pytest

from microcosmos.experiments import OtherSpec
from microcosmos.experiments.resume_check import devices_of
from microcosmos.spec import parse


def resumed(held, wanted):
    attributes = {"spec": json.dumps(held), "device": '["a processor"]'}
    return devices_of(json.dumps(wanted), "a processor", attributes, other_device=False)


@pytest.mark.parametrize("experiment", ["quality-diversity", "neuroevolution"])
def test_a_field_that_the_file_lacks_has_its_default(experiment):
    wanted = parse({"experiment": experiment}).model_dump(mode="json")
    for part in ("world", "coupling"):
        for name in wanted.get(part, {}):
            held = {**wanted, part: {**wanted[part]}}
            del held[part][name]
            assert resumed(held, wanted) == ("a processor",)


def test_a_field_that_the_file_lacks_has_no_other_value():
    wanted = parse({"experiment": "quality-diversity"}).model_dump(mode="json")
    wanted["world"]["viscosity"] *= 2
    held = {**wanted, "world": {**wanted["world"]}}
    del held["world"]["viscosity"]
    with pytest.raises(OtherSpec, match="must be the run's own"):
        resumed(held, wanted)


def test_a_spec_that_this_version_cannot_read_is_compared_as_it_stands():
    wanted = parse({"experiment": "quality-diversity"}).model_dump(mode="json")
    with pytest.raises(OtherSpec, match="must be the run's own"):
        resumed({**wanted, "abacus": 3}, wanted)
