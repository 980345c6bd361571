"""Drawings of body plans: nodes by segment, edges, and what has grown."""

from collections import Counter

import numpy as np
import pytest
from plans import FINS, ROOT, plan_identity
from reports import identity

from microcosmos.spec.creature import plan_drawing

pytestmark = pytest.mark.fast


def test_fins_are_mirror_images_of_each_other():
    drawn = plan_drawing(plan_identity(ROOT, FINS))
    assert Counter((node.segment, node.copy) for node in drawn.nodes) == {
        (0, 0): 9,
        (1, 0): 4,
        (1, 1): 4,
    }
    ys = {
        copy: [node.y for node in drawn.nodes if (node.segment, node.copy) == (1, copy)]
        for copy in (0, 1)
    }
    np.testing.assert_allclose(ys[0], [1, 2, 3, 4])
    np.testing.assert_allclose(ys[1], [-1, -2, -3, -4])
    fins = {node.copy: (node.hand, node.side) for node in drawn.nodes if node.segment == 1}
    assert fins == {0: (1, 1), 1: (-1, -1)}
    assert len(drawn.edges) == len(drawn.nodes) - 1


def test_genes_are_in_degrees_and_the_root_has_no_parent():
    root, fins = plan_drawing(plan_identity(ROOT, FINS | {"curl": np.pi / 4})).segments
    assert (root.parent, root.grown, fins.parent, fins.grown) == (None, 1, 0, 2)
    assert (fins.angle, fins.curl, fins.place, fins.mirrored) == (90, 45, 0.5, True)


def test_a_ring_is_closed_by_an_edge_of_its_last_node():
    ring = FINS | {"number": 7, "nodes": 9, "place": 1.0, "angle": 0.0, "mirrored": False}
    drawn = plan_drawing(plan_identity(ROOT, ring | {"closed": True}))
    assert (8, 17) in [tuple(sorted(edge)) for edge in drawn.edges]
    owners = Counter(drawn.nodes[max(edge)].segment for edge in drawn.edges)
    assert owners == {0: 8, 1: 10}
    assert (drawn.segments[1].ring, drawn.segments[1].number) == (True, 7)


def test_genes_without_a_plan_are_refused():
    with pytest.raises(ValueError, match="must hold a plan, got 'cppn'"):
        plan_drawing(identity())
