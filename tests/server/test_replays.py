"""Orders of replays, and what comes of them."""

import httpx
import pytest

from microcosmos.archive import creature
from server import replays


@pytest.fixture
def known(api, identity) -> str:
    file = creature.document(identity(3), None, None)
    return api.post("creatures", json=file).json()["creature"]


def test_a_replay_that_the_engine_refuses_is_refused_in_its_words(api, services, known):
    error = creature.CreatureError("task.steps", "at most 1 cell step for a replay", 2)
    services.jobs.render(known)
    job = services.jobs.find(services.jobs.replay_id(known))
    services.jobs.give_up(job, f"Traceback\n{type(error).__module__}.CreatureError: {error}\n")
    answer = api.get(f"creatures/{known}/replay")
    assert answer.status_code == 500
    said = "The replay could not be made: `task.steps` needs at most 1 cell step"
    assert answer.json()["detail"].startswith(said)
    assert services.jobs.replays.count == 0


def test_an_order_that_vanishes_while_it_is_looked_at_is_no_error(services, known, monkeypatch):
    services.jobs.render(known)
    job = services.jobs.find(services.jobs.replay_id(known))
    services.jobs.forget(job.id)
    monkeypatch.setattr(services.jobs, "find", lambda _: job)
    replays.order(services, known)


def test_a_range_beyond_all_numbers_is_ignored(api, services, known):
    replays.save(services, known, b"the replay")
    for wanted in ("bytes=" + "9" * 5000 + "-", "bytes=-" + "9" * 5000):
        answer: httpx.Response = api.get(f"creatures/{known}/replay", headers={"Range": wanted})
        assert (answer.status_code, answer.content) == (200, b"the replay")
