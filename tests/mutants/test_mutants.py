"""Every mutant applies to the sources: its text occurs once and its tests exist."""

import pytest
from run import ROOT, Mutant, mutants


@pytest.mark.parametrize("mutant", mutants(), ids=lambda mutant: mutant.name)
def test_a_mutant_changes_one_place_and_names_tests(mutant: Mutant):
    source = (ROOT / mutant.file).read_text()
    assert mutant.mutate(source) != source
    folder = ROOT / "web" if mutant.of_page else ROOT
    files = [test.partition("::")[0] for test in mutant.tests]
    assert [path for path in files if not (folder / path).exists()] == []


def test_there_are_mutants_of_every_kind():
    kinds = {mutant.name.partition("-")[0] for mutant in mutants()}
    assert {"physics", "gradient", "insertion", "claim", "resume", "auth"} <= kinds
    assert {"sandbox", "page", "feasible", "search"} <= kinds
    assert len(mutants()) >= 25
