"""A study on a server: the same sweeps when it is repeated, and files put in their places."""

import shutil
from types import SimpleNamespace

import pytest

from microcosmos.client import Sweep
from microcosmos.client.connection import Connection
from microcosmos.study import remote


class Server:
    """Has the sweeps of a study; their runs are finished after a look, if they are to be."""

    url = "http://server"

    def __init__(self, plan, finish=True):
        self.plan, self.finish, self.asked, self.names, self.looks = plan, finish, [], [], 0

    def submit(self, spec, **asked):
        self.asked.append(asked | {"spec": spec})
        server = self

        class Fake(Sweep):
            def __init__(self):
                record = {"status_counts": {"queued": 2}, "name": None}
                super().__init__(Connection(server.url), record)

            def refresh(self):
                server.looks += 1
                status = "finished" if server.finish else "failed"
                self.record = {"status_counts": {status: 2}}
                return self

            def change(self, *, name):
                server.names.append(name)
                return self

            def runs(self):
                return map(server.run, server.plan.unique())

        return Fake()

    def run(self, planned):
        def pull(path, quiet):
            shutil.copy(planned.path, path)

        status = "finished" if self.finish else "failed"
        spec = planned.spec.model_dump(mode="json")
        return SimpleNamespace(spec=spec, status=status, pull=pull)


@pytest.fixture
def elsewhere(finished, planned, monkeypatch):
    """The plan of the same study in another folder, and a server that has its files."""
    monkeypatch.setattr(remote, "PAUSE", 0.0)
    done, _ = finished
    return lambda finish=True: (planned(), Server(done, finish))


def test_files_of_a_server_are_those_of_this_machine(finished, elsewhere):
    found, server = elsewhere()
    remote.carry_out(found, server)
    assert [run.done() for run in found.unique()] == [(3, True)] * 2
    for here, there in zip(finished[0].unique(), found.unique(), strict=True):
        assert here.path.read_bytes() == there.path.read_bytes()
    (asked,) = server.asked
    assert asked["seeds"] == [3]
    assert asked["grid"] == {"world.viscosity": [0.05, 0.2]}
    assert asked["spec"]["search"]["generations"] == 3


def test_a_repeated_study_asks_for_the_same_sweep_and_nothing_once_it_is_there(elsewhere):
    found, server = elsewhere()
    first = remote._submitted(found, "viscosity", server)
    remote._submitted(elsewhere()[0], "viscosity", server)
    assert isinstance(first, Sweep)
    assert server.asked[0] == server.asked[1]
    remote.carry_out(found, server)
    server.asked.clear()
    remote.carry_out(found, server)
    assert server.asked == []


def test_a_corrected_title_asks_for_the_same_sweep_and_a_long_one_is_cut(elsewhere, planned):
    found, server = elsewhere()
    remote._submitted(found, "viscosity", server)
    remote._submitted(planned(title="t" * 200), "viscosity", server)
    assert server.asked[0] == server.asked[1]
    assert server.names == ["Thin & thick water: viscosity", f"{'t' * 189}: viscosity"]
    # Another spec is another request, also where the grid makes the same runs of it.
    sweep = found.study.sweeps["viscosity"].model_dump()
    sweep["set"]["world.viscosity"] = 0.3
    other = planned(sweeps={"viscosity": sweep})
    assert [run.id for run in other.runs] == [run.id for run in found.runs]
    remote._submitted(other, "viscosity", server)
    assert server.asked[2]["key"] != server.asked[0]["key"]
    assert {one["name"] for one in server.asked} == {"viscosity"}, "runs are named by it"


def test_runs_that_fail_on_the_server_are_named(elsewhere):
    found, server = elsewhere(finish=False)
    ids = ", ".join(run.id for run in found.unique())
    with pytest.raises(ValueError, match=f"http://server has no finished run {ids}"):
        remote.carry_out(found, server)
    assert server.looks == 1
