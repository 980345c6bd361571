"""The contact sheet shows the fittest of each region where it belongs, at one scale."""

import numpy as np
import pytest

from microcosmos.viz.figures import style
from microcosmos.viz.figures.sheet import Motion, layout, numerals, reading_order, sheet

pytestmark = pytest.mark.long


@pytest.fixture
def found(made):
    """Three elites in the lower left, of which the second is fittest, and one far away."""
    places = [(1e-4, 0.0), (2e-4, 0.1), (3e-4, 0.05), (90.0, 0.95)]
    return made(
        [
            {"cell": k, "fitness": f, "bending_effort": x, "straightness": y}
            for k, ((x, y), f) in enumerate(zip(places, (1.0, 3.0, 2.0, 0.5), strict=True))
        ]
    )


def swimming(length, frames=9):
    """A straight body of so many cells that goes up by a cell a frame."""
    x = np.linspace(0, length, 5)
    y = np.arange(frames)[:, None] * np.ones(5)
    places = np.stack([np.broadcast_to(x, y.shape), y], -1).astype(np.float32)
    return Motion(places, np.stack([np.arange(4), np.arange(1, 5)], 1))


def test_the_fittest_of_each_region_is_shown_where_it_belongs(found):
    plan = layout(found, columns=3, rows=2)
    assert [(r.column, r.row, r.elite) for r in plan.regions] == [(0, 0, 1), (2, 1, 3)]
    assert reading_order(plan.regions) == [1, 0]


def test_all_bodies_are_drawn_at_one_scale_inside_their_regions(found):
    plan, motions = layout(found, columns=3, rows=2), [swimming(20.0), swimming(5.0)]
    with style.styled():
        panel = sheet(found, plan, motions, moments=3).axes[0]
    spans = []
    for lines in panel.collections:
        x = np.concatenate(lines.get_segments())[:, 0]
        spans.append((np.floor(x.min()), np.floor(x.max()), np.ptp(x)))
    first, second = spans[:4], spans[4:]
    assert {(a, b) for a, b, _ in first} == {(0, 0)}
    assert {(a, b) for a, b, _ in second} == {(2, 2)}
    np.testing.assert_allclose([span for *_, span in first], 0.8)
    np.testing.assert_allclose([span for *_, span in second], 0.2)


def test_gaits_are_numbered_as_in_the_paper():
    assert numerals(10) == ["i", "ii", "iii", "iv", "v", "vi", "vii", "viii", "ix", "x"]
    assert [numerals(99)[k - 1] for k in (14, 40, 49, 90, 99)] == [
        "xiv", "xl", "xlix", "xc", "xcix",
    ]  # fmt: skip


def test_a_sheet_over_one_axis_is_refused(found):
    with pytest.raises(ValueError, match="`axes` must be two"):
        layout(found, axes=["straightness"])
    with pytest.raises(ValueError, match="`rows` must be from 1 to 20, got 0"):
        layout(found, rows=0)
