"""The file of a study: grids and seeds as sweeps have them, and errors that name the field."""

import json
import re

import pytest
import yaml
from small_spec import SMALL_RUN

from microcosmos.study import read
from microcosmos.study.document import parse
from microcosmos.study.runs import identity

SWEEPS = {"a": {"spec": SMALL_RUN, "grid": {"world.viscosity": [0.1, 0.2]}, "seeds": 3}}
COMPARED = {"x": {"groups": ["a"]}}


@pytest.fixture
def small(planned):
    def make(**sweep):
        return planned(sweeps={"viscosity": {"spec": SMALL_RUN} | sweep}, figures=[])

    return make


def test_every_case_is_run_with_every_seed(planned):
    runs = planned(sweeps=SWEEPS, comparisons=COMPARED, figures=[]).runs
    found = [(run.spec.seed, run.spec.world.viscosity) for run in runs]
    assert found == [(seed, v) for seed in range(3) for v in (0.1, 0.2)]
    assert len({run.id for run in runs}) == 6
    assert all(identity(run.spec).startswith(run.id) for run in runs)


def test_seeds_start_with_the_specs_own(planned):
    sweeps = {"a": SWEEPS["a"] | {"set": {"seed": 7}, "grid": {}}}
    runs = planned(sweeps=sweeps, comparisons=COMPARED, figures=[]).runs
    assert [run.spec.seed for run in runs] == [7, 8, 9]


def test_a_run_of_two_sweeps_is_one_run(planned):
    sweeps = SWEEPS | {"b": SWEEPS["a"] | {"seeds": [1, 9]}}
    found = planned(sweeps=sweeps, comparisons=COMPARED, figures=[])
    assert (len(found.runs), len(found.unique())) == (10, 8)


def test_specs_are_presets_files_or_documents(study_file, planned):
    path = study_file()
    (path.parent / "small.json").write_text(json.dumps(SMALL_RUN))
    preset = planned(sweeps={"a": {"spec": "demo"}}, comparisons=COMPARED, figures=[])
    assert preset.bases["a"].world.width == 48
    given = planned(sweeps=SWEEPS, comparisons=COMPARED, figures=[])
    assert given.bases["a"].world.width == SMALL_RUN["world"]["width"]


def test_yaml_says_the_same_as_json(study_file):
    path = study_file()
    document = json.loads(path.read_text())
    other = path.with_suffix(".yaml")
    other.write_text(yaml.safe_dump(document))
    assert read(other) == read(path)


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        ({"sweeps": {"a": {"seeds": 0}}}, "sweeps.a.seeds"),
        ({"sweeps": {"a": {"seeds": [1, 1]}}}, "sweeps.a.seeds: needs seeds that differ"),
        ({"sweeps": {"a": {"sees": 3}}}, "sweeps.a.sees: Extra inputs are not permitted"),
        ({"title": ""}, "title"),
        ({"comparisons": {"x": {"groups": ["b"]}}}, "`comparisons.x.groups` must be one"),
        (
            {"comparisons": {"x": {"groups": ["viscosity"], "measures": ["beauty!"]}}},
            "comparisons.x.measures: a measure must be",
        ),
        ({"figures": [{"kind": "box"}]}, "`figures.0.of` must be one of Viscosity, Tasks"),
        (
            {"figures": [{"kind": "parameter", "of": "Viscosity"}]},
            "figures.0: a figure `parameter` needs `field`",
        ),
        (
            {"figures": [{"kind": "box", "of": "Tasks"}]},
            "`figures.0`: a box needs a comparison without `tasks`",
        ),
        (
            {"figures": [{"kind": "profile", "of": "Viscosity"}]},
            "`figures.0`: a profile needs a comparison with `tasks`",
        ),
        ({"exports": ["word"]}, "exports.0: Input should be 'csv', 'json', 'latex'"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_named_with_its_field(study_file, parts, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        read(study_file(**parts))


@pytest.mark.parametrize(
    ("sweep", "message"),
    [
        ({"spec": "nowhere"}, "sweeps.viscosity.spec must be a file, or one of demo, "),
        ({"spec": "gaits/demo"}, "sweeps.viscosity.spec: a search is needed"),
        ({"set": {"world.viscosit": 1}}, "no field `world.viscosit`; did you mean `world.visc"),
        ({"grid": {"seed": [1]}}, "a grid cannot contain `seed`; use `seeds`"),
        (
            {"grid": {"world.viscosity": [-1]}},
            "sweeps.viscosity.grid (world.viscosity -1): world",
        ),
        ({"set": {"search.batch": 0}}, "sweeps.viscosity.set: search.batch: "),
    ],
)
def test_a_wrong_spec_is_named_with_its_field(small, sweep, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        small(**sweep)


def test_what_is_no_yaml_is_refused():
    with pytest.raises(ValueError, match="a study must be YAML or JSON"):
        parse("a: [")


def test_values_that_no_case_has_are_refused(planned):
    with pytest.raises(ValueError, match="`where` must be values of the grid"):
        planned().of("viscosity", {"world.viscosity": 0.7})


TWICE = """
title: Twice
sweeps: {a: {}}
comparisons:
  speed: {groups: [a], measures: [best]}
  speed: {groups: [a], measures: [coverage]}
"""


def test_a_name_that_is_given_twice_is_refused_in_yaml_and_json():
    message = r"^comparisons.speed: a name must be given once, got it twice$"
    with pytest.raises(ValueError, match=message):
        parse(TWICE)
    text = '{"title": "Twice", "comparisons": {"speed": {}, "speed": {}}}'
    with pytest.raises(ValueError, match=message):
        parse(text, is_json=True)
    nested = '{"figures": [{"kind": "box"}, {"kind": "box", "kind": "curves"}]}'
    with pytest.raises(ValueError, match=r"^figures.1.kind: a name must be given once"):
        parse(nested, is_json=True)


def test_yaml_merges_and_aliases_are_no_names_twice():
    text = """
title: Merged
sweeps:
  a: &a {spec: demo, seeds: 3}
  b: {<<: *a, seeds: 4}
comparisons: {x: {groups: [a, b]}}
"""
    assert [one.seeds for one in parse(text).sweeps.values()] == [3, 4]


def test_yaml_reads_numbers_with_an_exponent():
    text = "{title: A, sweeps: {a: {grid: {world.viscosity: [1e-2, 2.5E-1, 5.e+0]}}}, " \
        "comparisons: {x: {groups: [a]}}}"  # fmt: skip
    assert parse(text).sweeps["a"].grid == {"world.viscosity": [0.01, 0.25, 5.0]}


@pytest.mark.parametrize("title", ["1e3 evaluations", "12e4567890abc", "2e-2 and 5e-2"])
def test_yaml_reads_words_that_begin_like_numbers(title):
    rest = "sweeps: {a: {spec: demo}}, comparisons: {x: {groups: [a]}}"
    assert parse(f"{{title: {title}, {rest}}}").title == title


def test_comparisons_of_one_file_are_refused(study_file):
    comparisons = {name: {"groups": ["viscosity"]} for name in ("a b", "a-b")}
    with pytest.raises(ValueError, match="got 'a b' and 'a-b', which are both 'a-b'"):
        read(study_file(comparisons=comparisons, figures=[]))


def test_equal_cases_are_refused(small):
    message = (
        "sweeps.viscosity.grid: cases must be different runs, got world.viscosity 2e-2 and "
    )
    with pytest.raises(ValueError, match=re.escape(message)):
        small(grid={"world.viscosity": ["1e-2", "2e-2", 0.02]})


def test_cases_have_the_values_of_their_specs(planned):
    sweeps = {"a": {"spec": SMALL_RUN, "grid": {"world.viscosity": ["1e-1", 0.2]}, "seeds": 1}}
    found = planned(sweeps=sweeps, comparisons=COMPARED, figures=[])
    assert [run.values for run in found.runs] == [{"world.viscosity": x} for x in (0.1, 0.2)]
    for where in ("1e-1", 0.1):
        assert found.of("a", {"world.viscosity": where}) == list(found.runs[:1])
