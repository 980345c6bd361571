"""Networks as SVG, DOT, NumPy code and formulas, from the library and the command line."""

import json
import re
import subprocess
import sys
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest
from typer.testing import CliRunner

from microcosmos import networks
from microcosmos.archive import creature
from microcosmos.cli import app
from microcosmos.naming import encode
from microcosmos.viz import networks as pictures

pytestmark = pytest.mark.fast

INPUTS, OUTPUTS = ("position", "sine", "cosine"), ("rest_angle", "rest_length")
SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture
def small():
    """tanh of a sine of the position; one connection is disabled."""
    genes = {
        "nodes": {
            "id": [0, 1, 2, 3, 4, 9],
            "activation": ["identity"] * 3 + ["tanh", "identity", "sin"],
            "bias": encode(np.array([0, 0, 0, 0.5, -1, 2])),
        },
        "connections": {
            "innovation": [0, 4, 7, 8],
            "source": [0, 1, 9, 2],
            "target": [9, 4, 3, 3],
            "enabled": [True, True, True, False],
            "weight": encode(np.array([1, -2, 0.25, 3])),
        },
    }
    return networks.from_genes(genes, INPUTS, OUTPUTS)


def test_code_computes_what_the_network_does_with_numpy_alone(small, tmp_path):
    module = tmp_path / "found.py"
    module.write_text(networks.numpy_code(small))
    program = (
        f"import sys; sys.path[:0] = {[np.__path__[0] + '/..']}\n"
        "import found, numpy as np\n"
        "print(repr(found.network(np.array([0.3, -1.0, 7.0])).tolist()))\n"
        "assert not any(name.startswith(('jax', 'microcosmos')) for name in sys.modules)\n"
    )
    command = [sys.executable, "-S", "-c", program]
    printed = subprocess.check_output(command, cwd=tmp_path, text=True)
    expected = [np.tanh(0.5 + 0.25 * np.sin(2 + 0.3)), -1 + 2]
    np.testing.assert_allclose(eval(printed), expected, rtol=1e-15)


def test_code_of_every_genome_and_creature_is_checked(reference, grown):
    """`numpy_code` carries the code out and raises where a value differs by 1e-12."""
    for nodes, conns in zip(reference.nodes[:60], reference.conns[:60], strict=True):
        networks.numpy_code(networks.read_tensorneat(nodes, conns, reference.meta))
    for genes in grown[:60]:
        networks.numpy_code(networks.from_genes(genes, INPUTS, OUTPUTS))


def test_names_cannot_end_the_text_they_stand_in(small):
    name = 'x"""\nimport os\nos.abort()\n"""<b>'
    spoiled = replace(small, input_names=(name, "b", "c"))
    networks.numpy_code(spoiled)
    ElementTree.fromstring(pictures.svg(spoiled))
    assert "<b>" not in pictures.svg(spoiled)


def test_a_formula_has_a_line_for_each_node_in_order(small):
    assert networks.formula(small) == (
        "rest_length = −1 − 2·sine\nn9 = sin(2 + position)\nrest_angle = tanh(0.5 + 0.25·n9)\n"
    )


def test_a_picture_draws_every_node_and_enabled_connection_with_names(small):
    picture = ElementTree.fromstring(pictures.svg(small))
    assert len(picture.findall(f"{SVG}g[@class='node']")) == 6
    links = picture.findall(f"{SVG}path[{SVG}title]")
    width = {path.findtext(f"{SVG}title"): float(path.get("stroke-width")) for path in links}
    assert sorted(width, key=width.get) == [
        "node 9 → rest_angle: weight 0.25",
        "position → node 9: weight 1",
        "sine → rest_length: weight -2",
    ]
    assert len(set(width.values())) == 3
    words = {text.text for text in picture.iter(f"{SVG}text")}
    assert {*INPUTS, *OUTPUTS, "sin", "tanh"} <= words
    title = "A network with 3 inputs, 2 outputs, 1 hidden node and 3 connections"
    assert picture.findtext(f"{SVG}title") == title


def test_positions_hold_disabled_connections_and_cycles():
    """Nodes 3, 4 and 5 are a cycle; a disabled connection leads to 6."""
    links = {"source": [0, 3, 4, 5, 5, 0, 6], "target": [3, 4, 5, 3, 1, 6, 2]}
    links["enabled"] = [True] * 5 + [False, True]
    genome = {"inputs": ["a"], "outputs": ["b", "c"], "nodes": {"id": [*range(7)]}}
    found = pictures.positions({"genome": genome | {"connections": links}})
    column = {int(key): point.x for key, point in found.nodes.items()}
    assert column == {0: 0, 1: 4, 2: 4, 3: 1, 4: 2, 5: 3, 6: 1}
    assert {pair: [point.x for point in way] for pair, way in found.passages.items()} == {
        "6-2": [2, 3]
    }
    heights = [point.y for point in (*found.nodes.values(), *found.passages["6-2"])]
    assert (found.width, found.height, min(heights)) == (4, max(heights), 0)


def test_genes_without_a_network_have_no_positions():
    with pytest.raises(ValueError, match="must hold a network, got 'gait'"):
        pictures.positions({"genome": {"encoding": "gait"}})


def test_graphviz_gets_every_node_and_connection(small):
    text = pictures.dot(small)
    assert re.findall(r"(\d+) -> (\d+)", text) == [("0", "9"), ("1", "4"), ("9", "3")]
    assert len(re.findall(r"^  \d+ \[", text, re.M)) == 6
    assert 'label="rest_angle\\ntanh"' in text


@pytest.fixture
def file(tmp_path, grown):
    genome = {
        "encoding": "cppn",
        "inputs": INPUTS,
        "outputs": OUTPUTS,
        "control": {"wave_number": None},
    } | grown[7]
    parts = {"world": {"coupling": {}}, "body": {}, "task": {}}
    whole = {"format": "microcosmos-creature/1", "genome": genome, **parts}
    identity = creature.Identity.model_validate(whole).model_dump(mode="json")
    path = tmp_path / "creature.json"
    path.write_text(json.dumps(creature.document(identity, None, None)))
    return path


def carried_out(*arguments):
    return CliRunner().invoke(app, ["network", *map(str, arguments)])


def test_a_creature_s_network_in_every_form(file, grown, tmp_path):
    network = networks.from_genes(grown[7], INPUTS, OUTPUTS)
    assert carried_out(file).stdout == networks.formula(network)
    assert carried_out(file, "--as", "dot").stdout == pictures.dot(network)
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


def test_a_malformed_command_is_refused(file, tmp_path):
    spoiled = tmp_path / "spoiled.npz"
    spoiled.write_bytes(b"PK nothing")
    forms = "--as must be one of formula, svg, dot, python, tensorneat; got png"
    for path, form, words in (
        (file, "png", forms),
        (spoiled, "svg", "must be a NumPy archive"),
    ):
        done = carried_out(path, "--as", form)
        assert done.exit_code == 2
        assert words in done.stderr.replace("\n", " ")
