"""Estimates of time from earlier runs."""

import pytest

from microcosmos.spec import estimate, parse
from microcosmos_server.attempts.claim import claim
from microcosmos_server.runs.submission import submit
from microcosmos_server.workers import registry

DEVICE = "cpu, AMD EPYC avx2, microcosmos 0.1.0, jax 0.10.2"


@pytest.fixture
def measured(services, report):
    def run(document, seconds, first=10.0, device=DEVICE, generations=5):
        made, _ = submit(services, parse(document))
        attempt = claim(services, made.id, "worker")
        attempt.record_device(device)
        for generation in range(1, generations + 1):
            attempt.record(report(generation), first if generation == 1 else seconds)
        return made.id

    return run


def ask(api, document):
    answer = api.post("runs/estimate", json=document)
    assert answer.status_code == 200
    return answer.json()


def test_no_time_is_estimated_without_measured_runs(api, spec, measured):
    assert (ask(api, spec)["seconds"], ask(api, spec)["speed"]) == (None, None)
    measured(spec, 1.0, generations=1)  # Which may have compiled all the time.
    assert ask(api, spec)["seconds"] is None


def test_an_estimate_scales_an_earlier_run_except_for_compilation(api, spec, measured):
    measured(spec, 0.5, first=10.0)
    found = ask(api, spec)
    generations = spec["search"]["generations"]
    assert found["seconds"] == pytest.approx(10.0 + 0.5 * (generations - 1))
    assert (found["speed"]["runs"], found["speed"]["device"]) == (1, "AMD EPYC avx2")
    rate = found["speed"]["cell_steps_per_second"]
    assert rate == pytest.approx(estimate(parse(spec)).cell_steps / generations / 0.5)
    spec["search"]["generations"] *= 2
    assert ask(api, spec)["seconds"] - 9.5 == pytest.approx(2 * (found["seconds"] - 9.5))


def test_several_runs_give_a_median_and_a_range(api, spec, measured):
    for seconds in (0.5, 1.0, 4.0):
        measured(spec, seconds, first=seconds)
    found = ask(api, spec)
    generations = spec["search"]["generations"]
    assert found["speed"]["runs"] == 3
    figures = found["speed"]["low"], found["seconds"], found["speed"]["high"]
    assert figures == pytest.approx([0.5 * generations, generations, 4.0 * generations])


def test_the_most_similar_runs_count(api, spec, measured):
    large = {**spec, "world": {**spec["world"], "width": 128, "height": 128}}
    for _ in range(5):
        measured(large, 1.0)
        measured(spec, 1.0)
    cells = ask(api, spec)["speed"]["cell_steps_per_second"]
    times = 128**2 / (spec["world"]["width"] * spec["world"]["height"])
    assert ask(api, large)["speed"]["cell_steps_per_second"] == pytest.approx(times * cells)


def test_only_runs_of_this_experiment_and_device_count(api, services, spec, sweep, measured):
    measured(spec, 0.5)
    assert ask(api, sweep)["seconds"] is None
    registry.report(services.sessions, "fast", "NVIDIA H100", 1 << 40, "idle")
    assert ask(api, spec)["seconds"] is None
    registry.report(services.sessions, "slow", "AMD EPYC (2 threads)", 1 << 40, "busy")
    assert ask(api, spec)["speed"]["device"] == "AMD EPYC"


def test_runs_of_the_native_kernel_count_for_workers_that_have_it(
    api, services, spec, measured
):
    kernel = "cpu, microcosmos 0.1.0, jax 0.10.2, microcosmos-kernels 0.1.0"
    measured(spec, 0.5, device=kernel)
    assert ask(api, spec)["speed"]["device"] == "a CPU", "the kind names no model"
    cpu = ("AMD EPYC (2 threads)", 1 << 40, "busy")
    registry.report(services.sessions, "without", *cpu)
    assert ask(api, spec)["seconds"] is None
    registry.report(services.sessions, "with", *cpu, device_kinds=[kernel])
    assert ask(api, spec)["speed"]["device"] == "AMD EPYC"


def test_an_estimate_contains_the_queue(api, services, spec, run_id):
    assert ask(api, spec)["queue"] == {"runs_ahead": 1, "workers": 0, "idle_workers": 0}
    registry.report(services.sessions, "one", "cpu", 1 << 40, "idle")
    assert ask(api, spec)["queue"] == {"runs_ahead": 1, "workers": 1, "idle_workers": 1}
    claim(services, run_id, "two")
    registry.report(services.sessions, "two", "cpu", 1 << 40, "busy", run_id)
    assert ask(api, spec)["queue"] == {"runs_ahead": 0, "workers": 2, "idle_workers": 1}


def test_large_drawings_are_thinned(api):
    world = {"width": 2048, "height": 2048}
    walk = {"builder": "walk", "nodes": 4000, "deviation": 0.05}
    folds = {"experiment": "folding", "world": world, "body": walk, "memory": 100}
    (body,) = ask(api, folds)["drawing"]["bodies"]
    assert body["nodes"] == 4000
    assert 500 < len(body["positions"]) < 1100
    answer = api.post("runs/estimate", json={"experiment": "scaling"})
    assert len(answer.content) < 100_000
    assert answer.json()["drawing"]["bodies"][1]["nodes"] == 500_000
