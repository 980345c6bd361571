"""A search with an archive: it only improves, keeps lineages, and can be extended."""

import json
from dataclasses import replace

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

import microcosmos
from microcosmos import naming, search
from microcosmos.archive import creature, file, poses, variety
from microcosmos.build import build, build_task
from microcosmos.search import MEASURES, STATUSES, LocalDevices, tensorneat
from microcosmos.spec import parse
from microcosmos.spec.evolution import UNLIMITED


@pytest.mark.long
def test_another_seed_gives_another_archive(small, course, experiment, finish):
    other = build(small().model_copy(update={"seed": 4}))
    assert finish(other, other.init()) != experiment.save(course[0][-1])


def test_the_archive_only_improves(course):
    reports = course.reports
    assert [r.evaluations for r in reports] == [16, 32, 48, 64]
    for name in ("qd_score", "coverage", "best"):
        values = [getattr(report, name) for report in reports]
        assert values == sorted(values)


@pytest.mark.long
def test_a_large_archive_is_overwritten_and_ends_with_the_same_bytes(small, finish):
    axes = [{"name": name, "bins": 65} for name in ("symmetry", "curvature_mean")]
    large = build(small(archive={"descriptors": axes}))
    copying = replace(large.programs, overwrite=large.programs.insert)
    first, before = large.init(), large.init()
    data = finish(large, first)
    assert data == finish(replace(large, programs=copying), before)
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
        assert elite.creature == bytes(states[-1].creatures[cell]).hex()
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
    cells = np.flatnonzero(state.elites.occupied)
    assert [one.creature for one in found] == [bytes(x).hex() for x in state.creatures[cells]]
    task = build_task(course.spec.scene, room=experiment.plan.encoding.room)
    for cell, one in list(zip(cells, found, strict=True))[::5]:
        genotype = jax.tree.map(lambda x, cell=cell: x[cell], state.elites.genotypes)
        driven = search.drive(task, genotype)
        _, seen = search.simulate(driven, lambda state, measures: state.positions)
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


@pytest.mark.long
def test_random_variation_has_no_parents(small, carry_out):
    spec = small(search={"emitters": [{"operator": "random"}], "generations": 2})
    for report in carry_out(build(spec))[1]:
        assert all(not elite.parents for elite in report.elites)
        assert report.elites


def test_a_run_cannot_be_shortened(experiment, course, lasting):
    whole = experiment.save(course[0][-1])
    with pytest.raises(ValueError, match=r"`search.generations` must be at least .* 4, got 3"):
        lasting(experiment, 3).restore(whole)


def test_a_run_that_reached_its_goal_ends_there_however_many_generations_follow(
    experiment, course, finish, lasting
):
    goal = replace(experiment.plan.limits, evaluations=30)
    stopping = replace(experiment, plan=replace(experiment.plan, limits=goal))
    ended = finish(stopping, stopping.init())
    more = lasting(stopping, 9)
    assert finish(more, more.restore(ended)) == finish(more, more.init())


def test_elites_are_marked_with_the_device_that_measured_them(experiment, course):
    data = experiment.save(replace(course[0][1], devices=("abacus",)))
    allowed = experiment.restore(data, other_device=True)
    assert allowed.devices == ("abacus", experiment.plan.device)
    later, report = experiment.advance(allowed)
    again = experiment.restore(experiment.save(later))
    assert again.devices == allowed.devices
    new = {elite.cell for elite in report.elites}
    for cell in np.flatnonzero(again.elites.occupied).tolist():
        measured_on = experiment.creature(again, cell)["measured"]["device"]
        assert measured_on == (experiment.plan.device if cell in new else "abacus")


def test_infeasible_creatures_are_kept_apart_with_their_reason(small):
    unlimited = {"limits": False, "projection": "none", "theta_feedback": 0}
    spec = small(
        world={"width": 32, "height": 32, "viscosity": 0.001},
        control={"period": 8, "angle_scale": 1.5, "length_scale": 0.8, "ramp": 0} | UNLIMITED,
        body={"nodes": 8},
        coupling=unlimited,
        task={"steps": 120},
        search={"generations": 2, "feasible": False},
    )
    experiment = build(spec)
    state, first = experiment.advance(experiment.init())
    state, second = experiment.advance(state)
    assert first.infeasible > 0
    assert second.infeasible == len(state.failures.status)
    assert set(np.unique(state.failures.status)) <= {1, 2}
    assert np.isfinite(np.asarray(state.elites.fitness)).all()
    restored = experiment.restore(experiment.save(state))
    assert experiment.save(restored) == experiment.save(state)


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
    reasons = {STATUSES[status] for status in state.failures.status}
    assert report.infeasible == len(state.failures.status) > 0
    assert reasons <= {"limits", "compressible"}
    assert report.summary[f"infeasible: {min(reasons)}"] > 0


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
    assert state.failures.slot.tolist() == fittest
    assert fittest[0] not in np.asarray(state.elites.slot)[np.asarray(state.elites.occupied)]


def test_the_file_names_what_it_holds(experiment, course):
    tree, attributes = file.load(experiment.save(course[0][-1]))
    assert json.loads(attributes["measures"]) == list(MEASURES)
    assert json.loads(attributes["device"]) == [experiment.plan.device]
    count = len(tree["archive"]["cell"])
    assert all(len(v) == count for v in tree["archive"].values() if not isinstance(v, dict))
    assert len(tree["curves"]["qd_score"]) == 4
    assert len(tree["lineage"]["creature"]) >= count


@pytest.fixture
def failing(experiment):
    """The small run, three of whose creatures in a block of eight have failed."""

    def evaluate(block):
        found = experiment.programs.evaluate_block(block)
        status = jnp.asarray([0, 1, 0, 2, 0, 1, 0, 0])
        return replace(found, status=status)

    return replace(experiment, programs=replace(experiment.programs, evaluate_block=evaluate))


def test_reports_count_infeasible_creatures_by_reason_if_there_are_any(failing, course):
    _, report = failing.advance(failing.init())
    assert report.summary["infeasible: non-finite"] == 4
    assert report.summary["infeasible: supersonic"] == 2
    assert report.infeasible == 6
    reports = course.reports
    assert [report.infeasible for report in reports] == [0, 0, 0, 0]
    assert not [name for report in reports for name in report.summary if "infeasible" in name]


def sizes(report):
    pairs = (one.split(":") for one in report.summary["species"].split())
    return {int(number): int(members) for number, members in pairs}


def test_every_member_of_a_generation_is_in_one_of_the_reported_species(course_of):
    states, reports, *_ = course_of("neuroevolution")
    for state, report in zip(states[1:], reports, strict=True):
        reported, species = sizes(report), state.emitters[0].species
        assert sum(reported.values()) == 16
        of = np.asarray(species.number)[np.asarray(species.of)]
        assert reported == {int(number): int((of == number).sum()) for number in np.unique(of)}


@pytest.mark.skipif(
    not tensorneat.available(), reason="tensorneat is not installed: make tensorneat"
)
@pytest.mark.filterwarnings("ignore")
def test_species_of_tensorneat_are_those_of_the_measured_generation(carry_out, specs):
    backend = {"backend": "tensorneat", "preset": "tensorneat", "threshold": 0.3}
    with jax.numpy_rank_promotion("allow"):
        states, reports = carry_out(build(parse(specs["neuroevolution"] | {"neat": backend})))
    assert sizes(reports[0]) == {0: 16}, "at first there is one"
    for state, report in zip(states[1:], reports, strict=True):
        arrays = state.emitters[0].arrays
        table = zip(arrays["species.species_keys"], arrays["species.member_count"], strict=True)
        assert sizes(report) == {int(key): int(count) for key, count in table if count > 0}
        assert sum(sizes(report).values()) == 16
    assert max(len(sizes(report)) for report in reports) > 1


def test_a_search_without_a_population_reports_no_species(course):
    assert not [report for report in course[1] if "species" in report.summary]
