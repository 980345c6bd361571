"""Replays show the measured creature; malformed replays are refused."""

import copy

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import build as builds
from microcosmos import fields, genomes, search, spec
from microcosmos.archive import creature
from microcosmos.audit.physics import audit
from microcosmos.audit.reproducibility import check, measurement
from microcosmos.build import build_block, build_encoding, build_task
from microcosmos.device import device_kind
from microcosmos.experiments.lineage import identity
from microcosmos.spec.creature.identity import Identity
from microcosmos.viz.raster import THEMES, frame
from microcosmos.viz.replay import actuator_of, record
from microcosmos.viz.replay_file import Replay, ReplayError, read_replay
from microcosmos.world import flow


@pytest.fixture(scope="module")
def best(best_of):
    parts = {"world": {"width": 40, "height": 32}, "body": {"nodes": 12}}
    with jax.numpy_rank_promotion("raise"):
        return best_of(
            4, **parts, control={"period": 30}, task={"steps": 601, "fitness": "displacement"}
        )


@pytest.fixture(scope="module")
def film(best):
    return read_replay(record(best))


def test_a_recorded_replay_is_read_and_drawn(film, best):
    assert film.header["creature"] == best["sha256"]
    assert (film.frames, film.size, film.header["every"]) == (201, (40, 32), 3)
    assert np.abs(film.vorticity).max() == pytest.approx(film.header["vorticity"]["scale"])
    assert not film.vorticity[0].any()
    middle = frame(film, 0, width=320)[128, 160]  # Where the body begins.
    np.testing.assert_array_equal(middle, THEMES["light"].ink)


def test_a_short_run_is_recorded_at_every_step(newcomer):
    film = read_replay(record(newcomer))
    assert (film.frames, film.size, film.step(-1 % film.frames)) == (41, (32, 32), 40)
    moved = np.linalg.norm(np.diff(film.centres[[0, -1], 0], axis=0))
    assert moved == pytest.approx(film.header["fitness"]["replayed"], abs=1e-4)


def test_the_body_begins_straight_in_the_middle_and_ends_where_the_fitness_says(film, best):
    np.testing.assert_allclose(film.positions[0].mean(0), [20, 16], atol=1e-5)
    np.testing.assert_allclose(np.diff(film.positions[0], axis=0), [[1, 0]] * 11, atol=1e-5)
    moved = np.linalg.norm(np.diff(film.centres[[0, -1], 0], axis=0))
    fitness = film.header["fitness"]
    # The last frame is one step before the end: 601 steps, every third kept.
    assert moved == pytest.approx(fitness["replayed"], abs=0.1)
    assert fitness["replayed"] == pytest.approx(best["measured"]["fitness"], rel=1e-3)
    assert fitness["difference"] == fitness["replayed"] - fitness["recorded"]


@pytest.mark.optimised
def test_a_check_repeats_every_recorded_number_exactly(best):
    result = check(best)
    assert result.same_device
    assert result.exact
    assert set(result.repeated) == set(search.MEASURES)
    report = measurement(best)
    assert (report["exact"], report["figures"]) == (True, [])
    assert report["fitness"]["measured"] == best["measured"]["fitness"]
    assert report["device"] == report["recorded_device"]


@pytest.mark.optimised
def test_a_check_notices_a_wrong_record(best):
    changed = copy.deepcopy(best)
    right = changed["measured"]["measures"]["path_length"]
    wrong = changed["measured"]["measures"]["path_length"] = right * (1 + 1e-12)
    assert not check(changed).exact
    (figure,) = measurement(changed)["figures"]
    assert figure == {"name": "path_length", "recorded": wrong, "measured": right}
    # Older files know fewer measures; what a file does not say is not compared.
    del changed["measured"]["measures"]["path_length"]
    assert check(changed).exact


@pytest.mark.parametrize(
    ("world", "steps", "nodes", "field"),
    [(2048, 100_000, 12, "task.steps"), (32, 1_000_000, 28, "body.nodes")],
)
def test_a_creature_that_is_too_much_to_watch_is_refused(best, world, steps, nodes, field):
    identity = copy.deepcopy(best["identity"])
    identity["world"] |= {"width": world, "height": world}
    identity["task"]["steps"], identity["body"]["nodes"] = steps, nodes
    identity["genome"]["control"]["length_scale"] = 0.0
    with pytest.raises(creature.CreatureError) as caught:
        record(creature.document(identity, None, None))
    assert caught.value.field == field


def test_a_check_needs_a_measurement(best):
    with pytest.raises(creature.CreatureError, match="`measured`"):
        check({**best, "measured": None})


@pytest.mark.long
def test_a_replay_holds_the_rest_shapes_as_they_were_applied(film, best):
    scene = creature.scene_of(best)
    encoding = build_encoding(scene, creature.room(best))
    task = build_task(scene)
    genes = genomes.read(best["identity"]["genome"], encoding)
    genotype = jax.tree.map(jnp.asarray, genes)
    rest = search.drive(task, genotype).inputs
    steps = np.maximum(np.arange(film.frames) * film.header["every"] - 1, 0)
    np.testing.assert_allclose(film.drive.angles, rest.angle[steps], atol=1e-6)
    np.testing.assert_allclose(film.drive.lengths, rest.length[steps], atol=1e-6)
    assert film.drive.energy.shape == (0, 40, 32)


def test_a_replay_holds_the_velocity_of_the_fluid(film, best):
    scene = creature.scene_of(best)
    task = build_task(scene)
    driven = search.drive(task, jax.tree.map(jnp.asarray, actuator_of(best, scene)))
    _, flows = search.simulate(driven, lambda state, measures: flow(task.world, state))
    quantum = film.header["velocity"]["scale"] / 127
    found = film.drive.velocity[30]
    np.testing.assert_allclose(found, flows[89], atol=0.51 * quantum + 1e-5)
    curl = film.vorticity[30]
    across, up = (np.roll(found[1 - k], -1, k) - np.roll(found[1 - k], 1, k) for k in (0, 1))
    np.testing.assert_allclose(0.5 * (across - up), curl, atol=1.1 * quantum + film.quantum)


@pytest.mark.parametrize("change", [{}, {"consume": True}])
def test_energy_is_kept_once_unless_it_changes(best, change):
    identity = copy.deepcopy(best["identity"])
    identity["world"]["energy"] = {"packets": 3, "width": 2.0} | change
    identity["task"]["steps"] = 60
    whole = Identity.model_validate(identity).model_dump(mode="json")
    film = read_replay(record(creature.document(whole, None, None)))
    assert len(film.drive.energy) == (film.frames if change else 1)
    packets = fields.packets((40, 32), fields.Packets(3, 2.0, 1.0, 0))
    np.testing.assert_allclose(film.drive.energy[0], packets, atol=0.003)
    if change:
        assert film.drive.energy[-1].sum() < film.drive.energy[0].sum()


@pytest.mark.fast
def test_reading_gives_back_what_was_written(replay_bytes):
    random = np.random.default_rng(1)
    positions, levels = random.normal(size=(3, 4, 2)), random.integers(-127, 128, (3, 6, 5))
    replay = read_replay(replay_bytes(positions, [[0, 1]], levels, scale=0.02))
    np.testing.assert_array_equal(replay.positions, positions.astype(np.float32))
    np.testing.assert_allclose(replay.vorticity, levels / 127 * 0.02, rtol=1e-6)
    assert replay.size == (6, 5)


def test_the_strongest_vorticity_leaves_out_one_value_in_a_hundred():
    levels = np.zeros(1000, np.int8)
    levels[:200] = -40
    levels[:2] = 127
    levels[2:5] = 100
    header = {"vorticity": {"scale": 1.27}, "edges": []}
    replay = Replay(header, np.zeros((1, 1, 2)), levels.reshape(1, 10, 100))
    assert replay.strongest == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"format": "microcosmos-replay/9"}, "format"),
        ({"frames": 0}, "frames"),
        ({"every": 1.5}, "every"),
        ({"nodes": None}, "nodes"),
        ({"frames": 3}, "bytes"),
        ({"size": [8]}, "size"),
        ({"edges": [[0, 2]]}, "edges"),
        ({"edges": {}}, "edges"),
        ({"vorticity": {"scale": 0}}, "vorticity.scale"),
        ({"member": [0, 2]}, "member"),
        ({"joints": None}, "joints"),
        ({"joints": [[0, 1]]}, "joints"),
        ({"velocity": {"scale": -1}}, "velocity.scale"),
        ({"energy": []}, "energy"),
        ({"energy": {"scale": 1, "frames": 3}}, "energy.frames"),
        ({"energy": {"scale": None, "frames": 0}}, "energy.scale"),
    ],
)
def test_bytes_that_are_no_replay_are_refused(replay_bytes, change, field):
    data = replay_bytes(np.ones((2, 2, 2)), [[0, 1]], np.zeros((2, 8, 8)), **change)
    with pytest.raises(ReplayError, match="needs") as caught:
        read_replay(data)
    assert caught.value.field == field


@pytest.mark.parametrize("data", [b"", b"\xff\0\0\0{}", b"\2\0\0\0{]", b"\2\0\0\0[]"])
def test_a_header_that_cannot_be_read_is_refused(data):
    with pytest.raises(ReplayError) as caught:
        read_replay(data)
    assert caught.value.field == ("header" if data else "bytes")


def test_positions_that_are_not_finite_are_refused(replay_bytes):
    data = replay_bytes(np.full((1, 2, 2), np.nan), [[0, 1]], np.zeros((1, 8, 8)))
    with pytest.raises(ReplayError, match="`positions` needs finite numbers"):
        read_replay(data)


NODES, STEPS, ROOM = 8, 24, (16, 32)
BASE = {"period": 12, "angle_scale": 0.3}
BENT = spec.Bounds(low=-0.1, high=0.1)


CONTROLS = {
    "recurrent": spec.Control(recurrent=True, **BASE),
    "direct": spec.Direct(rest_angle=BENT, bend=spec.Bounds(low=0.3, high=1.0), **BASE),
    "weights": spec.Weights(**BASE),
    "cppn-body": spec.Grown(**BASE),
}


@pytest.fixture(params=CONTROLS)
def file(request):
    """A creature that was measured as those of a run are."""
    scene = spec.Scene(
        world=spec.World(width=20, height=20),
        body=spec.Chain(nodes=NODES),
        control=CONTROLS[request.param],
        task=spec.Task(steps=STEPS, fitness="displacement"),
    )
    encoding = build_encoding(scene, ROOM)
    genotype = jax.device_get(encoding.newcomer(key=jax.random.key(7)))
    alone = jax.tree.map(lambda x: np.asarray(x)[None], genotype)
    found = search.evaluate_blocks(build_block(scene, ROOM), alone, block=2)
    assert found.status[0] == 0
    measures = dict(zip(search.MEASURES, found.measures[0].tolist(), strict=True))
    measured = {
        "fitness": float(found.fitness[0]),
        "descriptors": {name: measures[name] for name in ("hidden_nodes", "symmetry")},
        "measures": measures,
        "block": 2,
        "room": list(ROOM) if encoding.room else None,
        "device": device_kind(),
    }
    one = genomes.take(alone, 0)
    return creature.document(identity(builds.identity_template(scene), one), measured, None)


@pytest.mark.optimised
def test_a_creature_of_any_encoding_is_repeated_bit_for_bit(file):
    assert check(file).exact


@pytest.mark.long
def test_a_creature_of_any_encoding_is_watched_and_audited(file):
    replay = read_replay(record(file))
    nodes = int(file["measured"]["measures"]["nodes"])
    assert replay.header["nodes"] == nodes <= NODES
    assert replay.header["edges"] == [[i, i + 1] for i in range(nodes - 1)]
    recorded = file["measured"]["fitness"]
    np.testing.assert_allclose(replay.header["fitness"]["replayed"], recorded, rtol=1e-2)
    assert set(replay.header["descriptors"]["replayed"]) == {"hidden_nodes", "symmetry"}
    found = {row["name"]: row["value"] for row in audit(file)["rows"]}
    np.testing.assert_allclose(found["displacement"], recorded, rtol=1e-2)
    assert all(found[name] is not None for name in ("refined", "delta", "reciprocal"))
