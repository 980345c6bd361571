"""Plug-ins of workers are offered, checked and queued; the server never runs them."""

import pytest
from declared import STRICT, A, B, declared

from server.workers import registry


def test_what_workers_have_is_among_the_choices_of_the_forms(api, services, have):
    before = api.get("experiments").json()
    have(plugins=declared())
    after = {one["experiment"]: one["schema"] for one in api.get("experiments").json()}
    search = after["quality-diversity"]
    fitness = search["$defs"]["Task"]["properties"]["fitness"]
    assert fitness["enum"][-2:] == ["displacement+energy", "mine.straight"]
    assert fitness["plugins"]["mine.straight"]["workers"] == ["worker"]
    settings = search["$defs"]["Task"]["properties"]["plugin"]["parts"]["mine.straight"]
    assert settings["properties"]["settings"]["properties"] == STRICT["properties"]
    axis = search["$defs"]["Descriptor"]["properties"]
    assert axis["name"]["enum"][-1] == "mine.sway"
    assert axis["low"]["units"]["mine.sway"] == "cells"
    builders = [
        one["properties"]["builder"] for one in search["properties"]["body"]["oneOf"][-2:]
    ]
    assert [one["const"] for one in builders] == ["mine.cross", "mine.wiggler"]
    pulse = search["properties"]["control"]["oneOf"][-1]["properties"]
    assert pulse["encoding"]["const"] == "mine.pulse"
    assert "period" in pulse
    assert after["gaits"]["properties"]["swimmers"]["items"]["enum"][-1] == "mine.wiggler"
    registry.retire(services.sessions, "worker")
    assert api.get("experiments").json() == before


def test_a_run_says_which_version_it_needs_with_all_its_settings(api, have, mine):
    have(plugins=declared())
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
    told = {one["name"]: one for one in api.get(f"runs/{run}/archive").json()["recorded"]}
    assert (told["mine.sway"]["title"], told["mine.sway"]["unit"]) == ("Sway", "cells")
    again = api.post("runs", json=spec)
    assert again.json()["spec"] == spec, "what a run has is taken as it is"
    usual = {**spec, "task": {**spec["task"], "fitness": "displacement"}}
    assert "plugin" not in api.post("runs", json=usual).json()["spec"]["task"]


def test_what_a_body_needs_at_most_is_estimated_and_nothing_drawn(api, have, mine):
    have(plugins=declared())
    found = api.post("runs/estimate", json=mine).json()
    chain = {**mine, "body": {"builder": "chain", "nodes": 40}}
    assert found["memory_bytes"] == api.post("runs/estimate", json=chain).json()["memory_bytes"]
    assert found["drawing"]["bodies"] == []


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
def test_what_nobody_has_is_refused_with_field_and_reason(
    api, have, spec, part, value, field, words
):
    have(plugins=declared())
    answer = api.post("runs", json={**spec, part: value})
    assert answer.status_code == 422
    (error,) = answer.json()["errors"]
    assert error["field"] == field
    assert words in error["message"]


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
def test_a_name_is_looked_up_and_nothing_is_imported(api, have, spec, name, monkeypatch):
    have(plugins=declared())
    tried = []
    monkeypatch.setattr("importlib.import_module", lambda *given: tried.append(given))
    for part, field in (("task", "fitness"), ("body", "builder"), ("control", "encoding")):
        answer = api.post("runs", json={**spec, part: {field: name}})
        assert answer.status_code == 422, (field, name)
    axes = {"descriptors": [{"name": name, "low": 0, "high": 1}]}
    assert api.post("runs", json={**spec, "archive": axes}).status_code == 422
    assert not tried


def test_workers_tell_what_they_have_and_what_they_could_not_load(api, have):
    have(plugins=declared(), unloaded=[{"module": "bad.py", "reason": "SyntaxError: x"}])
    (worker,) = api.get("workers").json()
    assert worker["plugins"][0] == {
        "kind": "fitness",
        "name": "mine.straight",
        "title": "Straight way",
        "unit": "cells",
        "source": A,
    }
    assert worker["unloaded"] == [{"module": "bad.py", "reason": "SyntaxError: x"}]


def test_settings_never_send_the_server_anywhere(api, have, mine):
    abroad = {"$ref": "http://127.0.0.1:9/schema.json"}
    body = [{**one, "settings": abroad} for one in declared() if one["kind"] == "body"]
    have(plugins=body)
    spec = {name: mine[name] for name in mine if name not in ("task", "archive")}
    assert api.post("runs", json=spec).status_code == 422
