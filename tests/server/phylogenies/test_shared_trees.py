"""The tree of a shared creature: its ancestors, without descendants and runs."""

import pytest
import reports

from microcosmos.archive import columns, creature
from server.attempts.claim import claim
from server.auth.authorize import SHARE_HEADER


def name(number):
    return creature.name(reports.identity(number))


@pytest.fixture
def shared(api, services, run_id):
    """A share of the second of three generations."""
    attempt = claim(services, run_id, "worker")
    for number in (1, 2, 3):
        found = reports.report(number, {5: float(number)})
        (elite,) = found.elites
        vars(elite).update(reports.creature_of(number))
        parents = [name(number - 1)] if number > 1 else []
        elite.provenance = elite.provenance | {"parents": parents}
        attempt.record(found, 1.0)
    slug = api.post("shares", json={"creature": name(2)}).json()["slug"]
    return lambda path: api.get(path, headers={SHARE_HEADER: slug})


def test_a_share_shows_the_ancestors_of_its_creature_alone(shared, run_id):
    answer = shared(f"creatures/{name(2)}/phylogeny")
    header, arrays = columns.load(answer.content)
    assert [bytes(row).hex() for row in arrays["creature"]] == [name(1), name(2)]
    assert arrays["links"].tolist() == [[1, 0]]
    assert header["runs"] == []
    text = shared(f"creatures/{name(2)}/phylogeny.csv").text
    assert str(run_id) not in text


def test_a_share_shows_no_tree_of_others(shared, run_id):
    assert shared(f"creatures/{name(1)}/phylogeny").status_code == 404
    assert shared(f"runs/{run_id}/phylogeny").status_code == 403
