"""Learned axes of a run that has ended: measures of its elites, with ends and bins."""

import json
from dataclasses import replace

import numpy as np
import pytest
import reports

from microcosmos.archive import components, file
from microcosmos.archive.axes import floors
from microcosmos.spec import QualityDiversity
from microcosmos_server.auth.authorize import SHARE_HEADER
from microcosmos_server.runs.submission import submit

CONTAINER = {"kind": "learned", "bins": 4, "measures": list(reports.EFFORTS)}


@pytest.fixture
def spec():
    document = reports.DEMO.model_dump(mode="json")
    document["archive"]["container"] = CONTAINER
    return QualityDiversity.model_validate(document)


@pytest.fixture
def run_id(services, spec):
    return submit(services, spec)[0].id


@pytest.fixture
def learned():
    values = 10 ** np.random.default_rng(0).normal(size=(50, 2))
    return components.learn(components.scaled(values, floors(reports.EFFORTS)), 2)


def checkpoint(spec, learned, epoch=1):
    document = spec.model_dump(mode="json")
    archive = {"measures": np.ones((1, 2)), "creature": np.zeros((1, 32), np.uint8)}
    tree = {
        "archive": archive,
        "loop": {"container": {**vars(learned), "epoch": np.int32(epoch)}},
        "learned": {"generation": np.array([1])},
    }
    measures = json.dumps(reports.EFFORTS)
    attributes = {"format": file.FORMAT, "spec": json.dumps(document), "measures": measures}
    return file.dump(tree, attributes)


ASKED = {"measures": "learned_2,learned_1,bending_effort"}


def listed(api, run_id, part=""):
    return api.get(f"runs/{run_id}/archive{part}", params=ASKED)


@pytest.mark.postgresql
def test_elites_have_coordinates_once_the_run_has_ended(
    api, run_id, record, attempt, spec, learned
):
    record(1, {5: 1.0}, measures={"bending_effort": 0.25, "stretching_effort": 4.0})
    record(2, {7: 2.0}, measures={"bending_effort": 2.0, "stretching_effort": 0.1})
    attempt.save(2, checkpoint(spec, learned))
    assert listed(api, run_id).status_code == 422  # Its axes may still change.
    attempt.finish()
    values = components.scaled(np.array([[0.25, 4.0], [2.0, 0.1]]), floors(reports.EFFORTS))
    expected = learned.coordinates(values)
    for part in ("", "/history"):
        found = listed(api, run_id, part).json()["measures"]
        assert list(found) == ["learned_1", "learned_2", "bending_effort"]
        assert found["learned_1"] == pytest.approx(expected[:, 0].tolist())
        assert found["learned_2"] == pytest.approx(expected[:, 1].tolist())
        assert found["bending_effort"] == [0.25, 2.0]
    recorded = listed(api, run_id).json()["recorded"]
    assert [one["bins"] for one in recorded[:3]] == [4, 4, None]
    assert recorded[0]["title"].startswith("Learned axis 1 (")
    ends = [(one["low"], one["high"]) for one in recorded[:2]]
    assert ends == list(zip(learned.low.tolist(), learned.high.tolist(), strict=True))


@pytest.mark.parametrize("later", [None, 3])
def test_a_share_keeps_the_axes_of_its_own_file(
    api, run_id, record, attempt, spec, learned, later
):
    """Later results are not visible through it, and its answers are none of the owner's."""
    record(1, {5: 1.0}, measures={"bending_effort": 0.25, "stretching_effort": 4.0})
    record(2, {7: 2.0}, measures={"bending_effort": 2.0, "stretching_effort": 0.1})
    attempt.save(2, checkpoint(spec, learned))
    slug = api.post("shares", json={"run": str(run_id)}).json()["slug"]
    if later:
        record(later)
    turned = replace(learned, weights=-learned.weights)
    attempt.save(later or 2, checkpoint(spec, turned))
    attempt.finish()

    def found(part, **headers):
        answer = api.get(f"runs/{run_id}/archive{part}", params=ASKED, headers=headers)
        return answer.json()["measures"]["learned_1"]

    for part in ("", "/history"):
        mine = found(part)
        assert found(part, **{SHARE_HEADER: slug}) == pytest.approx([-one for one in mine])
        assert found(part) == mine


def test_a_share_without_a_file_has_no_learned_axes(
    api, run_id, record, attempt, spec, learned
):
    record(1, {5: 1.0})
    record(2, {7: 2.0})
    attempt.save(2, checkpoint(spec, learned))
    attempt.finish()
    slug = api.post("shares", json={"run": str(run_id), "generation": 1}).json()["slug"]
    through = {SHARE_HEADER: slug}
    recorded = api.get(f"runs/{run_id}/archive", headers=through).json()["recorded"]
    assert not [one for one in recorded if one["bins"]]


def test_a_run_that_has_learned_nothing_has_no_learned_axes(
    api, run_id, record, attempt, spec, learned
):
    record(1, {5: 1.0})
    attempt.save(1, checkpoint(spec, learned, epoch=0))
    attempt.finish()
    assert listed(api, run_id).status_code == 422
    recorded = api.get(f"runs/{run_id}/archive").json()["recorded"]
    assert not [one for one in recorded if one["bins"]]
