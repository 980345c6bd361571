"""Figures show the numbers of their rows, and mark what is not sound."""

import itertools

import numpy as np
import pytest

from microcosmos import spec
from microcosmos.archive import file
from microcosmos.viz.figures import experiments, folding

pytestmark = pytest.mark.long

VISCOSITIES = [0.001, 0.01, 0.1, 2.0]
NODES = [1000, 4000, 16000, 64000]


def displacement(swimmer, viscosity):
    return {"worm": 2.0, "ray": 0.4}[swimmer] / (1 + viscosity)


@pytest.fixture
def rows():
    """A sweep in three forms; in the paper's a worm fails, in ours a ray meets a limit."""
    found = []
    for form, swimmer, viscosity in itertools.product(
        ("paper", "ours", "strong"), ("worm", "ray"), reversed(VISCOSITIES)
    ):
        fails = (form, swimmer, viscosity) == ("paper", "worm", 0.001)
        limited = (form, swimmer, viscosity) == ("ours", "ray", 2.0)
        row = {"form": form, "swimmer": swimmer, "viscosity": viscosity}
        row |= {"limited": 0.25 if limited else 0.0, "force_free": form != "paper"}
        row |= {"status": "diverged", "displacement": None, "reynolds": None}
        if not fails:
            reynolds = {"worm": 3.1, "ray": 6.2}[swimmer] / viscosity
            far = displacement(swimmer, viscosity)
            row |= {"status": "ok", "displacement": far, "reynolds": reynolds}
        found.append(row)
    return found


@pytest.fixture
def timings():
    """A run that is linear beside a fluid of 6 s, and all pairs of which two are known."""
    whole = ("method", "nodes", "seconds", "memory_bytes")
    names = (*whole, "fluid", "coupling", "constraints", "steric")
    rows = [
        ("microcosmos", n, 6 + n / 1000, 2**26 + 1000 * n, 6.0, n / 2000, n / 4000, n / 4000)
        for n in NODES
    ]
    rows += [("all-pairs", n, 1e-6 * n**2, 8 * n**2, *[None] * 4) for n in NODES[:2]]
    return [dict(zip(names, row, strict=True)) for row in rows]


def line(panel, label):
    (found,) = [line for line in panel.get_lines() if line.get_label() == label]
    return found


def panels(figure):
    return {panel.get_title(): panel for panel in figure.axes}


def test_each_line_of_a_sweep_has_the_numbers_of_its_rows(rows):
    found = panels(experiments.sweep(rows))
    assert list(found) == [
        "Ours",
        "Ours, unlimited strength",
        "The paper’s literal form (not force-free)",
    ]
    for title, panel in found.items():
        assert panel.get_xscale() == "log"
        for swimmer in ("worm", "ray"):
            x, y = line(panel, swimmer).get_data()
            np.testing.assert_array_equal(x, VISCOSITIES)
            expected = [displacement(swimmer, nu) for nu in VISCOSITIES]
            if swimmer == "worm" and "paper" in title:
                expected[0] = np.nan
            np.testing.assert_array_equal(np.array(y, float), expected)


def test_a_limit_and_a_failure_are_marked_where_they_were(rows):
    found = panels(experiments.sweep(rows))
    ours, _, paper = found.values()
    x, y = line(ours, "_ray, limited").get_data()
    assert (list(x), list(y)) == ([2.0], [displacement("ray", 2.0)])
    assert list(line(paper, "_worm, unfinished").get_xdata()) == [0.001]
    for panel, label in ((paper, "_ray, limited"), (ours, "_worm, unfinished")):
        assert len(line(panel, label).get_xdata()) == 0


def test_the_lines_of_a_scaling_run_have_the_numbers_of_its_rows(timings):
    summary = {"exponent": 1.0, "exponent_all_pairs": 2.0, "peak_memory_bytes": 2**27}
    time, memory = experiments.scaling(timings[::-1], summary).axes
    for panel in (time, memory):
        assert (panel.get_xscale(), panel.get_yscale()) == ("log", "log")
    for label, expected in (
        ("Microcosmos (the nodes’ part ∝ n$^{1.00}$)", [6 + n / 1000 for n in NODES]),
        ("fluid", [6.0] * 4),
        ("interpolation and spreading", [n / 2000 for n in NODES]),
    ):
        x, y = line(time, label).get_data()
        np.testing.assert_array_equal(x, NODES)
        np.testing.assert_allclose(y, expected)
    x, y = line(time, "all pairs (∝ n$^{2.00}$)").get_data()
    np.testing.assert_allclose(y, 1e-6 * np.array(NODES[:2]) ** 2)
    np.testing.assert_allclose(line(memory, "all pairs").get_ydata(), [8e6, 1.28e8])
    assert memory.yaxis.get_major_formatter()(2**29) == "537 MB"


def test_names_of_folded_pictures_stand_as_they_are_written(monkeypatch):
    names = ["$a^$", "_hidden"]
    packed = {"kind": "picture", "width": 2, "height": 2, "pixels": "/wAA/w=="}
    chosen = spec.parse(
        {"experiment": "folding", "targets": [packed | {"name": n} for n in names]}
    )
    size, nodes = (
        (chosen.world.width, chosen.world.height),
        len(spec.shape(chosen.body).positions),
    )
    courses = np.zeros((2, len(folding.MOMENTS), nodes, 2))
    monkeypatch.setattr(folding, "_courses", lambda *_: courses)
    folds = {"genes": np.zeros((2, 1)), "picture": np.zeros((2, *size)), "loss": np.ones(2)}
    tree = {"folds": folds, "curves": {"loss": np.ones((3, 2))}}
    attributes = {"format": file.FORMAT, "spec": chosen.model_dump_json()}
    figure = folding.folds(file.dump(tree, attributes))
    figure.canvas.draw()  # As mathematics, the first would be an error.
    titles = [panel.title for panel in figure.axes if panel.get_title()]
    labels = figure.axes[-1].get_legend().get_texts()
    assert [one.get_text().strip("\u200b") for one in labels] == names
    assert [one.get_text().split(":")[0].strip("\u200b") for one in titles] == names
    assert not any(one.get_parse_math() for one in (*titles, *labels))


@pytest.mark.parametrize(
    ("draw", "lacking"), [(experiments.sweep, "form"), (experiments.scaling, "method")]
)
def test_rows_that_lack_a_number_are_refused(draw, lacking):
    with pytest.raises(ValueError, match="`rows` must have at least one row"):
        draw([])
    with pytest.raises(ValueError, match=f"`rows` must have {lacking}, .*; row 0 does not"):
        draw([{"anything": 1}])
