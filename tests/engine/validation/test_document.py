"""The document shows every result, failures included."""

import numpy as np
import pytest

from validation import __main__ as program
from validation.paths import JAX, KERNEL
from validation.rows import Line, Plot, Result, Row, at_least, at_most, close, holds
from validation.suite import SECTIONS, Check, Section


def section(found):
    check = Check(lambda: found, "The kernel has no eyes.")
    return Section("A subject", "What is measured.", (check,))


def drag(in_jax, in_kernel):
    """A section with a drag coefficient on both paths."""
    values = {JAX: in_jax, KERNEL: in_kernel}

    def measure(path):
        value = values[path]
        return Result([close("drag", value, 2.05 + 1e-3 * (path == KERNEL), 0.08, "Dennis")])

    return Section("A cylinder", "What resists.", (Check(measure),))


@pytest.mark.fast
@pytest.mark.parametrize(
    ("row", "passed"),
    [
        (at_most("q", 1e-3, 1e-3, "s"), True),
        (at_most("q", 1.1e-3, 1e-3, "s"), False),
        (at_most("q", float("nan"), 1e-3, "s"), False),
        (at_least("q", 0.9, 0.8, 1.0, "s"), True),
        (at_least("q", float("inf"), 0.8, 1.0, "s"), False),
        (close("q", -1.04, -1.0, 0.05, "s"), True),
        (close("q", 1.0, -1.0, 0.05, "s"), False),
        (Row("q", 1.03, 0.95, 1.02, "0.95 to 1.02", 1.0, "s"), False),
        (holds("q", True, "s"), True),
        (holds("q", False, "s"), False),
    ],
    ids=str,
)
def test_a_row_passes_within_its_bar_alone(row, passed):
    assert row.passed is passed


def test_a_missed_bar_is_written_and_fails_the_program(tmp_path, capsys):
    rows = [
        at_most("a small error", 2.0, 1.0, "Somebody 1900"),
        close("drag", 2.06, 2.05, 0.08, "Somebody 1970"),
    ]
    plots = [
        Plot("lines", "time", "drag", (Line("here", [1, 2], [3, 4], "o-"),), None, "xy"),
        Plot("field", "x", "y", image=np.eye(4)),
    ]
    assert program.main((section(Result(rows, plots)),), tmp_path) == 1
    text = (tmp_path / "validation.md").read_text(encoding="utf-8")
    assert "| a small error | 0 (Somebody 1900) | 2 | – | ≤ 1 | **FAIL** JAX |" in text
    assert "| drag | 2.05 (Somebody 1970) | 2.06 | – | ± 8 % | pass |" in text
    assert "**1 FAIL**" in text
    assert "What is measured. The kernel has no eyes." in text
    assert "FAIL a small error, JAX" in capsys.readouterr().out
    for plot in plots:
        picture = f"pictures/validation-{plot.name}.png"
        assert f"({picture})" in text
        assert (tmp_path / picture).stat().st_size > 1000


def test_a_bar_that_only_the_kernel_misses_fails_the_program(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("microcosmos.device.kernel_version", lambda: "7.1")
    assert program.main((drag(2.06, 2.1),), tmp_path) == 0
    text = (tmp_path / "validation.md").read_text(encoding="utf-8")
    assert "| drag | 2.05 / 2.051 (Dennis) | 2.06 | 2.1 | ± 8 % | pass |" in text
    assert "1 lines, 1 of them in the kernel too, all pass." in text
    assert "microcosmos-kernels 7.1" in text
    assert program.main((drag(2.06, 3.0),), tmp_path) == 1
    text = (tmp_path / "validation.md").read_text(encoding="utf-8")
    assert "| 2.06 | 3 | ± 8 % | **FAIL** kernel |" in text
    assert "FAIL drag, kernel: 3" in capsys.readouterr().out


def test_every_subject_of_the_document_has_its_own_title_and_checks():
    assert len({one.title for one in SECTIONS}) == len(SECTIONS)
    assert all(one.checks and one.text for one in SECTIONS)
