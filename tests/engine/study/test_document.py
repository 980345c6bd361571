"""The file of a study: grids and seeds as sweeps have them, and errors that name the field."""

import json
import re

import pytest
import yaml
from small_spec import SMALL_RUN

from microcosmos.study import read
from microcosmos.study.document import parse
from microcosmos.study.document import yaml as read_yaml
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
    # Groups of both, and of one sweep that is listed twice, have each run once.
    for listed in (["a", "b"], ["a", "a"]):
        comparisons = {"x": {"groups": listed}}
        assert planned(sweeps=sweeps, comparisons=comparisons, figures=[]).runs


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
        ({"sweeps": {"a": {"seeds": [1, 1]}}}, "`sweeps.a.seeds` needs seeds that differ"),
        ({"sweeps": {"a": {"seeds": True}}}, "`sweeps.a.seeds` needs a valid integer; got"),
        ({"sweeps": {"a": {"seeds": [5, True]}}}, "`sweeps.a.seeds.1` needs a valid integer"),
        ({"sweeps": {"a": {"seeds": [2.0]}}}, "`sweeps.a.seeds.0` needs a valid integer"),
        ({"resamples": 999.0}, "`resamples` needs a valid integer; got 999.0"),
        ({"resamples": 1_000_001}, "`resamples` needs "),
        ({"sweeps": {"a": {"sees": 3}}}, "`sweeps.a.sees` needs no field of this name"),
        ({"title": ""}, "title"),
        ({"comparisons": {"x": {"groups": ["b"]}}}, "`comparisons.x.groups` must be one"),
        (
            {"comparisons": {"x": {"groups": ["viscosity"], "measures": ["beauty!"]}}},
            "`comparisons.x.measures` needs a curve",
        ),
        ({"figures": [{"kind": "box"}]}, "`figures.0.of` must be one of Viscosity, Tasks"),
        (
            {"figures": [{"kind": "parameter", "of": "Viscosity"}]},
            "`figures.0.field` is needed by a figure `parameter`",
        ),
        *(
            (
                {"figures": [{"kind": kind, "of": "Tasks", "field": field}]},
                f"`figures.0` needs a comparison without `tasks` for a figure `{kind}`",
            )
            for kind, field in (("box", ""), ("curves", ""), ("parameter", "world.viscosity"))
        ),
        (
            {"figures": [{"kind": "profile", "of": "Viscosity"}]},
            "`figures.0` needs a comparison with `tasks` for a figure `profile`",
        ),
        ({"exports": ["word"]}, "`exports.0` needs 'csv', 'json', 'latex'"),
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
            "sweeps.viscosity.grid (world.viscosity -1): `world.viscosity` needs",
        ),
        ({"set": {"search.batch": 0}}, "sweeps.viscosity.set: `search.batch` needs "),
        *(
            ({"set": {"seed": seed}, "seeds": seeds}, "sweeps.viscosity.set: `seed` needs ")
            for seed in ("7", 1.5, None, [1], True)
            for seeds in (2, [3])
        ),
        (
            {"grid": {"search.reevaluation.every": [5, 10], "search.reevaluation": [None]}},
            "sweeps.viscosity.grid: `search.reevaluation.every` lies in `search.reevaluation`, "
            "which the grid replaces as a whole",
        ),
        (
            {"grid": {f"world.{i}": list(range(1000)) for i in range(10)}},
            f"at most 1,000 runs in all, got {5 * 1000**10:,}",
        ),
    ],
)
def test_a_wrong_spec_is_named_with_its_field(small, sweep, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        small(**sweep)


TWO = SWEEPS | {
    "b": SWEEPS["a"] | {"set": {"search.batch": 6}},
    "flat": {"spec": SMALL_RUN, "set": {"archive.descriptors": [{"name": "straightness"}]}},
}
AT_24 = {"groups": ["a", "b"], "measures": ["qd_score@24"]}


def of(measure, **parts):
    return {"groups": ["a"], "measures": [measure], **parts}


@pytest.mark.parametrize(
    ("comparison", "figure", "message"),
    [
        (
            {"groups": ["a", "b"], "measures": ["best"]},
            None,
            "comparisons.x.measures: `best` needs runs with equal evaluations, got 24 in "
            "b (world.viscosity 0.1, seed 0) and 32 in a (world.viscosity 0.1, seed 0)",
        ),
        (of("best@33"), None, "comparisons.x.measures: a (world.viscosity 0.1, seed 0): "
         "`best@33` needs evaluations from 8, its first generation, to 32, its last, got 33"),
        (of("best@7"), None, "got 7"),
        (of("qd_scor"), None, "a curve must be one of best, "),
        (of("corrected_qd_score"), None, "(`search.reevaluation`), got none"),
        (of("best>=1", tasks=["world.viscosity"]), None, "aggregates need the value of"),
        (
            of("best", tasks=["world.viscosit"]),
            None,
            "comparisons.x.tasks: the spec has no field `world.viscosit`; did you mean `world",
        ),
        (
            {"groups": {"u": {"sweep": "a"}}},
            None,
            "comparisons.x: group 'u' needs runs that differ in the seed alone",
        ),
        (
            {"groups": {"u": {"sweep": "a", "where": {"world.viscosity": 0.3}}}},
            None,
            "comparisons.x: `where` must be values of the grid",
        ),
        (
            {"groups": {"a游": {"sweep": "a", "where": {"world.viscosity": 0.1}}}},
            {"kind": "curves"},
            "figures.0: names of groups need letters that the font DejaVu Sans has; got '游'",
        ),
        (AT_24, {"kind": "curves", "shown": ["bset"]}, "`figures.0.shown` must be of qd_score"),
        (
            AT_24,
            {"kind": "parameter", "field": "world.nonsense"},
            "figures.0.field: a parameter must differ between groups (it may be world.visc",
        ),
        (
            {"groups": ["flat", "a"]},
            {"kind": "sheet"},
            "figures.0: a figure `sheet` needs at least two `archive.descriptors`, got 1 in f",
        ),
    ],
)  # fmt: skip
def test_a_study_is_checked_before_anything_is_computed(planned, comparison, figure, message):
    figures = [figure] if figure else []
    with pytest.raises(ValueError, match=re.escape(message)):
        planned(sweeps=TWO, comparisons={"x": comparison}, figures=figures)


AGAIN = {"search.reevaluation": {"every": 3}}
FOUR = {"search.generations": 4}


@pytest.mark.parametrize(
    ("given", "measures", "message"),
    [
        # The first has 4 generations of 8, the second 2.
        ({}, ["corrected_qd_score"], "got 16 in b (world.viscosity 0.2, seed 0) and 32 in a ("),
        ({}, ["corrected_qd_score@16"], "`corrected_qd_score@16` needs elites that were"),
        (FOUR, ["corrected_qd_score", "corrected_qd_score@24", "corrected_coverage>=0.5"], ""),
        (
            {"search.generations": 5},
            ["corrected_qd_score@32"],
            "got one after 24 in b (world.viscosity 0.2, seed 0) and after 32 in a (world."
            "viscosity 0.1, seed 0); compare at corrected_qd_score@24",
        ),
        (
            {"search.reevaluation.every": 2},
            ["corrected_qd_score>=1"],
            "got one after 16 in b (world.viscosity 0.2, seed 0) and none there in a (",
        ),
    ],
)
def test_corrected_values_are_planned_at_equal_moments(planned, given, measures, message):
    groups, sweeps = {}, {}
    for name, viscosity, own in (
        ("a", 0.1, FOUR),
        ("b", 0.2, {"search.generations": 2} | given),
    ):
        groups[name] = {"sweep": name, "where": {"world.viscosity": viscosity}}
        sweeps[name] = SWEEPS["a"] | {"set": AGAIN | own}
    comparisons = {"x": {"groups": groups, "measures": measures}}
    if message:
        with pytest.raises(ValueError, match=re.escape(message)):
            planned(sweeps=sweeps, comparisons=comparisons, figures=[])
    else:
        assert planned(sweeps=sweeps, comparisons=comparisons, figures=[]).runs


@pytest.mark.parametrize(
    ("given", "measures"),
    [
        # 4 generations of 8 and 6, and 3 of 8: a limit of 20 is met with the third.
        ({"search.batch": 6}, ["best@8", "best@24"]),
        ({"search.generations": 3}, ["best@24"]),
        ({"search.stop.evaluations": 20}, ["best@24"]),
        # The ends of these are known after the runs alone.
        ({"search.batch": 6, "search.stop.fitness": 0.5}, ["best"]),
        (
            {"search.reevaluation": {"every": 2}, "search.stop.evaluations": 20},
            ["best", "best@24", "best>=1"],
        ),
        # Evaluations of elites again are not counted.
        ({"search.reevaluation": {"every": 2}}, ["best", "best@32"]),
    ],
)
def test_comparisons_that_may_be_made_are_planned(planned, given, measures):
    sweeps = SWEEPS | {"b": SWEEPS["a"] | {"set": given}}
    groups = {one: {"sweep": one, "where": {"world.viscosity": 0.1}} for one in ("a", "b")}
    found = planned(
        sweeps=sweeps,
        comparisons={"x": {"groups": groups, "measures": measures}},
        figures=[{"kind": "curves"}],
    )
    assert len(found.unique()) == 12


@pytest.mark.parametrize(
    "text", ["a: [", "a: !!int x", "a: !!bool x", "a: !!timestamp 2026-13-45", "a: !!set {b}"]
)
def test_what_is_no_yaml_is_refused(text):
    with pytest.raises(ValueError, match="a study must be YAML or JSON"):
        parse(text)


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
    message = r"^`comparisons.speed` must be given once; got it twice$"
    with pytest.raises(ValueError, match=message):
        parse(TWICE)
    text = '{"title": "Twice", "comparisons": {"speed": {}, "speed": {}}}'
    with pytest.raises(ValueError, match=message):
        parse(text, is_json=True)
    nested = '{"figures": [{"kind": "box"}, {"kind": "box", "kind": "curves"}]}'
    with pytest.raises(ValueError, match=r"^`figures.1.kind` must be given once"):
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


LAUGHS = "".join(f"a{i}: &a{i} [{', '.join(9 * [f'*a{i - 1}'])}]\n" for i in range(1, 9))


@pytest.mark.parametrize("text", [f"a0: &a0 [1]\n{LAUGHS}", "a: &a {b: *a}"])
def test_aliases_that_grow_without_bounds_are_refused(text):
    with pytest.raises(ValueError, match="at most 100,000 values with its aliases"):
        parse(text)


def test_yaml_reads_scalars_as_its_version_1_2_does():
    # The core schema, section 10.3.2 of the specification; PyYAML follows 1.1.
    scalars = {
        "1e-2": 0.01, "2.5E-1": 0.25, "5.e+0": 5.0, ".5": 0.5, "-12": -12, "+3": 3, "010": 10,
        "0o10": 8, "0x1F": 31, "true": True, "False": False, "null": None, "~": None, "": None,
        "yes": "yes", "off": "off", "1:30:00": "1:30:00", "1:30.5": "1:30.5", "1_000": "1_000",
        "0b1": "0b1", "2026-13-45": "2026-13-45", "2026-01-02": "2026-01-02", "=": "=",
    }  # fmt: skip
    lines = "".join(f"- {text}\n" for text in scalars)
    read = read_yaml(lines)
    assert read == list(scalars.values())
    assert list(map(type, read)) == list(map(type, scalars.values()))
    assert yaml.safe_load("010") == 8  # PyYAML's own loader stays as it is.


@pytest.mark.parametrize("title", ["1e3 evaluations", "12e4567890abc", "2e-2 and 5e-2"])
def test_yaml_reads_words_that_begin_like_numbers(title):
    rest = "sweeps: {a: {spec: demo}}, comparisons: {x: {groups: [a]}}"
    assert parse(f"{{title: {title}, {rest}}}").title == title


def test_comparisons_of_one_file_are_refused(study_file):
    comparisons = {name: {"groups": ["viscosity"]} for name in ("a b", "a-b")}
    with pytest.raises(ValueError, match="got 'a b' and 'a-b', which are both 'a-b'"):
        read(study_file(comparisons=comparisons, figures=[]))
