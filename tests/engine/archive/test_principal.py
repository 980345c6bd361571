"""Principal components against a known structure, and their independence of order and scale."""

import numpy as np
import pytest

from microcosmos.archive.population import creatures
from microcosmos.archive.principal import axis, principal

COUNT = 500


def made(order=slice(None), unit=1.0, **changed):
    """Three measures that follow one hidden number, one of its own, one constant."""
    rng = np.random.default_rng(0)
    hidden, other, noise = rng.normal(size=(3, COUNT))
    measures = {
        "speed": 0.3 + 0.1 * hidden,
        "power": 10 ** (-3 + 0.5 * hidden),
        "symmetry": -0.2 * hidden + 0.002 * noise,
        "rotation": unit * other,
        "nodes": np.full(COUNT, 7.0),
    } | changed
    names = [rng.bytes(32).hex() for _ in range(COUNT)]
    columns = {name: np.array(column)[order] for name, column in measures.items()}
    given = np.array(names)[order], np.zeros(COUNT), np.zeros(COUNT, int)
    return creatures(list(given[0]), given[1], given[2], columns)


def test_components_are_made_of_the_measures_that_vary_together():
    (first, second), found = principal(made(), [1, 2])
    assert (first.name, second.name) == ("pc1", "pc2")
    assert first.explained == pytest.approx(3 / 4, abs=0.02)
    assert second.explained == pytest.approx(1 / 4, abs=0.02)
    assert list(first.loadings)[-1] == next(iter(second.loadings)) == "rotation"
    signs = {name: np.sign(first.loadings[name]) for name in ("speed", "power", "symmetry")}
    assert signs["speed"] == signs["power"] == -signs["symmetry"]
    assert "nodes" not in first.loadings
    measured = np.corrcoef(found.measures["pc1"], np.log10(found.measures["power"]))[0, 1]
    assert first.loadings["power"] == pytest.approx(measured, rel=1e-2)


@pytest.mark.parametrize("seed", range(5))
def test_the_order_of_creatures_and_measures_has_no_effect(seed):
    one, found = principal(made(), [1, 2])
    order = np.random.default_rng(seed).permutation(COUNT)
    shuffled = made(order)
    shuffled.measures.update({n: shuffled.measures.pop(n) for n in list(shuffled.measures)[:2]})
    other, again = principal(shuffled, [1, 2])
    assert one == other
    assert [axis(component) for component in one] == [axis(component) for component in other]
    for name in ("pc1", "pc2"):
        assert np.array_equal(found.measures[name], again.measures[name])


def test_a_measure_without_values_is_left_out_unless_it_is_named():
    beats = np.ones(COUNT) * np.arange(COUNT)
    beats[:50] = np.nan
    (first,), found = principal(made(beats=beats), [1])
    assert "beats" not in first.loadings
    assert np.all(np.isfinite(found.measures["pc1"]))
    (first,), found = principal(made(beats=beats), [1], ["beats", "speed"])
    assert set(first.loadings) == {"beats", "speed"}
    assert np.count_nonzero(np.isnan(found.measures["pc1"])) == 50


def test_ends_are_percentiles():
    (first,), found = principal(made(), [1])
    ends = axis(first, 10)
    beyond = (found.measures["pc1"] < ends.low) | (found.measures["pc1"] > ends.high)
    assert np.count_nonzero(beyond) == 2 * int(0.01 * (COUNT - 1))
    assert ends.bins == 10


def test_measures_that_do_not_vary_are_too_few():
    with pytest.raises(ValueError, match=r"at least 2 measures that vary .*got 1 and 500"):
        principal(made(), [1], ["nodes", "speed"])
    with pytest.raises(ValueError, match="got 0 and 0"):
        principal(made(speed=np.full(COUNT, np.nan)), [1], ["speed"])
