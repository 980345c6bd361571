"""Every mutant applies to the sources: its text occurs once and its tests exist."""

from pathlib import Path

import pytest
from run import ROOT, Mutant, mutants


def exists(folder: Path, test: str) -> bool:
    """Return whether a folder or a file of tests exists, or a test of a file (`file::test`)."""
    path, _, name = test.partition("::")
    file = folder / path
    return f"def {name}(" in file.read_text() if name else file.exists()


@pytest.mark.parametrize("mutant", mutants(), ids=lambda mutant: mutant.name)
def test_a_mutant_changes_one_place_and_names_tests(mutant: Mutant):
    source = (ROOT / mutant.file).read_text()
    assert mutant.mutate(source) != source
    folder = ROOT / "web" if mutant.of_page else ROOT
    assert [test for test in mutant.tests if not exists(folder, test)] == []


def test_there_are_mutants_of_every_kind():
    kinds = {mutant.name.partition("-")[0] for mutant in mutants()}
    assert {"physics", "gradient", "insertion", "claim", "resume", "auth"} <= kinds
    assert {"sandbox", "page", "feasible", "search"} <= kinds
    assert len(mutants()) >= 25
