"""Sweeps of the small search."""

from uuid import UUID

import pytest

from microcosmos_server.attempts.attempt import Attempt
from microcosmos_server.attempts.claim import claim

VISCOSITIES = {"world.viscosity": [0.05, 0.1]}


@pytest.fixture
def post(api, spec):
    def send(**asked):
        return api.post("sweeps", json={"spec": spec, **asked})

    return send


@pytest.fixture
def six(post):
    """Two viscosities with three seeds each."""
    return post(seeds=3, grid=VISCOSITIES, name="thick and thin").json()


@pytest.fixture
def claimed(services):
    def claimed(run: str | UUID, worker: str = "worker") -> Attempt:
        found = claim(services, UUID(str(run)), worker)
        assert found
        return found

    return claimed


@pytest.fixture
def runs_of(api):
    def runs_of(sweep):
        query = {"sweep": sweep["id"], "sort": "created"}
        return [run["id"] for run in api.get("runs", params=query).json()["items"]]

    return runs_of
