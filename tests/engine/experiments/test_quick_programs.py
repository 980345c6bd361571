"""A search's own programs give the same bits however much the compiler optimises them."""

import pytest
from small_spec import SMALL_RUN

from microcosmos import device, spec
from microcosmos.build import local

pytestmark = [pytest.mark.optimised, pytest.mark.long]

SEARCHES = {
    "mutations": {},
    "crossover beside a population": {
        "search": {
            "emitters": [
                {"operator": "neat", "crossover": 0.5},
                {"operator": "population"},
                {"operator": "random"},
            ]
        }
    },
    "reevaluation": {"search": {"reevaluation": {}}},
    "covariance matrix adaptation": {
        "control": {"encoding": "direct"},
        "search": {"emitters": [{"operator": "cma-mae"}, {"operator": "iso+line"}]},
    },
}


def with_search(found: dict) -> spec.Spec:
    parts = {name: SMALL_RUN.get(name, {}) | part for name, part in found.items()}
    return spec.parse(SMALL_RUN | parts)


@pytest.mark.parametrize("name", SEARCHES)
def test_quick_programs_give_the_bits_of_optimised_ones(name, tmp_path, monkeypatch):
    if not device.quick_options():
        pytest.skip("programs are optimised on this processor")
    files = {how: tmp_path / f"{how}.h5" for how in ("quick", "optimised")}
    assert local.evolve(with_search(SEARCHES[name]), files["quick"])
    monkeypatch.setattr(device, "QUICK", {})
    assert local.evolve(with_search(SEARCHES[name]), files["optimised"])
    assert files["quick"].read_bytes() == files["optimised"].read_bytes()
