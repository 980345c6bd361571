"""One product for the tests of this folder, which begins empty and may be ended."""

import pytest
from drive import running


@pytest.fixture(scope="package")
def product(product_settings, tmp_path_factory):
    """A product that is new for the first file, `test_empty_tank.py`."""
    with running(tmp_path_factory.mktemp("own") / "data", product_settings) as product:
        yield product
