"""Comparisons state what differs, correct for all tests, and refuse wrong use."""

import numpy as np
import pytest
from scipy import stats

from microcosmos.statistics import by_spec, compare, named, tables, wording
from microcosmos.statistics.effects import Bootstrap, holm
from microcosmos.statistics.groups import differences
from microcosmos.statistics.measures import Measure

SLOW, FAST, FASTEST = [5.0, 3, 4, 1, 2], [2.5, 6, 7, 8, 9], [10.0, 12, 11, 13, 14]
FEW = Bootstrap(199)


@pytest.fixture
def three(group_of):
    return named(
        {
            "slow": group_of(SLOW),
            "fast": group_of(FAST, world__viscosity=0.2),
            "fastest": group_of(FASTEST, world__viscosity=0.4),
        }
    )


def test_pairs_are_tested_and_corrected_over_all_measures(three):
    found = compare(three, ["qd_score", "best@30"], FEW)
    pairs = [(SLOW, FAST), (SLOW, FASTEST), (FAST, FASTEST)]
    p = [stats.mannwhitneyu(x, y, method="exact").pvalue for x, y in pairs]
    result, after_30 = found.results
    assert [pair.test.p for pair in result.pairs] == pytest.approx(p)
    assert [pair.p for pair in result.pairs] == pytest.approx(holm(p * 2)[:3])
    assert result.overall.p == pytest.approx(stats.kruskal(SLOW, FAST, FASTEST).pvalue)
    assert result.pairs[0].superiority == pytest.approx(3 / 25)
    assert result.pairs[1].interval == (0, 0)
    slow = after_30.summaries[0]
    assert slow.median == pytest.approx(3 * 0.75**2)
    assert found.tests == 6
    assert found.differences == {"world.viscosity": [0.05, 0.2, 0.4]}


def test_every_field_in_which_groups_differ_is_named(run):
    novelty = {"kind": "dominated-novelty", "neighbours": 3}
    runs = [run(1.0), run(2.0, world__viscosity=0.2), run(3.0, archive__container=novelty)]
    groups = by_spec(runs)
    assert [group.name for group in groups] == [
        "world viscosity 0.05, container kind none",
        "world viscosity 0.2, container kind none",
        "world viscosity 0.05, container kind dominated-novelty",
    ]
    differ = {
        "world.viscosity": [0.05, 0.2, 0.05],
        "archive.container.kind": [None, None, "dominated-novelty"],
    }
    assert differences(groups) == differ, "the number of neighbours follows from the kind"
    assert "archive.container.kind (none, none, dominated-novelty). " in tables.text(
        compare(groups, ["qd_score"], FEW)
    )
    other = run(4.0, archive__container=novelty | {"neighbours": 5})
    within = differences(by_spec([*runs, other]))
    assert within["archive.container.neighbours"] == [None, None, 3, 5]


def test_evaluations_to_a_value_count_from_the_generation_that_reaches_it(group_of):
    groups = named({"a": group_of([4.0, 4, 4, 4, 1]), "b": group_of([8.0] * 4 + [7])})
    (result,) = compare(groups, ["qd_score>=3"], FEW).results
    assert result.summaries[0].values == (30, 30, 30, 30, np.inf)
    assert result.summaries[1].values == (20, 20, 20, 20, 20)
    assert result.pairs[0].superiority == 1
    assert "does not reach it counts as more" in " ".join(tables.document(
        compare(groups, ["qd_score>=3"], FEW))["cautions"])  # fmt: skip


def test_a_corrected_score_is_the_last_one_until_then(group_of, run):
    scores = [1.0, np.nan, 3.0, np.nan]
    assert Measure.parse("corrected_qd_score@40").of(run(corrected=scores)) == 3
    assert Measure.parse("corrected_qd_score@20").of(run(corrected=scores)) == 1
    with pytest.raises(ValueError, match="needs elites that were evaluated again by then"):
        Measure.parse("corrected_qd_score").of(run())


def test_a_group_that_was_never_evaluated_again_reaches_no_corrected_value(group_of, run):
    repeated = [run(seed=seed, corrected=[0.0, 0.0, 0.2, 0.3]) for seed in range(5)]
    groups = named({"a": repeated, "b": group_of([2.0] * 5)})
    with pytest.raises(ValueError, match=r"`corrected_qd_score>=0\.1` needs elites that were"):
        compare(groups, ["corrected_qd_score>=0.1"], FEW)
    late = run(corrected=[np.nan, np.nan, 0.2, np.nan])
    assert Measure.parse("corrected_qd_score>=0.1").of(late) == 30
    assert Measure.parse("corrected_qd_score>=0.3").of(late) == np.inf


def test_corrected_values_of_other_schedules_are_refused(run):
    """Equal scores where both are known: the second group only shows them later."""
    curves = {1: [0.1, 0.2, 0.3, 0.4], 3: [np.nan, np.nan, 0.3, 0.4]}
    groups = named(
        {
            f"every {every}": [
                run(
                    seed=seed,
                    name=f"every-{every}.h5",
                    corrected=own,
                    search__reevaluation={"every": every},
                )
                for seed in range(5)
            ]
            for every, own in curves.items()
        }
    )
    late = r"got one after 10 in every-1\.h5 and none there in every-3\.h5"
    refused(groups, late, ["corrected_qd_score>=0.1"])
    refused(groups, "`corrected_qd_score@20` needs elites that", ["corrected_qd_score@20"])
    measures = ["corrected_qd_score", "corrected_qd_score@30"]
    for result in compare(groups, measures, FEW).results:
        assert [one.median for one in result.summaries] in ([0.3, 0.3], [0.4, 0.4])


def test_a_curve_without_numbers_is_refused_in_its_own_words(run):
    empty = run(curves={"qd_score": np.full(4, np.nan)})
    for text in ("qd_score", "qd_score>=1", "qd_score@20"):
        with pytest.raises(ValueError, match=f"`{text}` needs a number, got NaN"):
            Measure.parse(text).of(empty)


def test_a_measure_that_is_named_twice_is_one(three):
    twice = ["qd_score@40", "qd_score@4_0", Measure("qd_score", at=40), "best"]
    found, once = (
        compare(three, measures, FEW) for measures in (twice, ["qd_score@40", "best"])
    )
    assert found.tests == once.tests == 6
    assert found.results == once.results


@pytest.mark.parametrize("value", ["2", "2.0000001", "0.1", "1e-07", "12345.678", "-0.333333"])
def test_labels_keep_the_digits_of_a_value(value):
    measure = Measure.parse(f"qd_score>={value}")
    assert measure.text == f"qd_score>={value}"
    assert measure.title == f"evaluations to QD score {value}"


def test_values_that_differ_have_names_that_differ(group_of):
    values = (0.12345, 0.123451)
    runs = [run for value in values for run in group_of([1.0], world__viscosity=value)]
    assert [group.name for group in by_spec(runs)] == [
        "viscosity 0.12345",
        "viscosity 0.123451",
    ]
    ends = [[*range(20), end] for end in (20, 21)]
    long = [run for end in ends for run in group_of([1.0], search__initial=end)]
    cut = "0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 1…"
    groups = by_spec(long)
    assert [group.name for group in groups] == [f"initial {cut} (1)", f"initial {cut} (2)"]
    assert "18, 19, 20, 0, 1" in wording.described(groups), "the lists stand whole"


@pytest.mark.parametrize(
    ("value", "text"), [(9999.4, "9999"), (9999.6, "10,000"), (10000.4, "10,000")]
)
def test_numbers_have_four_digits_and_no_powers(value, text):
    assert wording.number(value) == text
    assert wording.number(-value) == f"-{text}"


@pytest.mark.parametrize(
    "text",
    ["", "qd score", "best>0.5", "best@0.5", "evaluations", "best>=1e999", "coverage>=50"],
)
def test_what_is_no_measure_is_refused_with_the_forms(text):
    with pytest.raises(ValueError, match=r"`measure` needs a .*, got|got `evaluations`"):
        Measure.parse(text)


def test_fewer_than_five_seeds_have_medians_and_a_sentence_in_place_of_tests(group_of):
    groups = named({"a": group_of([1.0, 2, 3, 4]), "b": group_of([5.0] * 5)})
    found = compare(groups, ["qd_score"])
    assert found.refusal == "Tests need at least 5 seeds in each group, got 4 in 'a'."
    (result,) = found.results
    assert (result.pairs, result.overall) == ((), None)
    assert result.summaries[0].median == 2.5
    assert result.summaries[0].interval is None
    assert found.refusal in tables.text(found)


def refused(groups, message, measures=("qd_score",)):
    with pytest.raises(ValueError, match=message):
        compare(groups, measures, FEW)


def test_no_groups_and_no_measures_are_refused(group_of):
    refused([], "statistics need a group, got none")
    refused(named({"a": []}), "group 'a' needs a run, got none")
    refused(named({"a": group_of(SLOW)}), "`measures` needs at least one", measures=())
    for made, message in (((0,), "`resamples` must be at least 1; got 0"), ((9, -1), "`seed`")):
        with pytest.raises(ValueError, match=message):
            Bootstrap(*made)


def test_unequal_evaluations_are_refused_with_the_point_at_which_to_compare(group_of):
    short, long = group_of(SLOW), group_of(FAST, generations=8)
    groups = named({"short": short, "long": long})
    refused(groups, r"equal evaluations, got 40 in .* and 80 in .*; compare at qd_score@40")
    (result,) = compare(groups, ["qd_score@40"], FEW).results
    assert result.summaries[1].median == pytest.approx(7 / 2)
    refused(groups, r"from 10, its first generation, to 40, its last, got 60", ["best@60"])


def test_a_run_that_ended_before_others_reached_the_value_is_refused(group_of):
    """Equal speeds of progress: the short runs would be later by their ends alone."""
    short, long = group_of([2.0] * 5), group_of([4.0] * 5, generations=8)
    groups = named({"short": short, "long": long})
    refused(
        groups,
        r"2-seed0.h5, which ended at 40 evaluations without reaching it, and 4-seed0.h5, which "
        "reached it at 50",
        ["qd_score>=2.5"],
    )
    (result,) = compare(groups, ["qd_score>=2"], FEW).results
    assert result.pairs[0].superiority == 0.5, "all reach it"
    late = named({"short": short, "long": group_of([9.0] * 5, generations=8)})
    (result,) = compare(late, ["qd_score>=2.5"], FEW).results
    assert result.summaries[0].values == (np.inf,) * 5, "40 evaluations are more than 30"


def test_specs_that_differ_in_a_group_are_refused_with_the_field(group_of, run):
    mixed = [*group_of(SLOW), run(9.0, seed=9, world__viscosity=0.3)]
    refused(named({"a": mixed, "b": group_of(FAST)}), r"`world.viscosity` 0.05 in .*and 0.3 in")


def test_a_run_in_two_groups_is_refused_also_as_a_copy(group_of, run):
    copy = run(3.0, seed=1, name="copy.h5")
    refused(named({"a": group_of(SLOW), "b": [copy]}), r"\(the same as copy.h5\) in 'a' and in")


def test_a_seed_twice_is_refused(group_of, run):
    twice = [*group_of(SLOW), run(9.0, seed=1, name="again.h5")]
    refused(named({"a": twice}), r"each seed once, got seed 1 in 3-seed1.h5 and in again.h5")


def test_an_unfinished_run_is_refused_with_how_far_it_is(group_of, run):
    groups = named({"a": [*group_of(SLOW), run(1.0, seed=7, state="at generation 4 of 9")]})
    refused(groups, "needs finished runs, got 1-seed7.h5, which is at generation 4 of 9")


def test_latex_is_a_booktabs_table_of_escaped_words(group_of):
    groups = named({"50 % & more": group_of(SLOW), "b_2": group_of(FASTEST)})
    text = tables.latex(compare(groups, ["qd_score"], FEW))
    assert text.startswith("% \\usepackage{booktabs}")
    assert text.count("\\toprule") == text.count("\\bottomrule") == 2
    assert r"50\,\% \& more & b\_2 & 0 & 0.008 & 0.008 & 0.00 & 0.00--0.00 \\" in text
    body = [line for line in text.splitlines() if line.endswith(r"\\")]
    assert {line.count(" & ") for line in body} == {6, 7}
    broken = tables.latex(compare(named({"a\nb": group_of(SLOW)}), ["qd_score"], FEW))
    assert "\n% \\caption{There is one group: a b." in broken
    assert "QD score & a b & 5" in broken


def test_latex_keeps_minus_signs_and_words(group_of):
    """Two hyphens before a minus would be a dash of TeX: -0.8 to -0.6 would lose a sign."""
    low = [-x for x in SLOW]
    groups = named({"point to point": group_of(low), "p": group_of([-9.0, -8, -7, -6, -5.5])})
    text = tables.latex(compare(groups, ["qd_score", "qd_score>=-2"], FEW))
    rows = [line for line in text.splitlines() if line.endswith(r"\\")]
    assert r"QD score & point to point & 5 & $-$3 & $-$4 to $-$2 & $-$3 & " in rows[1]
    assert rows[2].startswith(" & p & 5 & $-$7 & $-$8 to $-$6")
    assert rows[3].startswith("evaluations to QD score -2 & point to point & 5 & ")
    assert " & $U$ & $p$ & p (Holm) & $A_{12}$ & " in text
    assert "---" not in text
