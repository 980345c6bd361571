"""Wire types of the statistics of runs: groups, tests and effect sizes."""

from uuid import UUID

from ..core.schemas import Wire


class GroupRun(Wire):
    run: UUID
    seed: int


class ComparedGroup(Wire):
    """Finished runs that differ in the seed alone."""

    name: str
    n: int
    runs: list[GroupRun]


class GroupFigures(Wire):
    """One measure of a group; None where a run does not reach the value, or has no elites."""

    group: str
    n: int
    values: list[float | None]
    """In the order of the group's runs."""
    low: float | None
    """A quarter of the values are lower."""
    median: float | None
    high: float | None
    """A quarter of the values are higher."""
    iqm: float | None
    """The mean of the middle half."""
    iqm_low: float | None
    """The ends of its 95 % bootstrap interval, None without tests."""
    iqm_high: float | None


class RankTest(Wire):
    test: str
    statistic: float
    p: float


class PairTest(RankTest):
    """A test of two groups."""

    group: str
    other: str
    p_holm: float
    """p after Holm's correction for all pairs of all measures."""
    a12: float
    """The share of pairs of runs in which the first group's value is greater, ties half."""
    a12_low: float
    a12_high: float


class MeasureStatistics(Wire):
    measure: str
    title: str
    less_is_better: bool
    groups: list[GroupFigures]
    overall: RankTest | None
    """The test of more than two groups at once."""
    pairs: list[PairTest]
    """Empty without tests."""


class Statistics(Wire):
    groups: list[ComparedGroup]
    measures: list[MeasureStatistics]
    refusal: str | None
    """Why there are no tests."""
    groups_in_words: str
    method: str
    """The tests, the correction, and how intervals are made."""
    cautions: list[str]
    tests: int
    """The number of tests for which p is corrected."""
