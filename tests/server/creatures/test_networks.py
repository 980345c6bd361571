"""Networks of creatures as SVG, Graphviz, Python and TensorNEAT."""

import io
import re
import time
from xml.etree import ElementTree

import numpy as np
import pytest
from answers import detail

from microcosmos import naming
from microcosmos_server.creatures.sandbox import Sandbox
from microcosmos_server.creatures.sandbox_process import CPU_SECONDS
from microcosmos_server.tables import Creature

TYPES = {
    "json": "application/json",
    "svg": "image/svg+xml",
    "dot": "text/vnd.graphviz; charset=utf-8",
    "py": "text/x-python; charset=utf-8",
    "npz": "application/octet-stream",
}


@pytest.fixture
def known(upload, identity):
    def upload_changed(change=lambda identity: None) -> str:
        found = identity(2)
        change(found)
        return upload(found)

    return upload_changed


@pytest.mark.parametrize("form", TYPES)
def test_each_form_has_a_tag_under_a_file_name(api, known, form):
    sha = known()
    answer = api.get(f"creatures/{sha}/network.{form}")
    assert (answer.status_code, answer.headers["content-type"]) == (200, TYPES[form])
    kept = {"If-None-Match": answer.headers["etag"]}
    assert api.get(f"creatures/{sha}/network.{form}", headers=kept).status_code == 304
    assert f"network-{sha[:12]}.{form}" in answer.headers["content-disposition"]


def test_the_forms_hold_the_network(api, known):
    sha = known()
    placed = api.get(f"creatures/{sha}/network.json").json()
    assert placed["nodes"]["5"]["x"] == placed["width"] == 1
    picture = ElementTree.fromstring(api.get(f"creatures/{sha}/network.svg").text)
    assert picture.tag == "{http://www.w3.org/2000/svg}svg"
    assert re.search(r"1 -> 5", api.get(f"creatures/{sha}/network.dot").text)
    space = {}
    exec(api.get(f"creatures/{sha}/network.py").text, space)
    given = np.array([[0.3], [0.25], [0.7], [0.1], [0.2]])
    np.testing.assert_allclose(space["network"](given), [[0.5], [0.0]])
    data = api.get(f"creatures/{sha}/network.npz").content
    with np.load(io.BytesIO(data)) as genome:
        assert {"nodes", "conns"} <= set(genome.files)


def cycle(identity):
    genome = identity["genome"]
    genome["control"]["recurrent"] = True
    genome["connections"] |= {
        "innovation": [0, 1],
        "source": [1, 5],
        "target": [5, 5],
        "enabled": [True, True],
        "weight": "AAAAPwAAAD8=",  # 0.5 twice.
    }


def test_the_code_of_a_network_with_very_many_steps_is_written_at_once(api, known):
    """The sandbox verifies the code over a few steps, not over all."""

    def long(identity):
        cycle(identity)
        identity["task"]["steps"] = 1_000_000

    sha = known(long)
    begun = time.monotonic()
    answer = api.get(f"creatures/{sha}/network.py")
    assert "for _ in range(1000000):" in answer.text
    assert time.monotonic() - begun < CPU_SECONDS


@pytest.mark.parametrize("form", TYPES)
def test_a_network_is_written_without_a_connection(api, services, known, form, monkeypatch):
    """A slow network does not hold a connection of the database."""
    # Another creature than in other tests, whose networks the server may keep.
    sha, held = known(lambda identity: identity["task"].update(steps=1111)), []

    def write(self, identity, form):
        held.append(services.sessions.engine.pool.checkedout())
        return b""

    monkeypatch.setattr(Sandbox, "network", write)
    assert api.get(f"creatures/{sha}/network.{form}").status_code == 200
    assert held == [0]


@pytest.mark.parametrize("form", TYPES)
def test_a_creature_without_network_says_so(api, services, form):
    found = {"genome": {"encoding": "gait", "swimmer": "worm"}}
    name, identity = naming.name(found), naming.canonical(found)
    with services.sessions.write.begin() as session:
        session.add(Creature(sha256=name, identity=identity, parents=[], licence="CC0-1.0"))
    assert "'gait'" in detail(api.get(f"creatures/{name}/network.{form}"), 404)
