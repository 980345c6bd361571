"""A replay shows the creature that was measured, and a check repeats its numbers."""

import copy
import json
import struct

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import fields, genomes, search
from microcosmos.archive import creature
from microcosmos.audit.reproducibility import check, measurement
from microcosmos.build import build, build_encoding, build_task
from microcosmos.spec import parse
from microcosmos.spec.creature.identity import Identity
from microcosmos.viz.replay import actuator_of, record
from microcosmos.viz.replay_file import read_replay
from microcosmos.world import flow

SPEC = parse(
    {
        "experiment": "quality-diversity",
        "world": {"width": 40, "height": 32},
        "body": {"nodes": 12},
        "control": {"period": 30},
        "task": {"steps": 601},
        "search": {"generations": 1, "batch": 4, "block": 4},
    }
)


@pytest.fixture(scope="module")
def best():
    """The creature file of the best of four random creatures."""
    with jax.numpy_rank_promotion("raise"):
        experiment = build(SPEC)
        return experiment.best(experiment.advance(experiment.init())[0])


@pytest.fixture(scope="module")
def replay(best):
    data = record(best)
    (size,) = struct.unpack("<I", data[:4])
    header = json.loads(data[4 : 4 + size])
    start = 4 + size
    shape = header["frames"], header["nodes"], 2
    positions = np.frombuffer(data, "<f4", np.prod(shape), start).reshape(shape)
    frames, edges, joints = header["frames"], len(header["edges"]), len(header["joints"])
    behind = start + positions.nbytes + 4 * frames * (joints + edges)
    size = header["size"]
    curl = np.frombuffer(data, np.int8, frames * size[0] * size[1], behind)
    return header, positions, curl.reshape(frames, *size)


def test_the_layout_is_what_the_header_says(replay, best):
    header, _, curl = replay
    assert header["creature"] == best["sha256"]
    assert header["every"] == 3
    assert header["frames"] == 201
    assert header["size"] == [40, 32]
    assert np.abs(curl).max() == 127
    assert not curl[0].any()


def test_the_body_begins_straight_in_the_middle(replay):
    _, positions, _ = replay
    np.testing.assert_allclose(positions[0].mean(0), [20, 16], atol=1e-5)
    np.testing.assert_allclose(np.diff(positions[0], axis=0), [[1, 0]] * 11, atol=1e-5)


def test_the_motion_ends_where_the_fitness_says(replay, best):
    header, positions, _ = replay
    moved = np.linalg.norm(positions[-1].mean(0) - positions[0].mean(0))
    replayed = header["fitness"]["replayed"]
    # The last frame is one step before the end: 601 steps, every third kept.
    assert moved == pytest.approx(replayed, abs=0.1)
    assert replayed == pytest.approx(best["measured"]["fitness"], rel=1e-3)
    assert header["fitness"]["difference"] == replayed - header["fitness"]["recorded"]


@pytest.mark.optimised
def test_a_check_repeats_every_recorded_number_exactly(best):
    result = check(best)
    assert result.same_device
    assert result.exact
    assert set(result.repeated) == set(search.MEASURES)
    told = measurement(best)
    assert (told["exact"], told["figures"]) == (True, [])
    assert told["fitness"]["measured"] == best["measured"]["fitness"]
    assert told["device"] == told["recorded_device"]


@pytest.mark.optimised
def test_a_check_notices_a_wrong_record(best):
    changed = copy.deepcopy(best)
    right = changed["measured"]["measures"]["path_length"]
    wrong = changed["measured"]["measures"]["path_length"] = right * (1 + 1e-12)
    assert not check(changed).exact
    (told,) = measurement(changed)["figures"]
    assert told == {"name": "path_length", "recorded": wrong, "measured": right}
    # Older files know fewer measures; what a file does not say is not compared.
    del changed["measured"]["measures"]["path_length"]
    assert check(changed).exact


@pytest.mark.parametrize(
    ("part", "change", "field"),
    [
        ("world", {"width": 2048, "height": 2048}, "task.steps"),
        ("task", {"steps": 1_000_000}, "body.nodes"),
    ],
)
def test_a_creature_that_is_too_much_to_watch_is_refused(best, part, change, field):
    identity = copy.deepcopy(best["identity"])
    identity[part] |= change
    if part == "world":
        identity["task"]["steps"] = 100_000
    else:
        identity["world"] |= {"width": 32, "height": 32}
        identity["genome"]["control"]["length_scale"] = 0.0
        identity["body"]["nodes"] = 28
    with pytest.raises(creature.CreatureError) as caught:
        record(creature.document(identity, None, None))
    assert caught.value.field == field


def test_a_check_needs_a_measurement(best):
    with pytest.raises(creature.CreatureError, match="`measured`"):
        check({**best, "measured": None})


def test_a_replay_holds_the_rest_shapes_as_they_were_applied(best):
    film = read_replay(record(best))
    assert film.drive is not None
    scene = creature.scene_of(best)
    encoding = build_encoding(scene, creature.room(best))
    task = build_task(scene)
    genotype = jax.tree.map(
        jnp.asarray, genomes.read(best["identity"]["genome"], encoding.room)
    )
    rest = search.drive(task, genotype).inputs
    steps = np.maximum(np.arange(film.frames) * film.header["every"] - 1, 0)
    np.testing.assert_allclose(film.drive.angles, rest.angle[steps], atol=1e-6)
    np.testing.assert_allclose(film.drive.lengths, rest.length[steps], atol=1e-6)
    assert film.drive.energy.shape == (0, 40, 32)


def test_a_replay_holds_the_velocity_of_the_fluid(best):
    film = read_replay(record(best))
    assert film.drive is not None
    scene = creature.scene_of(best)
    task = build_task(scene)
    driven = search.drive(task, jax.tree.map(jnp.asarray, actuator_of(best, scene)))
    _, flows = search.simulate(driven, lambda state, measures: flow(task.world, state))
    quantum = film.header["velocity"]["scale"] / 127
    found = film.drive.velocity[30]
    np.testing.assert_allclose(found, flows[89], atol=0.51 * quantum + 1e-5)
    curl = film.vorticity[30]
    across, up = (
        (np.roll(found[1], -1, 0) - np.roll(found[1], 1, 0)),
        (np.roll(found[0], -1, 1) - np.roll(found[0], 1, 1)),
    )
    np.testing.assert_allclose(0.5 * (across - up), curl, atol=1.1 * quantum + film.quantum)


@pytest.mark.parametrize("change", [{}, {"consume": True}])
def test_energy_is_kept_once_unless_it_changes(best, change):
    identity = copy.deepcopy(best["identity"])
    identity["world"]["energy"] = {"packets": 3, "width": 2.0} | change
    identity["task"]["steps"] = 60
    file = creature.document(
        Identity.model_validate(identity).model_dump(mode="json"), None, None
    )
    film = read_replay(record(file))
    assert film.drive is not None
    assert len(film.drive.energy) == (film.frames if change else 1)
    packets = fields.packets((40, 32), fields.Packets(3, 2.0, 1.0, 0))
    np.testing.assert_allclose(film.drive.energy[0], packets, atol=0.003)
    if change:
        assert film.drive.energy[-1].sum() < film.drive.energy[0].sum()
