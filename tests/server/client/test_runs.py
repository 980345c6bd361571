"""Runs by the client: submitted once, found, changed, watched, read as columns."""

import json
from contextlib import nullcontext

import numpy as np
import pytest

from microcosmos.client import Conflict, NotFound, Refused, polling
from microcosmos.client.views import watch
from microcosmos.spec.quality_diversity import DEMO
from microcosmos_server.attempts.claim import claim


def test_a_spec_a_file_and_a_preset_are_submitted(client, spec, tmp_path):
    (tmp_path / "spec.json").write_text(json.dumps(spec | {"seed": 7}))
    plain = client.submit(spec | {"seed": 5}, name="mine")
    assert (plain.status, plain.name, plain.spec["seed"]) == ("queued", "mine", 5)
    assert client.submit(tmp_path / "spec.json").spec["seed"] == 7
    assert client.submit("demo").spec == DEMO.model_dump(mode="json")
    assert client.submit("gaits/demo").experiment == "gaits"
    assert len(list(client.runs())) == 4
    assert client.last().experiment == "gaits"


def test_a_key_names_one_run_and_refused_names_and_presets_none(client, spec):
    with pytest.raises(ValueError, match=r"quality-diversity/demo.*got nonsense"):
        client.submit("nonsense")
    with pytest.raises(Refused, match="at most 200"):
        client.submit(spec, name="a" * 201)
    assert list(client.runs()) == []
    named = client.submit(spec, name=" one ", key="the same")
    assert client.submit(spec, name=" one ", key="the same") == named
    assert named.name == "one"
    for other in ("another", None):
        with pytest.raises(Refused, match="another request"):
            client.submit(spec, name=other, key="the same")
    assert client.submit(spec) != named


def test_invalid_fields_become_a_sentence(client, spec):
    wrong = spec | {"seed": -1, "world": {"viscosity": -2}}
    with pytest.raises(Refused) as caught:
        client.submit(wrong)
    message = str(caught.value)
    assert "seed: needs greater than or equal to 0; got -1" in message
    assert "world.viscosity" in message
    assert message.endswith(".")
    assert {error["field"] for error in caught.value.errors} == {"seed", "world.viscosity"}
    assert caught.value.status == 422


def test_a_run_is_found_by_the_beginning_of_its_id(client, run, spec):
    assert client.run(run.id[:8]) == run
    assert client.run(run.id.upper()) == run
    with pytest.raises(NotFound, match="begins with 00000000"):
        client.run("00000000")
    with pytest.raises(Refused, match="got 'a name'"):
        client.run("a name")
    for _ in range(20):  # More than 16 ids: two begin alike.
        client.submit(spec)
    ids = [one.id for one in client.runs()]
    twice = next(i[0] for i in ids if sum(j[0] == i[0] for j in ids) > 1)
    with pytest.raises(Refused, match="Write more of it"):
        client.run(twice)


def test_a_list_goes_on_over_pages(client, spec, monkeypatch):
    sent = {client.submit(spec | {"seed": seed}).id for seed in range(3)}
    ask = client.connection.content
    monkeypatch.setattr(
        client.connection, "content", lambda path, **asked: ask(path, **{**asked, "limit": 2})
    )
    assert {one.id for one in client.runs()} == sent
    assert list(client.runs(status="running")) == []
    assert list(client.runs(experiment=["gaits", "folding"])) == []


def test_a_run_is_awaited_paused_resumed_changed_and_cancelled(run):
    with pytest.raises(TimeoutError, match="it is queued"):
        run.wait(timeout=0.05)
    assert run.pause().status == "paused"
    assert run.resume().status == "queued"
    assert run.change(tags=["a", "b"], note="why").record["tags"] == ["a", "b"]
    assert run.cancel().status == "cancelled"
    with pytest.raises(Conflict, match="it is cancelled"):
        run.pause()
    assert run.wait(timeout=0) == "cancelled"
    assert run.uncancel().status == "queued"


def test_curves_are_columns(run, record):
    record(1, summary={"hit_rate": 0.5})
    record(2, seconds=2.0)
    curves = run.curves()
    assert curves["generation"].tolist() == [1, 2]
    assert curves["qd_score"].tolist() == [10.0, 20.0]
    np.testing.assert_array_equal(curves["hit_rate"], [0.5, np.nan])
    assert run.refresh().generation == 2
    assert any("Submitted" in entry["text"] for entry in run.log())


def test_an_archive_is_columns_and_creatures(run, record):
    empty = run.archive()
    assert len(empty) == 0
    with pytest.raises(ValueError, match="has none yet"):
        empty.best()
    record(1, {5: 1.0, 3: 2.0}, measures={"turning": 0.25})
    record(2, {5: 3.0}, measures={"turning": 0.5})
    archive = run.archive()
    assert archive.cell.tolist() == [3, 5]
    assert archive.fitness.tolist() == [2.0, 3.0]
    assert archive.measures["turning"].tolist() == [0.25, 0.5]
    assert archive.best().fitness == 3.0
    assert archive.elite(3) == archive.elite((0, 3))
    assert run.archive(generation=1).fitness.tolist() == [2.0, 1.0]
    with pytest.raises(Refused, match="at most 2, the run's last one; got 99"):
        run.archive(99)
    for cell in (1.0, True, (0, 3.0), "03"):
        with pytest.raises(ValueError, match="`cell` must be from 0 to"):
            archive.elite(cell)


def test_a_table_comes_as_rows(client, services, sweep_id, table):
    attempt = claim(services, sweep_id, "worker")
    attempt.record(table(1, {"number": 1, "speed": 0.5}, summary={"fastest": 0.5}), 1.0)
    found = client.run(str(sweep_id)).results()
    assert found.rows[0]["speed"] == 0.5
    assert found.summary == {"fastest": 0.5}
    with pytest.raises(NotFound, match="has no archive"):
        client.run(str(sweep_id)).archive()


class RecordingView:
    """A view that records the states that it receives."""

    def __init__(self, react=lambda state: None):
        self.shown: list[tuple[str, int, list[int]]] = []
        self.react = react

    def __call__(self, state: polling.RunState) -> None:
        record = state.record
        curve = list(state.curves["generation"])
        self.shown.append((record["status"], record["generation"], curve))
        self.react(state)


@pytest.fixture
def advance(attempt, record):
    """Records a generation at each update of a view; finishes the run after the third."""
    left = [1, 2, 3, None]

    def go_on(state: polling.RunState) -> None:
        reached = (state.curves["generation"] or [0])[-1]
        if left and reached == 4 - len(left):
            generation = left.pop(0)
            if generation:
                record(generation, seconds=float(generation))
            else:
                attempt.finish()

    return go_on


def test_a_run_is_followed_by_events(client, run, advance):
    view = RecordingView(advance)
    states = polling.follow(client.connection, run.id)
    assert watch(states, "Run x", nullcontext(view)) == "finished"
    assert view.shown[-1] == ("finished", 3, [1, 2, 3])
    curves = [curve for _, _, curve in view.shown]
    assert curves == sorted(curves)  # Nothing twice, nothing out of order.


def test_watching_polls_without_a_stream(client, run, advance, monkeypatch):
    def none(*_: object):
        raise Refused("no streams here")
        yield

    monkeypatch.setattr(polling, "events", none)
    monkeypatch.setattr(polling, "POLL", 0.01)
    view = RecordingView(advance)
    for state in polling.follow(client.connection, run.id):
        view(state)
    assert view.shown[-1] == ("finished", 3, [1, 2, 3])


def test_a_rewound_run_drops_later_generations(client, services, run, run_id, attempt, record):
    for generation in (1, 2, 3):
        record(generation)
        if generation == 1:
            attempt.save(1, b"state")
    found = polling.follow(client.connection, run.id)
    assert next(found).curves["generation"] == [1, 2, 3]
    while (state := next(found)).curves["generation"] == [1, 2, 3]:
        claim(services, run_id, "worker")
    assert state.curves["generation"] == [1]
