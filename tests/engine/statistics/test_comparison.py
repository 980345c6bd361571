"""Comparisons state what differs, correct for all tests, and refuse wrong use."""

import csv
import json
from io import StringIO

import numpy as np
import pytest
from scipy import stats

from microcosmos.statistics import by_spec, compare, named, tables
from microcosmos.statistics.effects import Bootstrap
from microcosmos.statistics.measures import Measure
from microcosmos.statistics.testing import holm

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


def test_two_groups_have_no_test_over_all(three):
    (result,) = compare(three[:2], ["qd_score"], FEW).results
    assert result.overall is None
    assert result.pairs[0].p == result.pairs[0].test.p


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


@pytest.mark.parametrize("text", ["", "qd score", "best>0.5", "best@0.5", "evaluations"])
def test_what_is_no_measure_is_refused_with_the_forms(text):
    with pytest.raises(ValueError, match=r"a measure must be a .*, got|got `evaluations`"):
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


def test_unequal_evaluations_are_refused_with_the_point_at_which_to_compare(group_of):
    short, long = group_of(SLOW), group_of(FAST, generations=8)
    groups = named({"short": short, "long": long})
    refused(groups, r"equal evaluations, got 40 in .* and 80 in .*as qd_score@40")
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


def test_groups_without_names_are_those_of_specs(group_of):
    runs = group_of(SLOW) + group_of(FAST, world__viscosity=0.2)
    found = by_spec(runs[::-1])
    names = ["viscosity 0.2", "viscosity 0.05"]
    assert [(group.name, group.seeds) for group in found] == [
        (n, list(range(5))) for n in names
    ]


def test_versions_that_differ_are_said(group_of):
    groups = named({"old": group_of(SLOW), "new": group_of(FAST, version="0.2.0")})
    assert "several versions: 0.1.0, 0.2.0" in tables.text(compare(groups, ["best"], FEW))


def test_csv_and_json_hold_every_number_in_full(three):
    found = compare(three, ["qd_score"], FEW)
    rows = list(csv.DictReader(StringIO(tables.csv(found))))
    runs = [row for row in rows if row["table"] == "run"]
    assert [float(row["value"]) for row in runs] == SLOW + FAST + FASTEST
    (pair,) = [row for row in rows if (row["group"], row["other"]) == ("slow", "fast")]
    document = json.loads(tables.json(found))
    (measure,) = document["measures"]
    assert measure["pairs"][0]["p_holm"] == float(pair["p_holm"])
    assert measure["groups"][1]["values"] == FAST
    assert document["bootstrap"] == {"resamples": 199, "seed": 0}


def test_latex_is_a_booktabs_table_of_escaped_words(group_of):
    groups = named({"50 % & more": group_of(SLOW), "b_2": group_of(FASTEST)})
    text = tables.latex(compare(groups, ["qd_score"], FEW))
    assert text.startswith("% \\usepackage{booktabs}")
    assert text.count("\\toprule") == text.count("\\bottomrule") == 2
    assert r"50\,\% \& more & b\_2 & 0 & 0.008 & 0.008 & 0.00 & 0.00--0.00 \\" in text
    body = [line for line in text.splitlines() if line.endswith(r"\\")]
    assert {line.count(" & ") for line in body} == {6, 7}


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


def test_tests_that_cannot_find_a_difference_are_said_to(group_of):
    scores = {"a": [1.0, 2, 3, 4, 5], "b": [6.0, 7, 8, 9, 10]}
    groups = named({name: group_of(values) for name, values in scores.items()})
    many = compare(groups, ["qd_score", "qd_score@10", "qd_score@20", "qd_score@30", "best@10",
                            "best@20", "best@30"], FEW)  # fmt: skip
    least = min(pair.p for result in many.results for pair in result.pairs)
    (caution,) = tables.document(many)["cautions"]
    assert f"With these numbers of runs and 7 tests, no p can be below {least:.3f}" in caution
    assert not tables.document(compare(groups, ["qd_score"], FEW))["cautions"]
