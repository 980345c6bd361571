"""Figures are the same bytes every time, in letters that journals take, with a caption."""

import re
import time

import numpy as np
import pytest

from microcosmos.viz.figures import caption, maps, saving, style
from microcosmos.viz.figures.saving import latex

pytestmark = pytest.mark.long


@pytest.fixture
def found(made):
    elites = [{"cell": cell, "fitness": cell / 2} for cell in (0, 3, 9, 17)]
    return made(elites, seed=4, world={"width": 48, "height": 48, "viscosity": 0.2})


def drawn(found, suffix, monkeypatch, when, **options):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", str(when))
    with style.styled():
        figure = maps.archive(found)
        return saving.encoded(
            figure, suffix, caption=caption.of_archive(found, None), **options
        )


@pytest.mark.parametrize("suffix", [".pdf", ".svg", ".png"])
def test_the_same_archive_gives_the_same_bytes_at_any_time(found, suffix, monkeypatch):
    first = drawn(found, suffix, monkeypatch, 0)
    monkeypatch.delenv("SOURCE_DATE_EPOCH")
    monkeypatch.setattr(time, "time", lambda: 2e9)
    assert drawn(found, suffix, monkeypatch, 10**9) == first


def test_a_pdf_has_truetype_letters_and_its_caption(found, monkeypatch):
    data = drawn(found, ".pdf", monkeypatch, 0)
    assert b"/FontFile2" in data
    assert b"/Type3" not in data
    assert b"/CreationDate" not in data
    assert b"Archive of 4 elites" in data or "Archive of 4".encode("utf-16-be") in data


def test_width_is_that_of_a_column(found):
    for width, inches in (("single", 85 / 25.4), ("double", 178 / 25.4), ("3.5in", 3.5)):
        size = maps.archive(found, width=style.millimetres(width)).get_size_inches()
        np.testing.assert_allclose(size[0], inches)
    for wrong in ("broad", "4", "2000mm", "..mm"):
        with pytest.raises(ValueError, match="`width` must be single"):
            style.millimetres(wrong)


def test_a_caption_states_the_spec(found):
    told = caption.of_archive(found, None)
    for part in (
        "4 elites in 20 cells (20.0 %)",
        "the fittest (8.5)",
        "bending effort [rad²] and straightness",
        "MAP-Elites (emitter neat), 2 generations of 64 (32 evaluations, seed 4)",
        "displacement of the mean node over 500 steps",
        "a filament of 32 nodes, controlled by a CPPN (period 100 steps)",
        "48 × 48 cells, ν = 0.2 cells²/step",
        "Microcosmos 0.1.0 on cpu, A Model avx2.",
    ):
        assert part in told


def test_a_form_that_is_not_force_free_is_said_to_be(made):
    paper = {"projection": "none", "theta_feedback": 0}
    told = caption.of_archive(made([{"cell": 0, "fitness": 1.0}], coupling=paper), None)
    assert "(coupling not force-free)" in told


def test_latex_escapes_every_letter_that_means_something():
    told = latex("64.8 % of 3 × 4 & x_1^2 #5 {ν} \\ ~ $ cells²")
    assert told == (
        r"64.8\,\% of 3 $\times$ 4 \& x\_1\textasciicircum{}2 \#5 \{$\nu$\} "
        r"\textbackslash{} \textasciitilde{} \$ cells$^2$"
    )
    assert not re.search(r"(?<!\\)[%&#_]", told)


def test_a_published_figure_has_its_caption_beside_it_and_below(found, tmp_path):
    told = caption.of_archive(found, None)
    with style.styled():
        figure = maps.archive(found)
        high = figure.get_size_inches()[1]
        written = saving.publish(figure, tmp_path / "map.svg", told, under=True, tex=True)
    assert [path.name for path in written] == ["map.svg", "map.caption.txt", "map.caption.tex"]
    assert written[1].read_text() == told + "\n"
    assert r"$\nu$ = 0.2" in written[2].read_text()
    assert figure.get_size_inches()[1] > high
    assert "Archive of 4 elites" in written[0].read_text()
    with pytest.raises(ValueError, match=r"must end in \.pdf"):
        saving.publish(figure, tmp_path / "map.bmp", told)
