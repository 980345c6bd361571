"""A run from the command line that begins from creatures in files."""

import json

import pytest

from microcosmos.archive import creature, creature_h5, file
from microcosmos.build import build
from microcosmos.cli.run import creatures, with_initial
from microcosmos.invalid import InvalidField


@pytest.fixture(scope="module")
def archive(experiment, course, tmp_path_factory):
    path = tmp_path_factory.mktemp("beginning") / "archive.h5"
    path.write_bytes(experiment.save(course[0][-1]))
    return path


@pytest.fixture(scope="module")
def best(experiment, course):
    return creature.parse(experiment.best(course[0][-1]))


@pytest.fixture
def evolve(invoke, tmp_path):
    def run(spec, *arguments, code=0):
        (tmp_path / "spec.json").write_text(json.dumps(spec.model_dump(mode="json")))
        return invoke("evolve", "spec.json", *arguments, code=code)

    return run


def test_an_archive_gives_the_creature_files_of_its_elites(archive, course, best, elite_files):
    assert creatures(archive) == elite_files(course)
    assert best in creatures(archive)


def test_a_creature_is_read_as_json_or_hdf5(best, tmp_path):
    (tmp_path / "best.json").write_text(json.dumps(best))
    (tmp_path / "best.h5").write_bytes(creature_h5.dump(best))
    assert creatures(tmp_path / "best.json") == creatures(tmp_path / "best.h5") == [best]


@pytest.mark.long
def test_the_command_begins_from_a_file_and_goes_on_from_its_own(small, evolve, best, tmp_path):
    (tmp_path / "best.json").write_text(json.dumps(best))
    out, whole = tmp_path / "out.h5", tmp_path / "whole.h5"
    begin = ("--from", tmp_path / "best.json")
    evolve(small(search={"generations": 1}), *begin, "--out", out)
    tree, _ = file.load(out.read_bytes())
    assert [bytes(name).hex() for name in tree["initial"]["creature"]] == [best["sha256"]]
    evolve(small(search={"generations": 2}), *begin, "--out", whole)
    named, _ = with_initial(small(search={"generations": 2}), [tmp_path / "best.json"], archive)
    evolve(named, "--out", out)  # Which can only go on: the creature's file is not given.
    assert out.read_bytes() == whole.read_bytes()
    evolve(small(search={"generations": 2}), *begin, "--out", out)
    assert out.read_bytes() == whole.read_bytes()
    refused = evolve(named, "--out", tmp_path / "none.h5", code=2)
    assert "`search.initial` names 1 creatures" in refused
    assert "--from" in refused


def test_a_spec_that_names_creatures_takes_only_those_of_the_files(
    small, archive, evolve, best
):
    named = small(search={"initial": [best["sha256"]]})
    chosen, files = with_initial(named, [archive], archive)
    assert chosen == named
    assert [file["sha256"] for file in files] == [best["sha256"]]
    other = small(search={"initial": ["0" * 64]})
    text = evolve(other, "--from", archive, code=2)
    assert "--from needs the creatures that `search.initial` names; got none of 0000" in text


def test_a_creature_whose_file_is_not_what_its_name_says_is_refused(small, best):
    named = small(search={"initial": [best["sha256"]]})
    changed = {**best, "identity": {**best["identity"], "scene": named.scene.model_dump()}}
    for given in (changed, {"sha256": best["sha256"]}):
        with pytest.raises(InvalidField, match=r"sha256|identity"):
            build(named, [given]).init()


def test_a_file_without_fitting_creatures_is_refused(small, archive, evolve, tmp_path):
    (tmp_path / "note.txt").write_text("a note")
    (tmp_path / "broken.h5").write_bytes(archive.read_bytes()[:2000])
    for name in ("note.txt", "broken.h5"):
        text = evolve(small(), "--from", tmp_path / name, code=2)
        assert "--from needs a creature file or an archive" in text
        assert name in text.replace(" ", "")
    text = evolve(small(control={"timer": "linear"}), "--from", archive, code=2)
    assert "--from: `control.inputs` needs" in text
