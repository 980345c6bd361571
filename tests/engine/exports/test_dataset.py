"""xarray reads an archive: cells in their places, units, and the same bits from netCDF."""

import io
import json

import numpy as np
import pytest
import xarray as xr
from made_archives import AROUND, AXES, CELLS

import microcosmos as mc
from microcosmos.archive import file
from microcosmos.exports.dataset import netcdf


def opened(data):
    return xr.load_dataset(io.BytesIO(netcdf(mc.to_xarray(data))), engine="h5netcdf")


def test_a_grid_has_its_elites_at_the_middles_of_their_bins(made):
    found = opened(made())
    assert dict(found.fitness.sizes) == {"bending_effort": 4, "straightness": 3}
    where = np.unravel_index(CELLS, (4, 3))
    np.testing.assert_array_equal(found.fitness.values[where], np.float32([1.5, 2.5, np.pi]))
    assert int(found.fitness.notnull().sum()) == 3
    expected = 10 ** (-4 + 6 * (np.arange(4) + 0.5) / 4)
    np.testing.assert_allclose(found.bending_effort, expected, rtol=1e-12)
    np.testing.assert_allclose(found.straightness, [1 / 6, 0.5, 5 / 6])
    np.testing.assert_allclose(found.straightness_bounds[:, 1], [1 / 3, 2 / 3, 1])
    assert found.fitness.attrs == {"long_name": "Fitness", "units": "lengths/1,000 steps"}
    assert found.creature.values[where][0] == bytes(range(32)).hex()
    assert (found.creature == "").sum() == 9
    assert found.straightness.attrs["long_name"] == "Straightness"
    assert "units" not in found.straightness.attrs
    assert json.loads(found.attrs["spec"])["archive"]["descriptors"] == AXES


@pytest.mark.parametrize(("kind", "dimension"), [("cvt", "cell"), ("pool", "place")])
def test_other_archives_have_descriptors_along_one_dimension(made, kind, dimension):
    found = opened(made(kind))
    assert found.fitness.dims == (dimension,)
    if kind == "cvt":
        np.testing.assert_allclose(found.straightness, AROUND[:, 1].astype(float))
        assert np.flatnonzero(found.fitness.notnull()).tolist() == CELLS.tolist()
    else:
        assert found.place.values.tolist() == CELLS.tolist()
        np.testing.assert_array_equal(found.straightness, found.elite_straightness)


def test_numbers_keep_their_bits(ran):
    found = opened(ran)
    tree, attributes = file.load(ran.read_bytes())
    archive, spec = tree["archive"], json.loads(attributes["spec"])
    axes = [axis["name"] for axis in spec["archive"]["descriptors"]]
    for i, name in enumerate(json.loads(attributes["measures"])):
        values = found[f"elite_{name}" if name in axes else name].values
        assert values.dtype == np.float32
        flat = values.reshape(-1)[archive["cell"]]
        assert flat.tobytes() == np.ascontiguousarray(archive["measures"][:, i]).tobytes()
    ages = found.age.values.reshape(-1)[archive["cell"]]
    np.testing.assert_array_equal(ages, 4 - archive["generation"])
