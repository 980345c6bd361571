"""A search along learned axes: its file says which axes they are, and what they displaced."""

import numpy as np
import pytest

import microcosmos
from microcosmos.archive import file
from microcosmos.spec import parse

pytestmark = pytest.mark.long

EXPERIMENT = "learned"


def names(elites):
    there = np.flatnonzero(elites.occupied)
    return set(zip(elites.generation[there].tolist(), elites.slot[there].tolist(), strict=True))


def test_its_file_and_its_summaries_record_every_epoch(course, experiment):
    states, reports, *_ = course
    tree = file.load(experiment.save(states[-1]))[0]
    held = tree["learned"]
    assert held["generation"].tolist() == [1, 2, 4]
    for i, number in enumerate(held["generation"].tolist()):
        before, after = names(states[number - 1].elites), names(states[number].elites)
        assert (held["before"][i], held["after"][i]) == (len(before), len(after))
        assert held["displaced"][i] == len(before - after)
        summary = reports[number - 1].summary
        assert (summary["epoch"], summary["displaced"]) == (i + 1, len(before - after))
        assert summary["explained_variance"] == pytest.approx(held["explained"][i].sum())
    assert "epoch" not in reports[2].summary
    assert held["explained"].shape == (3, 2)
    assert tree["loop"]["container"]["epoch"] == 3


def test_the_learned_axes_of_a_file_place_its_elites(course, experiment, tmp_path):
    state = course.states[-1]
    path = tmp_path / "archive.h5"
    path.write_bytes(experiment.save(state))
    found = microcosmos.learned_axes(path)
    there = np.asarray(state.elites.occupied)
    assert found.measures == experiment.plan.measures
    assert found.coordinates.shape == (there.sum(), 2)
    expected = np.asarray(state.container.coordinates(state.elites.measures))[there]
    np.testing.assert_allclose(found.coordinates, expected, atol=1e-3)
    place = (found.coordinates - found.ends[:, 0]) / np.diff(found.ends, axis=1)[:, 0]
    cells = np.clip(np.floor(5 * place), 0, 4) @ [5, 1]
    assert len(set(cells.tolist())) == len(cells)
    strongest = found.strongest(0, 3)
    assert [abs(weight) for _, weight in strongest] == sorted(
        np.abs(found.loadings[0]), reverse=True
    )[:3]
    np.testing.assert_allclose(np.sum(found.loadings**2, 1), 1, rtol=1e-5)


def test_files_without_learned_axes_are_refused(course, course_of, experiment):
    grid = course_of("quality-diversity")
    with pytest.raises(ValueError, match=r"`archive.container.kind` must be 'learned', got"):
        microcosmos.learned_axes(grid.experiment.save(grid.states[-1]))
    with pytest.raises(ValueError, match="axes must have been learned"):
        microcosmos.learned_axes(experiment.save(course.states[0]))


@pytest.mark.parametrize(
    ("container", "message"),
    [
        (
            {"measures": ["power"]},
            r"`measures` must be at least as many as `axes` \(2\), got 1",
        ),
        ({"measures": ["power", "power"]}, "`measures` must not repeat"),
        ({"axes": 4, "bins": 64}, "`container` must have at most 1,048,576 places"),
        ({"measures": ["power", "weight"]}, "measures"),
    ],
)
def test_impossible_axes_are_refused(container, message):
    with pytest.raises(ValueError, match=message):
        parse(
            {
                "experiment": "quality-diversity",
                "archive": {"container": {"kind": "learned", **container}},
            }
        )
