"""Replays show the measured creature; malformed replays are refused."""

import copy

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import build as builds
from microcosmos import genomes, search, spec
from microcosmos.archive import creature
from microcosmos.audit.physics import audit
from microcosmos.audit.reproducibility import check, measurement
from microcosmos.build import build_block, build_encoding, build_task
from microcosmos.device import device_kind
from microcosmos.search.parts.records import identity
from microcosmos.viz.raster import THEMES, frame
from microcosmos.viz.replay import actuator_of, record
from microcosmos.viz.replay_file import ReplayError, read_replay
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


@pytest.mark.long
def test_measures_of_several_trials_are_combined_as_in_an_evaluation(best_of):
    """The largest Mach number counts, the mean of the others."""
    axes = [{"name": "mach", "bins": 4}, {"name": "mean_speed", "bins": 4}]
    best = best_of(
        4,
        world={"width": 24, "height": 24},
        body={"nodes": 8},
        control={"period": 20},
        task={"steps": 40, "trials": 4, "fitness": "displacement"},
        archive={"descriptors": axes},
    )
    found = read_replay(record(best)).header["descriptors"]
    assert found["replayed"] == pytest.approx(found["recorded"], rel=1e-3)


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
    assert measurement(changed)["missing"] == ["path_length"]
    # The reader allows a fitness that a compiler has fused; its bits count all the same.
    fitness = changed["measured"]["fitness"]
    changed["measured"]["fitness"] = fitness * (1 + 3e-6)
    report = measurement(changed)
    assert (report["exact"], report["fitness"]["measured"]) == (False, fitness)


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
