"""Renderings, with an engine that only records its calls."""

import json
import sys
from types import SimpleNamespace

import numpy as np
import pytest
import reports

from microcosmos.archive import creature
from microcosmos_server.creatures import storage as creatures
from microcosmos_server.renderings import storage as renderings
from microcosmos_server.tables import (
    AUDIT,
    EVALUATION,
    GIF,
    MEASUREMENT,
    MP4,
    PREVIEW,
    REPLAY,
    STRIP,
)
from microcosmos_worker.renderings import make


def replay() -> bytes:
    """Three nodes that move to the right over still fluid."""
    time, node = np.arange(7)[:, None], np.arange(3)[None]
    return reports.replay(
        np.stack(np.broadcast_arrays(8.0 + time + node, 8.0), -1),
        planes=1 + 2,  # Vorticity and velocity.
        creature="ab" * 32,
        joints=[[0, 1]],
        size=[24, 16],
        velocity={"scale": 0.1},
        energy={"scale": 1.0, "frames": 0},
        fitness={"recorded": None, "replayed": 1.0, "difference": None},
        device="a device",
    )


@pytest.fixture
def known(services):
    file = creature.parse(creature.document(reports.identity(), None, None))
    with services.sessions.write.begin() as session:
        creatures.import_files(session, file)
    return file["sha256"]


@pytest.fixture
def asked(monkeypatch):
    """The calls of the engine, in order."""
    calls = []

    def answer(name, result):
        return lambda file: calls.append((name, file["sha256"])) or result

    engine = {
        "viz.replay": {"record": answer("record", replay())},
        "audit": {
            "audit": answer("audit", {"verdict": {"trusted": True, "reasons": []}}),
            "measurement": answer("measurement", {"exact": True}),
            "evaluation_inputs": answer("inputs", b"inputs"),
        },
    }
    for module, functions in engine.items():
        monkeypatch.setitem(sys.modules, f"microcosmos.{module}", SimpleNamespace(**functions))
    return calls


@pytest.mark.parametrize(
    ("kind", "start"),
    [(STRIP, b"\x89PNG"), (PREVIEW, b"\x89PNG"), (GIF, b"GIF89a"), (MP4, b"\x00\x00\x00 ftyp")],
)
def test_films_and_pictures_are_drawn_from_the_stored_replay(
    services, known, asked, kind, start
):
    assert make(services, known, kind).startswith(start)
    assert asked == [("record", known)]
    assert renderings.existing(services, known, REPLAY) == replay()
    make(services, known, kind)
    assert asked == [("record", known)], "the second one needs no simulation"


def test_a_damaged_replay_is_made_again_for_a_film(services, known, asked):
    renderings.save(services, known, REPLAY, replay())
    with services.sessions.read() as session:
        path = renderings.find(session, known, REPLAY).path
    services.artifacts.write(path, b"damaged")
    assert make(services, known, GIF).startswith(b"GIF89a")
    assert asked == [("record", known)]


def test_inputs_of_an_evaluation_are_bytes(services, known, asked):
    assert make(services, known, EVALUATION) == b"inputs"
    assert asked == [("inputs", known)]


def test_audits_and_measurements_are_json_and_other_kinds_refused(services, known, asked):
    with pytest.raises(ValueError, match="`kind` of a rendering must be one of replay, audit"):
        make(services, known, "film.avi")
    assert asked == []
    document = json.loads(make(services, known, AUDIT))
    assert document["verdict"] == {"trusted": True, "reasons": []}
    assert json.loads(make(services, known, MEASUREMENT)) == {"exact": True}
    assert asked == [("audit", known), ("measurement", known)]
