"""Species over the generations, reasons of divergence, and the pictures of a folding."""

import base64

import pytest

from microcosmos.spec import EXPERIMENTS, targets
from server.attempts.claim import claim
from server.runs.submission import submit


def test_species_are_told_generation_by_generation(api, services, run_id, report):
    attempt = claim(services, run_id, "worker")
    attempt.record(report(1, summary={"species": "0:10 3:6"}), 1.0)
    attempt.record(report(2, summary={"device_seconds": 1.0}), 1.0)
    attempt.record(report(3, summary={"species": "3:16"}), 1.0)
    assert api.get(f"runs/{run_id}/species").json() == {
        "generation": [1, 3],
        "number": [[0, 3], [3]],
        "members": [[10, 6], [16]],
    }
    thin = api.get(f"runs/{run_id}/species", params={"points": 2}).json()
    assert thin["generation"] == [1, 3]


def test_a_run_that_tells_no_species_has_none(api, services, run_id, report):
    claim(services, run_id, "worker").record(report(1), 1.0)
    assert api.get(f"runs/{run_id}/species").json()["generation"] == []


def test_reasons_of_divergence_are_added_up_where_curves_are_thinned(
    api, services, run_id, report
):
    attempt = claim(services, run_id, "worker")
    for generation in range(1, 11):
        told = {"diverged: non-finite": 2, "inserted": generation}
        told |= {"diverged: supersonic": 1} if generation == 4 else {}
        attempt.record(report(generation, summary=told), 1.0)
    columns = api.get(f"runs/{run_id}/generations", params={"points": 3}).json()["summary"]
    assert sum(filter(None, columns["diverged: non-finite"])) == 20
    assert sum(filter(None, columns["diverged: supersonic"])) == 1
    assert columns["inserted"][-1] == 10


@pytest.fixture
def fold_id(services):
    presets = {preset.name: preset.spec for preset in EXPERIMENTS["folding"].presets}
    return submit(services, presets["demo"])[0].id


def test_pictures_that_a_run_folds_into_are_as_its_filaments_see_them(api, fold_id):
    first, second = api.get(f"runs/{fold_id}/targets").json()
    assert (first["name"], second["name"]) == ("3", "7")
    assert (first["width"], first["height"], first["size"]) == (32, 32, 32)
    ink = targets.decoded(first["pixels"], 32, 32)
    assert abs(ink - targets.fitted(targets.digit(3), 32)).max() < 1 / 255
    assert base64.b64decode(first["pixels"]) != base64.b64decode(second["pixels"])


def test_a_run_that_folds_nothing_has_no_pictures(api, run_id):
    refused = api.get(f"runs/{run_id}/targets")
    assert refused.status_code == 404
    assert "folds nothing" in refused.json()["detail"]
