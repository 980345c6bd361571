"""Plug-ins that workers offer, and the runs that need them."""

from uuid import UUID

import pytest
from answers import errors
from declared import STRICT, A, B, declared

from microcosmos_server.attempts.claim import claim
from microcosmos_server.schedule.take import take
from microcosmos_server.specs.known_plugins import KnownPlugins
from microcosmos_server.workers import plugins, registry


def test_plug_ins_of_workers_appear_in_the_schemas(api, services, offer):
    before = api.get("experiments").json()
    offer(plugins=declared())
    after = {one["experiment"]: one["schema"] for one in api.get("experiments").json()}
    search = after["quality-diversity"]
    task = search["$defs"]["Task"]["properties"]
    assert task["fitness"]["enum"][-2:] == ["through", "mine.straight"]
    assert task["fitness"]["plugins"]["mine.straight"]["workers"] == ["worker"]
    settings = task["plugin"]["parts"]["mine.straight"]["properties"]["settings"]
    assert settings["properties"] == STRICT["properties"]
    axis = search["$defs"]["Descriptor"]["properties"]
    assert axis["low"]["units"]["mine.sway"] == "cells"
    bodies = [one["properties"] for one in search["properties"]["body"]["oneOf"][-2:]]
    assert [one["builder"]["const"] for one in bodies] == ["mine.cross", "mine.wiggler"]
    pulse = search["properties"]["control"]["oneOf"][-1]["properties"]
    assert pulse["encoding"]["const"] == "mine.pulse"
    emitters = search["$defs"]["Search"]["properties"]["emitters"]["items"]["oneOf"]
    assert emitters[-1]["properties"]["operator"]["const"] == "mine.creep"
    assert after["gaits"]["properties"]["swimmers"]["items"]["enum"][-1] == "mine.wiggler"
    registry.retire(services.sessions, "worker")
    assert api.get("experiments").json() == before


def test_a_run_pins_plug_in_versions_and_settings(api, offer, mine):
    offer(plugins=declared())
    answer = api.post("runs", json=mine)
    assert answer.status_code == 202, answer.text
    spec = answer.json()["spec"]
    straight = {"title": "Straight way", "unit": "cells", "sizes": {}, "source": A}
    assert spec["task"]["plugin"] == {**straight, "settings": {"strictness": 1.0}}
    assert spec["body"]["plugin"]["settings"] == {"strictness": 2}
    assert spec["body"]["plugin"]["sizes"] == {"nodes": 40}
    axis = spec["archive"]["descriptors"][0]
    assert (axis["low"], axis["high"], axis["scale"]) == (0.001, 1.0, "log10")
    run = answer.json()["id"]
    measures = {one["name"]: one for one in api.get(f"runs/{run}/archive").json()["recorded"]}
    assert (measures["mine.sway"]["title"], measures["mine.sway"]["unit"]) == ("Sway", "cells")
    again = api.post("runs", json=spec)
    assert again.json()["spec"] == spec, "what a run has is taken as it is"
    usual = {**spec, "task": {**spec["task"], "fitness": "displacement"}}
    assert "plugin" not in api.post("runs", json=usual).json()["spec"]["task"]


def test_a_plug_in_emitter_is_pinned_with_what_it_learns(api, offer, spec):
    offer(plugins=declared())
    creep = {"operator": "mine.creep", "plugin": {"settings": {"strictness": 3}}}
    search = {"generations": 2, "batch": 8, "emitters": [creep]}
    direct = {**spec, "control": {"encoding": "direct"}}
    run = api.post("runs", json={**direct, "search": search}).json()
    (emitter,) = run["spec"]["search"]["emitters"]
    assert emitter["plugin"]["settings"] == {"strictness": 3}
    facts = {"varies": ["numbers"], "learns": "offspring", "gradients": 0}
    assert emitter["plugin"]["emits"] == facts
    refusal = api.get(f"runs/{run['id']}/choices").json()["refusal"]
    assert "got 'mine.creep', which learns from all of its offspring" in refusal
    (error,) = errors(api.post("runs", json={**spec, "search": search}))
    assert "got 'mine.creep'" in error["reason"], "it varies no networks"


@pytest.mark.parametrize(
    ("part", "value", "field", "words"),
    [
        ("task", {"fitness": "your.task"}, "task.fitness", "no worker has 'your.task'"),
        ("task", {"fitness": "mine.sway"}, "task.fitness", "mine.straight on worker"),
        ("body", {"builder": "your.body"}, "body.builder", "docs/plugins.md"),
        ("control", {"encoding": "your.code"}, "control.encoding", "no worker has"),
        ("task", {"plugin": {"settings": {}}}, "task.plugin", "must be left out"),
        ("task", {"fitness": "mine.straight", "plugin": 3}, "task.plugin", "must be an object"),
        (
            "task",
            {"fitness": "mine.straight", "plugin": {"settings": {"strictness": 11}}},
            "task.plugin.settings.strictness",
            "11 is greater than the maximum of 10",
        ),
        (
            "task",
            {"fitness": "mine.straight", "plugin": {"settings": {"color": 1}}},
            "task.plugin.settings",
            "'color' was unexpected",
        ),
        (
            "task",
            {"fitness": "mine.straight", "plugin": {"source": B, "title": "x"}},
            "task.fitness",
            f"in version {B[:12]}; workers have {A[:12]}",
        ),
    ],
)
def test_a_missing_plug_in_is_refused_with_field_and_reason(
    api, offer, spec, part, value, field, words
):
    offer(plugins=declared())
    answer = api.post("runs", json={**spec, part: value})
    (error,) = errors(answer)
    assert error["field"] == field
    assert words in error["reason"]


@pytest.mark.parametrize(
    "name",
    [
        "os.system",
        "builtins.eval",
        "__import__('os').system('true')",
        "../../etc/passwd",
        "/tmp/own.py",
        "mine.straight.__globals__",
        "mine.__class__",
        "http://127.0.0.1/own.py",
        "mine.straight\n",
        "Mine.straight",
    ],
)
def test_an_unknown_name_imports_nothing(api, offer, spec, name, monkeypatch):
    offer(plugins=declared())
    tried = []
    monkeypatch.setattr("importlib.import_module", lambda *given: tried.append(given))
    for part, field in (("task", "fitness"), ("body", "builder"), ("control", "encoding")):
        answer = api.post("runs", json={**spec, part: {field: name}})
        assert answer.status_code == 422, (field, name)
    axes = {"descriptors": [{"name": name, "low": 0, "high": 1}]}
    assert api.post("runs", json={**spec, "archive": axes}).status_code == 422
    assert not tried


def test_workers_list_plug_ins_and_failed_modules(api, offer):
    offer(plugins=declared(), unloaded=[{"module": "bad.py", "reason": "SyntaxError: x"}])
    (worker,) = api.get("workers").json()
    straight = {"kind": "fitness", "name": "mine.straight", "title": "Straight way"}
    assert worker["plugins"][0] == {**straight, "unit": "cells", "source": A}
    assert worker["unloaded"] == [{"module": "bad.py", "reason": "SyntaxError: x"}]


def test_settings_never_make_the_server_fetch_a_url(api, offer, mine):
    abroad = {"$ref": "http://127.0.0.1:9/schema.json"}
    body = [{**one, "settings": abroad} for one in declared() if one["kind"] == "body"]
    offer(plugins=body)
    spec = {name: mine[name] for name in mine if name not in ("task", "archive")}
    assert api.post("runs", json=spec).status_code == 422


def test_only_a_worker_with_the_plug_in_takes_the_run(api, services, offer, mine, spec):
    offer("with", plugins=declared()), offer("without"), offer("other", plugins=declared(B))
    first = api.post("runs", json={**mine, "task": {"steps": 400}}).json()
    second = api.post("runs", json=spec).json()["id"]
    with services.sessions.read() as session:
        known = KnownPlugins(services, session)
        (able,) = known.workers_with(first["spec"]["body"]["plugin"]["source"])
    names = {"with": A, "other": B}
    assert take(services, next(name for name in names if name != able)) == UUID(second)
    assert take(services, "without") is None
    assert take(services, able) == UUID(first["id"]), "who came first is taken first"


def test_a_run_names_the_plug_in_it_waits_for(api, services, offer, mine, reason):
    offer("with", plugins=declared())
    run = api.post("runs", json=mine).json()["id"]
    assert reason(run) == "A worker is free; this run is next."
    registry.retire(services.sessions, "with")
    offer("without")
    missing = f"Waits for a worker that has mine.cross (version {A[:12]}), "
    assert reason(run).startswith(missing)
    offer("other", plugins=declared(B))
    assert "; other has another version" in reason(run)
    late = api.post("runs", json={**mine, "body": {"builder": "mine.cross"}}).json()
    assert late["spec"]["body"]["plugin"]["source"] == B, "the version that a live worker has"
    offer("again", plugins=declared())
    assert "free" in reason(run)


def test_a_run_refused_by_its_worker_fails_at_once_with_the_reason(attempt, row):
    attempt.refuse("mine.straight must give one number")
    assert (row().status, row().attempt) == ("failed", 1)
    assert row().error == "mine.straight must give one number"


def test_plug_ins_that_no_worker_has_together_are_named(services, offer):
    offer("one", plugins=declared()), offer("two", plugins=declared(B))
    with services.sessions.read() as session:
        alive = KnownPlugins(services, session).alive
    task = {"fitness": "mine.straight", "plugin": {"source": A, "title": "x"}}
    body = {"builder": "mine.cross", "plugin": {"source": B, "title": "x"}}
    document = {"task": task, "body": body}
    assert plugins.needed_versions(document) == [A, B]
    assert "none has them together" in plugins.explain_missing(alive, document)


def test_plugin_gaits_encodings_and_folded_bodies_are_queued(api, offer, mine, sweep, reason):
    offer(plugins=declared())
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
        assert reason(answer.json()["id"]).startswith("A worker is")
    assert "plugins" not in api.post("runs", json=sweep).json()["spec"]


def test_a_run_with_a_plugin_is_extended_as_it_is(api, services, offer, mine):
    offer(plugins=declared(A))
    run = api.post("runs", json=mine).json()
    claim(services, UUID(run["id"]), "worker").finish()
    offer(plugins=declared(B))
    longer = api.post(f"runs/{run['id']}/extend", json={"generations": 1})
    assert longer.status_code == 202
    search = {**run["spec"]["search"], "generations": run["generations"] + 1}
    assert longer.json()["spec"] == {**run["spec"], "search": search}
