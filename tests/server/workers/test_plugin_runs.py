"""Runs that need plug-ins: which worker takes them, and what they wait for."""

from uuid import UUID

from declared import A, B, declared

from server.attempts.claim import claim
from server.workers import plugins, registry
from server.workers.plugins import Reported
from worker.supervisor import runnable_queues


def test_only_a_worker_that_has_it_takes_a_run(api, services, have, mine, row):
    have("with", plugins=declared()), have("without"), have("other", plugins=declared(B))
    run = api.post("runs", json={**mine, "task": {"steps": 40}}).json()
    with services.sessions.read() as session:
        known = Reported(session, services.settings.lease)
        pinned = run["spec"]["body"]["plugin"]["source"]
        (able,) = known.having(pinned)
    names = {"with": A, "other": B}
    for worker in ("without", next(name for name in names if name != able), "nobody"):
        assert claim(services, UUID(run["id"]), worker) is None
        assert api.get(f"runs/{run['id']}").json()["status"] == "queued"
    assert claim(services, UUID(run["id"]), able)


def test_its_job_is_where_only_those_who_have_it_look(api, services, have, mine, spec):
    have("with", plugins=declared())
    first = api.post("runs", json=mine).json()["id"]
    second = api.post("runs", json=spec).json()["id"]
    assert services.jobs.runs.get_job_ids() == [second]
    assert services.jobs.runs_at_hand() == {first, second}
    jobs = [queue.get_job_ids() for queue in runnable_queues(services, {A})]
    assert jobs == [[first], [second], []], "who came first is taken first, sweeps last"
    for plugin_versions in (set(), {B}):
        assert [
            queue.get_job_ids() for queue in runnable_queues(services, plugin_versions)
        ] == [
            [second],
            [],
        ]


def test_a_run_whose_worker_is_away_waits_and_says_for_what(api, services, have, mine):
    have("with", plugins=declared())
    run = api.post("runs", json=mine).json()["id"]
    assert (
        api.get(f"runs/{run}").json()["waiting_reason"] == "A worker is free; this run is next."
    )
    registry.retire(services.sessions, "with")
    have("without")
    waiting = api.get(f"runs/{run}").json()["waiting_reason"]
    assert waiting.startswith(f"Waits for a worker that has mine.cross (version {A[:12]}), ")
    have("other", plugins=declared(B))
    assert "; other has another version" in api.get(f"runs/{run}").json()["waiting_reason"]
    late = api.post("runs", json={**mine, "body": {"builder": "mine.cross"}}).json()
    assert late["spec"]["body"]["plugin"]["source"] == B, "the version that a live worker has"
    have("again", plugins=declared())
    assert "free" in api.get(f"runs/{run}").json()["waiting_reason"]


def test_a_run_refused_by_its_worker_fails_at_once_with_the_reason(api, services, run_id, row):
    claim(services, run_id, "worker").refuse("mine.straight must give one number")
    told = api.get(f"runs/{run_id}").json()
    assert (told["status"], told["attempt"]) == ("failed", 1)
    assert told["error"] == "mine.straight must give one number"


def test_a_run_set_aside_goes_on_when_it_is_resumed(api, services, run_id, row):
    claim(services, run_id, "worker").set_aside("mine.py is not what it was.")
    told = api.get(f"runs/{run_id}").json()
    assert (told["status"], told["warning"]) == (
        "paused",
        "mine.py is not what it was. Then resume the run.",
    )
    assert api.post(f"runs/{run_id}/resume").json()["status"] == "queued"


def test_a_run_of_modules_that_no_worker_has_together_says_so(services, have):
    have("one", plugins=declared()), have("two", plugins=declared(B))
    with services.sessions.read() as session:
        alive = Reported(session, services.settings.lease).alive
    task = {"fitness": "mine.straight", "plugin": {"source": A, "title": "x"}}
    body = {"builder": "mine.cross", "plugin": {"source": B, "title": "x"}}
    assert plugins.needed_versions({"task": task, "body": body}) == [A, B]
    assert "none has them together" in plugins.missing(alive, {"task": task, "body": body})


def test_plugin_gaits_encodings_and_folded_bodies_are_queued(api, have, mine, sweep):
    have(plugins=declared())
    swim = {**sweep, "swimmers": ["worm", "mine.wiggler"]}
    code = {
        **{name: mine[name] for name in ("experiment", "world")},
        "control": {"encoding": "mine.pulse", "period": 40},
        "search": {"emitters": [{"operator": "iso+line"}]},
    }
    fold = {
        "experiment": "folding",
        "targets": [{"kind": "digit", "digit": 3}],
        "body": {"builder": "mine.cross"},
        "steps": 20,
        "updates": 2,
    }
    for spec, part in ((swim, "plugins"), (code, "control"), (fold, "body")):
        assert api.post("runs/estimate", json=spec).status_code == 200, part
        answer = api.post("runs", json=spec)
        assert answer.status_code == 202, answer.text
        found = answer.json()["spec"][part]
        version = found["mine.wiggler"] if part == "plugins" else found["plugin"]
        assert version["source"] == A
        assert (
            api.get(f"runs/{answer.json()['id']}")
            .json()["waiting_reason"]
            .startswith("A worker is")
        )
    assert "plugins" not in api.post("runs", json=sweep).json()["spec"]


def test_a_run_with_a_plugin_is_extended_as_it_is(api, services, have, mine):
    have(plugins=declared(A))
    run = api.post("runs", json=mine).json()
    claim(services, UUID(run["id"]), "worker").finish()
    have(plugins=declared(B))
    longer = api.post(f"runs/{run['id']}/extend", json={"generations": 1})
    assert longer.status_code == 202
    search = {**run["spec"]["search"], "generations": run["generations"] + 1}
    assert longer.json()["spec"] == {**run["spec"], "search": search}
