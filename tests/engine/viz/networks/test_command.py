"""`microcosmos network` on creature files and genomes."""

import json
from xml.etree import ElementTree

import numpy as np
import pytest
from typer.testing import CliRunner

from microcosmos.archive import creature
from microcosmos.cli import app
from microcosmos.viz import networks

pytestmark = pytest.mark.fast

INPUTS, OUTPUTS = ["position", "sine", "cosine"], ["rest_angle", "rest_length"]


@pytest.fixture
def file(tmp_path, grown):
    """A creature file with grown genes."""
    parts = {"encoding": "cppn", "inputs": INPUTS, "outputs": OUTPUTS, "control": {}}
    whole = {
        "format": "microcosmos-creature/1",
        "genome": parts | grown[7],
        "world": {"coupling": {}},
        "body": {},
        "task": {},
    }
    found = creature.Identity.model_validate(whole).model_dump(mode="json")
    path = tmp_path / "creature.json"
    path.write_text(json.dumps(creature.document(found, None, None)))
    return path


def carried_out(*arguments):
    return CliRunner().invoke(app, ["network", *map(str, arguments)])


def test_a_creature_s_network_in_every_form(file, grown, tmp_path):
    network = networks.from_genes(grown[7], INPUTS, OUTPUTS)
    assert carried_out(file).stdout == networks.formula(network)
    assert carried_out(file, "--as", "dot").stdout == networks.dot(network)
    assert carried_out(file, "--as", "python").stdout == networks.numpy_code(network)
    picture = tmp_path / "network.svg"
    assert carried_out(file, "--as", "svg", "--out", picture).exit_code == 0
    assert ElementTree.parse(picture).getroot().get("class") == "network"


def test_a_genome_goes_out_and_is_read_again(file, grown, tmp_path):
    out = tmp_path / "genome.npz"
    assert carried_out(file, "--as", "tensorneat", "--out", out).exit_code == 0
    network, fitness = networks.load_tensorneat(out.read_bytes())
    assert np.isnan(fitness)
    inputs = networks.probes(3)
    own = networks.from_genes(grown[7], INPUTS, OUTPUTS)
    assert networks.agree(networks.evaluate(own, inputs), networks.evaluate(network, inputs))
    assert "rest_angle = " in carried_out(out, "--as", "formula").stdout


def test_what_cannot_be_is_said(file, tmp_path):
    spoiled = tmp_path / "spoiled.npz"
    spoiled.write_bytes(b"PK nothing")
    for arguments, words in (
        (
            (file, "--as", "png"),
            "--as must be one of formula, svg, dot, python, tensorneat; got png",
        ),
        ((spoiled, "--as", "svg"), "must be a NumPy archive"),
    ):
        came = carried_out(*arguments)
        assert came.exit_code == 2
        assert words in came.stderr.replace("\n", " ")
