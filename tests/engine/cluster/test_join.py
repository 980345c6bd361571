"""The helpers of a machine: how many, and what follows when one dies."""

import time

import pytest

from microcosmos.cluster import join


def test_more_processes_than_gpus_are_refused(tmp_path, monkeypatch):
    """Each GPU has one helper, so that the rest would be missing silently."""
    gpus = {"devices": [{"platform": "gpu", "id": 0}, {"platform": "gpu", "id": 1}]}
    monkeypatch.setattr(join, "probed", lambda *given: gpus)
    monkeypatch.delenv("CUDA_VISIBLE_DEVICES", raising=False)
    needed = "--processes must be at most 2, the number of GPUs; got 3"
    with pytest.raises(ValueError, match=needed):
        join.join("tcp://127.0.0.1:8786", [], tmp_path, processes=3)


def test_a_dead_helper_starts_again_after_a_while_in_which_nobody_waits_for_it():
    process = join.Process("one", ["false"], {}, None)
    process.start()
    for failures in range(1, join.ATTEMPTS):
        with process.running as before:
            before.wait()
        asked = time.monotonic()
        assert not process.has_given_up()
        assert process.running is before
        # At least as long as it should wait, and no longer in this call.
        assert process.due - time.monotonic() <= 2.0**failures <= process.due - asked
        process.due = asked
        assert not process.has_given_up()
        assert process.running is not before
    with process.running as last:
        last.wait()
    assert process.has_given_up()
