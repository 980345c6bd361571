"""A local run saves its file now and then, and spends little time on it."""

import json
import re
from itertools import pairwise
from types import SimpleNamespace

import made_archives
import pytest
from small_spec import SMALL_RUN

from microcosmos.archive import creature, export, file
from microcosmos.archive.file_names import beside
from microcosmos.build import local
from microcosmos.build.parts import terms_of
from microcosmos.cli.run import creatures
from microcosmos.spec import parse
from microcosmos.spec.experiments import EXPERIMENTS


@pytest.mark.fast
@pytest.mark.parametrize(
    ("seconds_of_a_save", "expected"), [(0.0, 10), (0.5, 10), (2.4, 5), (20.0, 1)]
)
def test_saving_takes_at_most_a_fiftieth_of_the_time(
    seconds_of_a_save, expected, monkeypatch, tmp_path
):
    """A generation takes a second, and a checkpoint is wanted each minute."""
    clock, saved = [0.0], []

    def save(experiment, archive, terms, state):
        clock[0] += seconds_of_a_save
        saved.append(state.generation)
        return {archive: b""}

    def advance(state, stop):
        clock[0] += 1.0
        return SimpleNamespace(generation=state.generation + 1), None

    experiment = SimpleNamespace(
        init=lambda: SimpleNamespace(generation=0),
        done=lambda state: state.generation >= 610,
        advance=advance,
    )
    monkeypatch.setattr(local, "time", SimpleNamespace(monotonic=lambda: clock[0]))
    monkeypatch.setattr(local, "build", lambda spec: experiment)
    monkeypatch.setattr(local, "_save", save)
    monkeypatch.setattr(local.Sinks, "report", lambda self, report: None)
    spec = EXPERIMENTS["quality-diversity"].presets[0].spec
    assert local.evolve(spec, str(tmp_path / "run.h5"), checkpoint_seconds=60.0)
    assert saved[0] == 60, "the first minute is safe, however long it takes to save"
    assert saved[-1] == 610
    assert len(saved) == expected + 1
    pauses = [after - before for before, after in pairwise(saved[:-1])]
    assert all(pause >= max(60, 50 * seconds_of_a_save) for pause in pauses)


@pytest.mark.fast
@pytest.mark.parametrize("name", ["run", "run.hdf5"])
def test_two_archives_do_not_share_the_file_of_their_best_creature(tmp_path, name):
    data = made_archives.made()
    (tmp_path / "run.h5").write_bytes(data)
    best = {"sha256": export.columns(data)["creature"][0]}
    (tmp_path / "run.best.json").write_text(json.dumps(best))
    spec = EXPERIMENTS["quality-diversity"].presets[0].spec
    needed = f"`archive` must have another name, because run.best.json is of run.h5; got {name}"
    with pytest.raises(ValueError, match=re.escape(needed)):
        local.evolve(spec, tmp_path / name)
    assert len(list(tmp_path.iterdir())) == 2
    # A file of something else keeps no run from its name.
    (tmp_path / "run.h5").write_bytes(file.dump({}, {"format": "other"}))
    local._refuse_twin(tmp_path / name)


TERMS = {"licence": "Not for sale. " * 30 + "Ask.", "credit": ["Ada", "Bo"]}


def test_a_run_keeps_the_licence_and_credit_of_what_it_goes_on_from(tmp_path):
    path, search = tmp_path / "run.h5", SMALL_RUN["search"]
    for generations in (1, 2):
        local.evolve(parse(SMALL_RUN | {"search": search | {"generations": generations}}), path)
        known = export.terms(file.load(path.read_bytes())[1])
        assert known == (TERMS if generations == 2 else {})
        path.write_bytes(export.licensed(path.read_bytes(), **TERMS))
    best = creature.parse(beside(path, ".best.json").read_bytes())
    elites = creatures(path)
    assert best.items() >= TERMS.items()
    assert elites
    assert all(one.items() >= TERMS.items() for one in elites)


@pytest.mark.fast
def test_a_run_begins_from_the_licence_and_credit_of_its_creatures():
    names = ["ab" * 32, "cd" * 32]
    begun = parse(SMALL_RUN | {"search": SMALL_RUN["search"] | {"initial": names}})
    files = [{"sha256": name} for name in [*names, "ef" * 32]]
    assert terms_of(begun, files, None) == {}
    licensed = [files[0], files[1] | TERMS, files[2] | {"licence": "CC0-1.0"}]
    assert terms_of(begun, licensed, None) == TERMS
    # A file without terms takes those of the creatures; one with terms keeps its own.
    plain = made_archives.made()
    assert terms_of(begun, licensed, plain) == TERMS
    own = {"licence": "CC0-1.0", "credit": []}
    assert terms_of(begun, licensed, export.licensed(plain, **own)) == own
    assert terms_of(begun, [], plain) == {}


@pytest.mark.fast
@pytest.mark.parametrize("name", ["run.h5", "run.hdf5"])
def test_an_archive_has_one_run_at_a_time(tmp_path, name):
    spec = EXPERIMENTS["quality-diversity"].presets[0].spec
    needed = f"`archive` must be one that no other process writes; got .*{name}"
    refused = pytest.raises(ValueError, match=needed)
    with local._alone(tmp_path / "run.h5"), refused:
        local.evolve(spec, tmp_path / name)
    assert not list(tmp_path.iterdir())


@pytest.mark.fast
@pytest.mark.parametrize("seconds", [float("nan"), -1.0])
def test_a_pause_between_checkpoints_is_a_number(tmp_path, seconds):
    spec = EXPERIMENTS["quality-diversity"].presets[0].spec
    needed = f"`checkpoint_seconds` must be a number of at least 0; got {seconds}"
    with pytest.raises(ValueError, match=needed):
        local.evolve(spec, tmp_path / "run.h5", checkpoint_seconds=seconds)
