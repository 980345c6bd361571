"""Paths of runs that have `=` and `,` themselves, as sweeps of other programs name folders."""

import pytest
from small_spec import SMALL_RUN

import microcosmos as mc
from microcosmos.cli.groups import listed, read_groups


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """A file in a folder, and the same run of another seed in another folder."""
    place = tmp_path_factory.mktemp("runs")
    for seed in (0, 1):
        folder = place / f"lr=0.{seed},bs=2"
        folder.mkdir()
        mc.evolve(mc.parse(SMALL_RUN | {"seed": seed}), folder / "a.h5")
    return place


FIRST, SECOND = "lr=0.0,bs=2/a.h5", "lr=0.1,bs=2/a.h5"


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ([f"{FIRST},{SECOND}"], 2),
        ([FIRST, SECOND], 2),
        ([f"mine={FIRST},{SECOND}"], 2),
        (["mine=lr=0.1,bs=2"], 1),
        (["lr=0.0,bs=2,lr=0.1,bs=2"], 2),
    ],
)
def test_a_path_with_an_equals_sign_or_commas_is_one_run(runs, monkeypatch, given, expected):
    monkeypatch.chdir(runs)
    (group,) = read_groups(given)
    assert len(group.runs) == expected
    assert (group.name == "mine") == given[0].startswith("mine=")


def test_paths_that_there_are_not_are_parted_at_each_comma():
    assert listed(" a.h5, b.h5,,c") == ["a.h5", "b.h5", "c"]
    many = [f"run-{number}.h5" for number in range(60)]
    assert listed(",".join(many)) == many, "more than a file's name may have"
