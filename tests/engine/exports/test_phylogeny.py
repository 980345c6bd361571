"""Phylogenies of archive files are read by DendroPy and follow the ALife standard."""

import dendropy
import numpy as np
import pytest

from microcosmos.exports import run_file
from microcosmos.exports.run_file import RunFile, of_file


@pytest.fixture
def family(made):
    """The second creature is a child of the first, the third of both; the first is lost."""
    parents = np.zeros((3, 2, 32), np.uint8)
    names = np.arange(96, dtype=np.uint8).reshape(3, 32)
    parents[1, 0], parents[2] = names[0], names[:2]
    return RunFile("family", made(parents=parents, generations=(1, 2, 3)))


def test_newick_is_read_by_dendropy_with_every_creature(ran):
    run = RunFile("small", ran.read_bytes())
    text = run_file.written(run, "nwk").decode()
    trees = dendropy.TreeList.get(data=text, schema="newick", suppress_internal_node_taxa=True)
    labels = {
        node.label or node.taxon.label for tree in trees for node in tree.preorder_node_iter()
    }
    assert labels == {bytes(one).hex() for one in run.tree["lineage"]["creature"]}
    times = {}
    for tree in trees:
        for node in tree.preorder_node_iter():
            above = times[node.parent_node] if node.parent_node else 0
            times[node] = above + (node.edge_length or 0)
    found = of_file(run)
    named = {node.label or node.taxon.label: time for node, time in times.items()}
    assert named == dict(zip(found.creature, found.time.tolist(), strict=True))


def test_a_creature_is_lost_when_another_takes_its_cell(made):
    names = np.arange(96, dtype=np.uint8).reshape(3, 32)
    lineage = {
        "creature": names[[0, 1, 2]],
        "parents": np.zeros((3, 2, 32), np.uint8),
        "operator": np.zeros(3, np.int32),
        "generation": np.array([1, 2, 3], np.int32),
        "cell": np.array([1, 1, 6], np.int32),
        "fitness": np.ones(3, np.float32),
        "descriptors": np.zeros((3, 2), np.float32),
    }
    data = made(lineage=lineage)
    found = of_file(RunFile("one", data))
    # All three are in the made archive, but the file says that the first lost its cell.
    assert found.lost.tolist() == [2, -1, -1]


def test_the_phylogeny_of_a_server_takes_precedence(made):
    run = RunFile("one", made(), {"nwk": b"(a:1)b:1;\n"})
    assert run_file.written(run, "nwk") == b"(a:1)b:1;\n"
