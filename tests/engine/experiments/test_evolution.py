"""A search with an archive: it only improves, keeps lineages, and can be extended."""

from dataclasses import replace
from functools import partial

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

import microcosmos
from microcosmos import naming, search, world
from microcosmos.archive import creature, poses, variety
from microcosmos.archive.report import SPECIES
from microcosmos.build import build, build_task
from microcosmos.search import MEASURES, STATUSES, LocalDevices
from microcosmos.spec.evolution import UNLIMITED


def nodes_in(box, state, _):
    return world.unwrapped(box, state)


def test_the_archive_only_improves(course):
    reports = course.reports
    assert [r.evaluations for r in reports] == [16, 32, 48, 64]
    for name in ("qd_score", "coverage", "best"):
        values = [getattr(report, name) for report in reports]
        assert values == sorted(values)


def test_elites_are_evaluated_again_at_the_end_that_a_limit_brings(small, carry_out):
    again = {"every": 50, "samples": 2}
    search = {"generations": 100, "stop": {"evaluations": 32}, "reevaluation": again}
    states, reports = carry_out(build(small(search=search)))
    assert (len(reports), states[-1].ended > 0) == (2, True)
    assert "corrected_qd_score" not in reports[0].summary
    assert reports[-1].summary["corrected_qd_score"] > 0


@pytest.mark.long
def test_a_large_archive_is_overwritten_and_ends_with_the_same_bytes(small, finish):
    axes = [{"name": name, "bins": 65} for name in ("symmetry", "curvature_mean")]
    large = build(small(archive={"descriptors": axes}))
    steps = replace(large.plan.steps, overwrite=large.plan.steps.insert)
    copying = replace(large, plan=replace(large.plan, steps=steps))
    first, before = large.init(), large.init()
    data = finish(large, first)
    assert data == finish(copying, before)
    large.save(before)
    with pytest.raises(RuntimeError, match="deleted"):
        large.save(first)


def test_the_last_report_has_the_variety_of_the_archive_file(course, experiment):
    states, reports, *_ = course
    assert not [report for report in reports[:-1] if "kinds" in report.summary]
    found = variety.of(experiment.save(states[-1]))
    assert found.creatures == found.compared == np.count_nonzero(states[-1].elites.occupied)
    assert found.motion_distance > found.nearest_motion > 0
    for name in ("motion_distance", "nearest_motion", "kinds"):
        assert reports[-1].summary[name] == getattr(found, name)


def test_reported_elites_are_what_the_archive_holds(experiment, course):
    states, reports, *_ = course
    latest = {elite.cell: elite for report in reports for elite in report.elites}
    elites = states[-1].elites
    assert set(latest) == set(np.flatnonzero(elites.occupied))
    for cell, elite in latest.items():
        assert elite.fitness == float(elites.fitness[cell])
        assert elite.generation == int(elites.generation[cell])
        assert elite.creature == bytes(states[-1].parts["lineage"].creatures[cell]).hex()
        document = experiment.creature(states[-1], cell)
        assert naming.canonical(document["identity"]) == elite.identity
        assert creature.parse(document)["provenance"]["parents"] == list(elite.parents)


@pytest.mark.long
def test_pose_streams_are_what_a_simulation_of_the_elites_gives(experiment, course):
    """Another program rounds differently, and these strokes are short."""
    state = course[0][-1]
    found = microcosmos.pose_streams(experiment.save(state))
    last = course.reports[-1].elites[-1]
    assert poses.decode(last.poses).creature == last.creature
    cells, names = np.flatnonzero(state.elites.occupied), state.parts["lineage"].creatures
    assert [one.creature for one in found] == [bytes(x).hex() for x in names[cells]]
    task = build_task(course.spec.scene, room=experiment.facts.encoding.room)
    for cell, one in list(zip(cells, found, strict=True))[::5]:
        genotype = jax.tree.map(lambda x, cell=cell: x[cell], state.elites.genotypes)
        driven = search.drive(task, genotype)
        _, seen = search.simulate(driven, partial(nodes_in, driven.world))
        shown = np.asarray(seen)[one.times - 1]
        np.testing.assert_allclose(one.cells, shown, atol=1e-3)
        assert one.stop == one.steps == len(seen)
        centre = np.asarray(seen).mean(1)
        np.testing.assert_allclose(one.path[-1], centre[-1], atol=1e-3)
        np.testing.assert_allclose(one.path[0], task.start.positions.mean(0), atol=1e-5)


@pytest.mark.parametrize("name", ["quality-diversity", "neuroevolution"])
def test_the_first_generation_is_known_before_it_is_evaluated(name, course_of):
    course = course_of(name)
    files = course.experiment.first_generation()
    assert len({file["sha256"] for file in files}) == course.experiment.plan.batch
    first = {elite.creature for elite in course.reports[0].elites}
    assert first
    assert first <= {creature.parse(file)["sha256"] for file in files}


@pytest.mark.parametrize(
    ("name", "related"), [("quality-diversity", 1), ("neuroevolution", 11)]
)
def test_every_parent_was_an_elite_before_its_child(name, related, course_of):
    generations, parents = {}, []
    for report in course_of(name).reports:
        for elite in report.elites:
            parents += elite.parents
            for parent in elite.parents:
                assert generations[parent] < report.generation
            if name == "quality-diversity":
                assert elite.operator == ("neat" if elite.parents else "random")
        for elite in report.elites:
            generations.setdefault(elite.creature, report.generation)
    assert len(parents) >= related


def test_a_run_cannot_be_shortened(experiment, course, lasting):
    whole = experiment.save(course[0][-1])
    with pytest.raises(ValueError, match=r"`search.generations` must be at least .* 4, got 3"):
        lasting(experiment, 3).restore(whole)


def test_elites_are_marked_with_the_device_that_measured_them(experiment, course):
    data = experiment.save(replace(course[0][1], devices=("abacus",)))
    allowed = experiment.restore(data, other_device=True)
    assert allowed.devices == ("abacus", experiment.device)
    later, report = experiment.advance(allowed)
    again = experiment.restore(experiment.save(later))
    assert again.devices == allowed.devices
    new = {elite.cell for elite in report.elites}
    for cell in np.flatnonzero(again.elites.occupied).tolist():
        measured_on = experiment.creature(again, cell)["measured"]["device"]
        assert measured_on == (experiment.device if cell in new else "abacus")


def test_creatures_that_are_judged_infeasible_are_no_elites(small):
    """At a limit or compressible: the elites of the same spec without judgement."""
    fast = {"period": 20, "angle_scale": 1.0, "length_scale": 0.5, "ramp": 0} | UNLIMITED
    search = {"generations": 2, "batch": 16}
    given = {"control": fast, "task": {"steps": 60, "fitness": "displacement"}}
    found = []
    for feasible in (False, True):
        experiment = build(small(**given, search=search | {"feasible": feasible}))
        state, report = experiment.advance(experiment.init())
        occupied = np.asarray(state.elites.occupied)
        found.append((np.asarray(state.elites.measures)[occupied], state, report))
    (everybody, _, before), (judged, state, report) = found
    limited, mach = MEASURES.index("limited"), MEASURES.index("mach")
    assert np.any((everybody[:, limited] > 1e-3) | (everybody[:, mach] > 0.17))
    assert np.all((judged[:, limited] <= 1e-3) & (judged[:, mach] <= 0.17))
    assert before.infeasible == 0
    reasons = {STATUSES[status] for status in state.parts["failures"].status}
    assert report.infeasible == len(state.parts["failures"].status) > 0
    assert reasons <= {"limits", "compressible"}
    assert report.summary[f"infeasible.{min(reasons)}"] > 0


def test_an_evaluation_that_cannot_be_trusted_is_no_elite(experiment):
    fittest = []

    class TooFast(LocalDevices):
        def evaluate(self, *block, **options):
            found = super().evaluate(*block, **options)
            fittest.append(int(np.argmax(found.fitness)))
            status = np.where(np.arange(len(found.status)) == fittest[-1], 2, found.status)
            return eqx.tree_at(lambda evaluation: evaluation.status, found, status)

    state, report = replace(experiment, devices=TooFast()).advance(experiment.init())
    assert report.infeasible == 1
    assert state.parts["failures"].slot.tolist() == fittest
    assert fittest[0] not in np.asarray(state.elites.slot)[np.asarray(state.elites.occupied)]


@pytest.fixture
def failing(experiment):
    """The small run, three of whose creatures in a block of eight have failed."""

    program = experiment.plan.evaluate

    def evaluate(block):
        found = program.run(block)
        status = jnp.asarray([0, 1, 0, 2, 0, 1, 0, 0])
        return replace(found, status=status)

    plan = replace(experiment.plan, evaluate=replace(program, run=evaluate))
    return replace(experiment, plan=plan)


def test_reports_count_infeasible_creatures_by_reason_if_there_are_any(failing, course):
    _, report = failing.advance(failing.init())
    assert report.summary["infeasible.non-finite"] == 4
    assert report.summary["infeasible.supersonic"] == 2
    assert report.infeasible == 6
    reports = course.reports
    assert [report.infeasible for report in reports] == [0, 0, 0, 0]
    assert not [name for report in reports for name in report.summary if "infeasible" in name]


def sizes(report):
    return {int(number): members for number, members in SPECIES.of(report.summary).items()}


def test_every_member_of_a_generation_is_in_one_of_the_reported_species(course_of):
    states, reports, *_ = course_of("neuroevolution")
    for state, report in zip(states[1:], reports, strict=True):
        reported, species = sizes(report), state.emitters[0].species
        assert sum(reported.values()) == 16
        of = np.asarray(species.number)[np.asarray(species.of)]
        assert reported == {int(number): int((of == number).sum()) for number in np.unique(of)}
