"""Widgets for notebooks: what they hand to the browser."""

import json
import time
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import microcosmos as mc
from microcosmos.archive import file, poses
from microcosmos.client.archive import Archive
from microcosmos.client.views import live
from microcosmos.widgets import archive_map, contents

TINY = {
    "experiment": "quality-diversity",
    "world": {"width": 24, "height": 24},
    "body": {"nodes": 8},
    "control": {"period": 10},
    "task": {"steps": 20},
    "archive": {"descriptors": [{"name": "symmetry", "bins": 6}, {"name": "speed", "bins": 5}]},
    "search": {"generations": 3, "batch": 8, "block": 8, "feasible": False},
}


@pytest.fixture(scope="module", autouse=True)
def built():
    """Widgets need their script, which `make web` builds; its text plays no part here."""
    try:
        archive_map.script()
    except FileNotFoundError as error:
        pytest.skip(str(error))


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A finished run's file, its spec, and the map that followed it."""
    path = tmp_path_factory.mktemp("run") / "run.h5"
    spec = mc.parse(TINY)
    followed = mc.ArchiveMap(spec)
    mc.evolve(spec, path, tell=followed.tell)
    return SimpleNamespace(path=path, spec=spec, followed=followed)


@pytest.fixture(scope="module")
def tree(run):
    return file.load(run.path.read_bytes())[0]["archive"]


def test_a_map_has_the_elites_of_the_file(run, tree):
    shown = mc.ArchiveMap(run.path)._archive
    order = np.argsort(tree["cell"])
    assert shown["cell"] == tree["cell"][order].tolist()
    np.testing.assert_array_equal(shown["fitness"], tree["fitness"][order])
    assert shown["creature"] == [bytes(one).hex() for one in tree["creature"][order]]
    assert [axis["bins"] for axis in shown["axes"]] == [6, 5]
    assert shown["cells"] == 30
    speed = shown["measures"]["speed"]
    assert [row[1] for row in shown["descriptors"]] == speed


def test_the_motions_are_those_of_the_file(run):
    batch = mc.ArchiveMap(run.path)._poses
    found = {one.creature: one for one in map(poses.decode, poses.unbatched(batch))}
    expected = {one.creature: one for one in mc.pose_streams(run.path)}
    assert found.keys() == expected.keys()
    for name, one in expected.items():
        np.testing.assert_array_equal(found[name].positions, one.positions)


def test_a_map_that_follows_a_run_ends_with_the_content_of_its_file(run):
    deadline = time.monotonic() + 20
    expected = mc.ArchiveMap(run.path)
    while run.followed._archive["generation"] < 3 and time.monotonic() < deadline:
        time.sleep(0.05)
    assert run.followed._archive == expected._archive
    assert run.followed._contents.streams == expected._contents.streams


def test_a_selection_names_creatures_and_loses_cells_that_are_gone(run):
    shown = mc.ArchiveMap(run.path)
    cells = shown._archive["cell"]
    shown.selected = [cells[-1], cells[0]]
    names = shown._archive["creature"]
    assert shown.creatures == [names[-1], names[0]]
    shown.show(run.spec)
    assert shown.selected == []
    assert shown._archive["cell"] == []


def test_only_the_fittest_swim_on_a_large_map():
    document = {"cell": list(range(1000)), "fitness": list(range(1000))}
    assert contents.fittest(document) == list(range(999, 999 - contents.MOST, -1))


def test_a_run_without_an_archive_is_refused():
    with pytest.raises(ValueError, match="an archive is needed, as searches have; got 'gaits'"):
        mc.ArchiveMap(mc.parse({"experiment": "gaits"}))


def test_a_batch_that_ends_within_a_stream_is_refused(run):
    batch = mc.ArchiveMap(run.path)._poses
    with pytest.raises(ValueError, match=f"bytes or more, got {len(batch) - 1:,}"):
        poses.unbatched(batch[:-1])


def test_a_player_takes_poses_replays_and_creature_files(run):
    stream = mc.pose_streams(run.path)[0]
    player = mc.Player(stream)
    assert player._creature == stream.creature
    assert poses.unbatched(player._poses) == [stream.encode()]
    best = json.loads(run.path.with_suffix(".best.json").read_bytes())
    replay = mc.Player(best)._replay
    assert (
        mc.Player(replay)._replay == replay == mc.Player(SimpleNamespace(data=replay))._replay
    )
    with pytest.raises(
        ValueError, match="a creature file, a replay or a pose stream is needed"
    ):
        mc.Player(1)


class Server:
    """A server that knows one archive, and a run that ends after its second state."""

    def __init__(self, path: Path):
        self.content = contents.of_file(path)
        self.asked: list[str] = []

    def read(self, path, **_):
        self.asked.append(path)
        return self.content.document() | {"coverage": 0.5}

    def ask(self, _method, path, params):
        self.asked.append(path)
        cells = map(int, params["cells"].split(","))
        streams = self.content.pose_streams(list(cells))
        return SimpleNamespace(content=poses.batch(streams.values()))


def test_a_live_map_of_a_server_fills_and_tells_the_end(run, monkeypatch):
    server = Server(run.path)

    def archive():
        return Archive(server, "run", server.read("archive") | {"trusted": []})

    record = {"status": "running", "generation": 1, "generations": 3, "id": "run"}
    states = [record, record | {"status": "finished", "generation": 3}]
    monkeypatch.setattr(
        "microcosmos.client.polling.follow",
        lambda *_: (
            SimpleNamespace(record=one, problem=None, ended=one["status"] == "finished")
            for one in states
        ),
    )
    of_server = SimpleNamespace(
        archive=archive, spec=TINY, id="run", experiment="quality-diversity"
    )
    shown = live(of_server, server, colour="speed")
    deadline = time.monotonic() + 20
    while "finished" not in shown.status and time.monotonic() < deadline:
        time.sleep(0.02)
    assert shown.status == "finished · 3/3 generations"
    assert shown.colour == "speed"
    expected = mc.ArchiveMap(run.path)
    assert shown._archive["creature"] == expected._archive["creature"]
    assert shown._poses == expected._poses
