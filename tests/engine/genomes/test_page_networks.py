"""The numbers that the page's evaluation of networks is held against are the engine's own."""

import json
import runpy
from pathlib import Path

import numpy as np
import pytest

WEB = Path(__file__).parents[3] / "web"


@pytest.mark.optimised
def test_the_fixture_of_the_page_is_what_the_engine_computes_now():
    kept = json.loads((WEB / "src" / "decode" / "networks.fixture.json").read_text())
    made = json.loads(
        json.dumps(runpy.run_path(str(WEB / "scripts" / "networks.py"))["cases"]())
    )
    assert [case["genome"] for case in made] == [case["genome"] for case in kept]
    for now, then in zip(made, kept, strict=True):
        np.testing.assert_allclose(now["expected"], then["expected"], rtol=1e-4, atol=1e-4)
