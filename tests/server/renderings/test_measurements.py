"""Creatures that are measured again where they have come to."""

import json

import pytest

from microcosmos.archive import creature
from server.renderings import storage as renderings
from server.tables import MEASUREMENT


@pytest.fixture
def known(api, report) -> str:
    (elite,) = report(1, {3: 1.5}).elites
    file = creature.document(json.loads(elite.identity), elite.measured, elite.provenance)
    return api.post("creatures", json=file).json()["creature"]


def test_a_creature_is_measured_again_when_somebody_asks(api, services, known):
    path = f"creatures/{known}/measurement"
    assert api.get(path).status_code == 204
    assert services.jobs.audits.count == 0, "looking orders nothing"
    for _ in range(2):
        assert api.post(f"creatures/{known}/measure").status_code == 202
        assert api.get(path).status_code == 202
    (job,) = services.jobs.audits.get_jobs()
    assert job.args == [known, MEASUREMENT]
    services.jobs.forget(job.id)
    renderings.save(services, known, MEASUREMENT, b'{"exact": true}')
    assert api.get(path).json() == {"exact": True}


def test_it_can_be_measured_once_more(api, services, known):
    renderings.save(services, known, MEASUREMENT, b'{"exact": true}')
    api.post(f"creatures/{known}/measure")
    assert api.get(f"creatures/{known}/measurement").status_code == 202


def test_what_was_never_measured_has_nothing_to_compare_with(api, identity):
    file = creature.document(identity(3), None, None)
    known = api.post("creatures", json=file).json()["creature"]
    answer = api.post(f"creatures/{known}/measure")
    assert (answer.status_code, answer.json()["title"]) == (422, "Never measured")


def test_a_measurement_that_failed_says_why(api, services, known):
    api.post(f"creatures/{known}/measure")
    (job,) = services.jobs.audits.get_jobs()
    services.jobs.give_up(job, "Traceback\nValueError: out of memory\n")
    answer = api.get(f"creatures/{known}/measurement")
    assert answer.status_code == 500
    assert "The measurement failed: ValueError: out of memory" in answer.text
