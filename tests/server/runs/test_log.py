"""The log of a run: an entry for each change, request, checkpoint and failure."""

from uuid import uuid4

import pytest
from answers import fields


@pytest.fixture
def log(api, run_id):
    """The entries as (level, attempt, text)."""

    def read(**params):
        answer = api.get(f"runs/{run_id}/log", params=params)
        assert answer.status_code == 200, answer.text
        return [(e["level"], e["attempt"], e["text"]) for e in answer.json()["entries"]]

    return read


@pytest.fixture
def texts(log):
    return lambda **params: [text for _, _, text in log(**params)]


def test_the_log_of_a_finished_run_is_complete(claim_run, report, log):
    attempt = claim_run("worker 1")
    attempt.record_device("cpu: a processor")
    attempt.record(report(1), 1.0)
    attempt.save(1, b"the archive")
    attempt.finish()
    assert log()[1:] == [
        ("info", 1, "Attempt 1 begins on worker worker 1, from the beginning."),
        ("info", 1, "Computing on cpu: a processor."),
        ("info", 1, "Checkpoint of generation 1 written, 11 B."),
        ("info", 1, "Finished."),
    ]
    level, before, submitted = log()[0]
    assert (level, before) == ("info", 0)
    assert submitted.startswith("Submitted: quality-diversity")


def test_the_log_keeps_the_first_and_last_checkpoint(texts, attempt, record):
    for generation in range(1, 8):
        record(generation)
        attempt.save(generation, b"archive %d" % generation)
        attempt.warn("it is crowded")
    saved = [text for text in texts() if text.startswith("Checkpoint")]
    assert [text.split()[3] for text in saved] == ["1", "7"]
    assert texts().count("it is crowded") == 2


def test_a_failed_attempt_logs_its_traceback_and_the_next_its_start(
    claim_run, log, attempt, record
):
    for generation in (1, 2, 3):
        record(generation)
        if generation == 1:
            attempt.save(1, b"the archive")
    attempt.fail("ZeroDivisionError: twice nothing", "Traceback:\n  File x")
    claim_run("another")
    assert log()[-4:] == [
        ("error", 1, "Attempt 1 failed: ZeroDivisionError: twice nothing"),
        ("info", 1, "Queued for another attempt."),
        ("info", 2, "Attempt 2 begins on worker another, from the checkpoint of generation 1."),
        ("warning", 2, "Discarded generations 2 to 3, recorded after the checkpoint."),
    ]


def test_the_log_has_requests_and_their_completion(run_id, api, texts, attempt, record):
    record(1)
    attempt.save(1, b"the archive")
    api.post(f"runs/{run_id}/pause")
    attempt.pause()
    api.post(f"runs/{run_id}/resume")
    api.post(f"runs/{run_id}/cancel")
    assert texts()[-5:] == [
        "Pause requested.",
        "Stopped after generation 1.",
        "Paused.",
        "Resumed: queued again.",
        "Cancelled.",
    ]


def test_the_log_gives_the_newest_entries_or_those_after_an_id(api, run_id):
    for _ in range(3):
        api.post(f"runs/{run_id}/pause")
        api.post(f"runs/{run_id}/resume")
    whole = api.get(f"runs/{run_id}/log").json()["entries"]
    ids = [entry["id"] for entry in whole]
    assert len(ids) == 7
    assert ids == sorted(ids)
    newest = api.get(f"runs/{run_id}/log", params={"limit": 2}).json()["entries"]
    assert newest == whole[-2:]
    after = api.get(f"runs/{run_id}/log", params={"after": ids[2], "limit": 2}).json()
    assert after["entries"] == whole[3:5]


@pytest.mark.postgresql
def test_the_log_of_no_run_is_not_found_and_a_limit_has_to_make_sense(api, run_id):
    assert api.get(f"runs/{uuid4()}/log").status_code == 404
    for wrong in ({"limit": 0}, {"after": -1}, {"after": 1 << 31}, {"after": 1 << 63}):
        assert fields(api.get(f"runs/{run_id}/log", params=wrong))[0] in wrong
