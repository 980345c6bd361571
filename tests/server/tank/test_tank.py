"""The tank: the best and the most different creatures of the latest runs, over HTTP."""

import numpy as np
import pytest
from answers import errors
from pose_streams import unpacked
from reports import DEMO, audit

from microcosmos_server.attempts.claim import claim
from microcosmos_server.renderings import storage as renderings
from microcosmos_server.runs.submission import submit
from microcosmos_server.tables import AUDIT
from microcosmos_server.tank.routes import most_different

pytestmark = pytest.mark.postgresql


@pytest.fixture
def evolve(services, report):
    """Makes a run that has recorded elites, by cell, each generation its own."""

    def evolve(*generations, ends=True, poses=True):
        attempt = claim(services, submit(services, DEMO)[0].id, "worker")
        for number, elites in enumerate(generations, start=1):
            made = report(number, elites, poses=poses)
            for elite in made.elites:
                elite.descriptors = (elite.cell % 16, elite.cell // 16)
            attempt.record(made, 1.0)
        if ends:
            attempt.finish()
        return str(attempt.run_id)

    return evolve


@pytest.fixture
def tank(api):
    """Reads the tank: (run, generation, fitness) of each swimmer, and the runs."""

    def read(**query):
        found = api.get("tank", params=query).json()
        runs = [one["id"] for one in found["runs"]]
        swimmers = found["swimmers"]
        return [(one["run"], one["generation"], one["fitness"]) for one in swimmers], runs

    return read


def test_the_best_creature_of_a_run_comes_first_and_then_the_most_different(tank, evolve):
    run = evolve({0: 1.0, 1: 3.0, 2: 2.9, 250: 1.5})
    swimmers, runs = tank(limit=2)
    assert (swimmers, runs) == ([(run, 1, 3.0), (run, 1, 1.5)], [run])
    assert len(tank()[0]) == 4


def test_replaced_elites_have_left_the_tank(tank, evolve):
    run = evolve({5: 1.0}, {5: 2.0})
    assert tank()[0] == [(run, 2, 2.0)]


def test_creatures_without_pose_stream_or_not_trusted_are_left_out(api, services, tank, evolve):
    evolve({3: 1.0}, poses=False)
    assert tank()[0] == []
    run = evolve({}, {4: 1.0, 5: 2.0})
    best = api.get("tank").json()["swimmers"][0]["creature"]
    renderings.save(services, best, AUDIT, audit(trusted=False))
    assert tank()[0] == [(run, 2, 1.0)]


def test_runs_take_turns_and_a_running_one_has_two(tank, evolve):
    ended = evolve({}, {0: 2.0, 9: 1.0, 99: 1.5})
    running = evolve({0: 5.0, 9: 4.0, 99: 4.5}, ends=False)
    swimmers, runs = tank(limit=4)
    assert runs == [running, ended]
    assert [run for run, *_ in swimmers] == [running, running, ended, running]


def test_a_creature_of_two_runs_swims_once(tank, evolve):
    evolve({7: 1.0})
    fork = evolve({7: 1.0})
    assert tank()[0] == [(fork, 1, 1.0)]


def test_runs_in_the_bin_have_no_creatures_in_the_tank(api, tank, evolve):
    run = evolve({7: 1.0})
    assert api.delete(f"runs/{run}").status_code < 300
    assert tank() == ([], [])


def test_an_unchanged_tank_is_not_sent_again(api, evolve):
    evolve({7: 1.0})
    first = api.get("tank")
    again = api.get("tank", headers={"If-None-Match": first.headers["etag"]})
    assert (again.status_code, again.content) == (304, b"")
    evolve({}, {8: 1.0})
    later = api.get("tank", headers={"If-None-Match": first.headers["etag"]})
    assert later.status_code == 200


def test_pose_streams_of_many_creatures_come_at_once(api, evolve):
    evolve({7: 1.0, 8: 2.0})
    evolve({}, {9: 3.0}, poses=False)
    names = {one["creature"] for one in api.get("tank").json()["swimmers"]}
    asked = ",".join([*names, "ab" * 32])
    answer = api.get("tank/poses", params={"creatures": asked})
    assert {one.creature for one in unpacked(answer.content)} == names
    assert len(names) == 2
    for wrong in ("", "ab", f"{'ab' * 32},", ",".join(["ab" * 32] * 101)):
        (error,) = errors(api.get("tank/poses", params={"creatures": wrong}))
        assert error["field"] == "creatures"


def test_the_face_of_a_run_is_its_best_creature(api, evolve):
    run = evolve({7: 1.0, 8: 3.0}, {7: 2.0})
    archive = api.get(f"runs/{run}/archive").json()
    best = archive["creature"][archive["fitness"].index(3.0)]
    assert api.get(f"runs/{run}").json()["face"] == best
    (listed,) = api.get("runs").json()["items"]
    assert listed["face"] == best


def test_the_rows_that_spread_most_are_chosen():
    corners = [[0.0, 0.0], [0.0, 9.0], [9.0, 0.0], [9.0, 9.0]]
    crowd = np.full((40, 2), 4.5) + np.random.default_rng(0).normal(0, 0.1, (40, 2))
    places = np.concatenate([crowd[:1], corners, crowd[1:]])
    assert set(most_different(places, 5)) == {0, 1, 2, 3, 4}
    assert most_different(places, 60)[0] == 0
    assert sorted(most_different(places, 60)) == list(range(44))


def test_the_spread_does_not_depend_on_the_scale_of_an_axis():
    places = np.random.default_rng(1).random((50, 2))
    stretched = places * [1000.0, 1.0]
    stretched[:, 1] = np.exp(5 * stretched[:, 1])
    assert most_different(places, 10) == most_different(stretched, 10)
