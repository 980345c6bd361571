"""Figures are drawn of a real run's file, by the library and by the command line."""

import re
from functools import partial

import numpy as np
import pytest
from small_spec import SMALL_SCENE

from microcosmos import spec
from microcosmos.archive import variety
from microcosmos.build import local
from microcosmos.experiments import table_file
from microcosmos.viz.figures import drawing, reading, sheet, strips

pytestmark = pytest.mark.long

BINS = {"bending_effort": 6, "stretching_effort": 6, "straightness": 2}
TINY = SMALL_SCENE | {
    "archive": {"descriptors": [{"name": n, "bins": b} for n, b in BINS.items()]},
    "search": {"generations": 3, "batch": 16, "block": 8},
}
"""Evaluated by the program that tests of experiments have compiled."""


@pytest.fixture(scope="module")
def archive(tmp_path_factory):
    path = tmp_path_factory.mktemp("run") / "tiny.h5"
    assert local.evolve(spec.parse(TINY), path)
    return path


@pytest.fixture
def figure(invoke):
    return partial(invoke, "figure")


def test_elites_of_a_file_are_simulated_as_they_were_measured(archive):
    found = reading.read(archive.read_bytes())
    cell = int(found.cells[found.best])
    (motion,) = sheet.motions(archive.read_bytes(), [cell], {})
    ends = motion.positions[[0, -1]].mean(1)
    np.testing.assert_allclose(np.hypot(*(ends[1] - ends[0])), found.fitness.max(), rtol=1e-3)


def test_a_sheet_is_drawn_and_reports_progress(archive, tmp_path):
    progress = []
    how, out = drawing.Print(), tmp_path / "sheet.svg"
    drawing.contact(out, how, archive, None, (2, 2), 3, lambda *done: progress.append(done))
    assert progress == [(k + 1, len(progress)) for k in range(len(progress))]
    text = (tmp_path / "sheet.caption.txt").read_text()
    assert f"each of {len(progress)} regions" in text
    assert "at 3 moments of its 60 steps" in text


def test_the_fittest_of_each_kind_of_motion_is_shown(archive):
    data = archive.read_bytes()
    found, shown = reading.read(data), strips.exemplars([data], 100)
    assert len(shown) == variety.of(data).kinds
    fitness = [one.fitness for one in shown]
    assert fitness[0] == found.fitness.max()
    assert np.all(np.diff(fitness) <= 0)
    assert [one.fitness for one in strips.exemplars([data], 1)] == fitness[:1]


def test_kinds_are_those_of_all_seeds_of_a_spec(archive, tmp_path, figure):
    other, out = tmp_path / "other.h5", tmp_path / "kinds.svg"
    assert local.evolve(spec.parse(TINY | {"seed": 1}), other)
    figure("kinds", archive, other, out, "--limit", "100")
    text = out.with_suffix(".caption.txt").read_text()
    elites = sum(len(reading.read(file.read_bytes()).cells) for file in (archive, other))
    assert f"among {elites} elites of 2 runs" in text
    assert "seeds 0, 1" in text
    alone = strips.exemplars([archive.read_bytes()], 100)
    files = [file.read_bytes() for file in (archive, other)]
    assert strips.exemplars(files, 100)[0].fitness >= alone[0].fitness
    world = spec.parse(TINY).model_dump(mode="json")["world"]
    thick = tmp_path / "thick.h5"
    assert local.evolve(spec.parse(TINY | {"world": world | {"viscosity": 0.3}}), thick)
    refused = figure("kinds", archive, thick, out, code=2)
    assert "must differ in the seed alone" in refused


def test_each_command_of_the_help_writes_its_figure_and_its_caption(archive, tmp_path, figure):
    for name, *options in (
        ("archive", "--axes", "straightness,bending_effort", "--latex", "--caption"),
        ("curves", "--against", "generations"),
        ("kinds", "--limit", "3", "--moments", "5"),
        ("lineage", "--palette", "magma"),
    ):
        out = tmp_path / f"{name}.pdf"
        assert str(out) in figure(name, archive, out, *options)
        assert out.read_bytes().startswith(b"%PDF")
        text = out.with_suffix(".caption.txt").read_text()
        assert "3 generations of 16 (48 evaluations, seed 0)" in text
    assert (tmp_path / "archive.caption.tex").exists()
    text = figure("--help")
    for name in ("file", "archive", "curves", "sheet", "kinds", "lineage"):
        assert re.search(rf"\b{name}\b", text)


def test_mistakes_are_refused_with_the_need(archive, tmp_path, figure):
    assert "must end in .pdf" in figure("archive", archive, tmp_path / "map.bmp", code=2)
    cell = ("--cell", "9999")
    assert "`cell` must be one of" in figure(
        "lineage", archive, tmp_path / "a.svg", *cell, code=2
    )
    assert "seed 0 twice" in figure("curves", archive, archive, tmp_path / "a.svg", code=2)
    assert "FILE... OUT needs" in figure("curves", archive, code=2)
    broken = tmp_path / "broken.h5"
    broken.write_bytes(b"nothing")
    assert "must be HDF5" in figure("archive", broken, tmp_path / "a.svg", code=2)


def test_a_file_whose_run_has_a_table_has_no_map(tmp_path):
    path = tmp_path / "table.h5"
    rows = table_file.Table(0, (), ("cpu",))
    path.write_bytes(table_file.save('{"experiment": "gaits"}', rows))
    with pytest.raises(ValueError, match=r"an archive is needed.*table of 'gaits'"):
        drawing.open_archive(path)
