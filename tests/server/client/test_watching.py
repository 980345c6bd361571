"""A run is followed to its end, whatever happens to the stream."""

import pytest

from microcosmos.client import Client, NoAnswer, polling
from microcosmos.client.errors import Refused
from microcosmos.client.views import watch
from server.attempts.claim import claim


class Kept:
    """A view that keeps what it was shown."""

    def __init__(self, react=lambda state: None):
        self.shown: list[tuple[str, int, list[int]]] = []
        self.react = react

    def __enter__(self):
        return self

    def __exit__(self, *_: object) -> None: ...

    def show(self, state: polling.RunState) -> None:
        record = state.record
        curve = list(state.curves["generation"])
        self.shown.append((record["status"], record["generation"], curve))
        self.react(state)


@pytest.fixture
def worked(services, run_id, report):
    """The run goes on by a generation whenever it is shown, until its third."""
    attempt = claim(services, run_id, "worker")
    left = [1, 2, 3, None]

    def go_on(state: polling.RunState) -> None:
        reached = (state.curves["generation"] or [0])[-1]
        if left and reached == 4 - len(left):
            generation = left.pop(0)
            if generation:
                attempt.record(report(generation), float(generation))
            else:
                attempt.finish()

    return go_on


def test_a_run_is_followed_by_events(client, run, worked):
    view = Kept(worked)
    assert watch(polling.follow(client.connection, run.id), "Run x", view) == "finished"
    status, generation, curve = view.shown[-1]
    assert (status, generation, curve) == ("finished", 3, [1, 2, 3])
    curves = [curve for _, _, curve in view.shown]
    assert curves == sorted(curves)  # Nothing twice, nothing out of order.


def test_where_no_stream_comes_through_it_is_asked_for(client, run, worked, monkeypatch):
    def none(*_: object):
        raise Refused("no streams here")
        yield

    monkeypatch.setattr(polling, "events", none)
    monkeypatch.setattr(polling, "POLL", 0.01)
    view = Kept(worked)
    for state in polling.follow(client.connection, run.id):
        view.show(state)
    assert view.shown[-1] == ("finished", 3, [1, 2, 3])


def test_a_server_that_is_away_for_a_while_is_waited_for(
    serve, services, run, worked, monkeypatch
):
    monkeypatch.setattr(polling, "POLL", 0.01)
    with serve() as address:
        client = Client(address, patience=0.0)
        ask, broken = client.connection.read, []

        def read(path: str, **asked: object):
            if len(broken) < 3:
                broken.append(path)
                raise NoAnswer("No server answers.")
            return ask(path, **asked)

        found = polling.follow(client.connection, run.id)
        view = Kept()
        view.show(next(found))
        monkeypatch.setattr(client.connection, "read", read)
        troubles = []
        for state in found:
            troubles.append(state.problem)
            if state.problem is None:
                worked(state)
        assert troubles.count("No server answers.") >= 1
        assert (troubles[-1], state.record["status"]) == (None, "finished")


def test_what_was_never_there_is_an_error_at_once():
    with pytest.raises(NoAnswer, match="make run"):
        next(polling.follow(Client("127.0.0.1:9").connection, "x"))


def test_a_rewound_run_forgets_what_came_after(client, services, run, run_id, report):
    attempt = claim(services, run_id, "worker")
    for generation in (1, 2, 3):
        attempt.record(report(generation), 1.0)
        if generation == 1:
            attempt.save(1, b"state")
    found = polling.follow(client.connection, run.id)
    assert next(found).curves["generation"] == [1, 2, 3]
    while (state := next(found)).curves["generation"] == [1, 2, 3]:
        claim(services, run_id, "worker")
    assert state.curves["generation"] == [1]
