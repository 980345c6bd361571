"""The fluid against flows in closed form, and what it keeps."""

import pytest

from validation import flows


def test_shear_waves_decay_at_the_viscous_rate(dtype):
    assert not flows.check_shear_wave((0.53, 0.8, 2.0), dtype.name).missed


@pytest.mark.long
def test_kolmogorov_flow_is_exact_to_a_thousandth_at_any_viscosity(dtype):
    assert not flows.check_kolmogorov(name=dtype.name).missed


@pytest.mark.long
def test_taylor_green_vortices_decay_at_the_viscous_rate_and_converge(dtype):
    assert not flows.check_taylor_green(name=dtype.name).missed


@pytest.mark.long
def test_walls_stand_exactly_halfway(float64):
    assert not flows.check_poiseuille((0.6, 2.0), (0.6,)).missed


@pytest.mark.long
def test_mass_and_momentum_are_kept_for_ten_thousand_steps(dtype):
    assert not flows.check_conservation(size=(24, 16), name=dtype.name).missed
