"""Reports of generations without elites."""

from microcosmos.archive.report import Report


def report_of(generation, **values):
    given = {"evaluations": 8 * generation, "infeasible": 0, "qd_score": 1.5, **values}
    return Report(generation=generation, **given)
