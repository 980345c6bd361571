"""A small drill for a cluster."""

import pytest
from cluster import Cluster, disturbed, undisturbed

pytestmark = pytest.mark.long


@pytest.fixture
def cluster(tmp_path):
    made = Cluster(tmp_path / "cluster", generations=40)
    yield made
    made.end()


def test_a_run_over_dying_helpers_ends_with_the_bytes_of_one_process(cluster):
    assert disturbed(cluster) == undisturbed(cluster)
