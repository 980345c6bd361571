"""Worlds with slots: the kernel against JAX, what changes no bit, and what is conserved."""

from dataclasses import replace
from functools import partial, reduce

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from crowds import (
    BODIES,
    PERIOD,
    SLOTS,
    birth,
    contact,
    crowd,
    food,
    in_jax,
    in_kernel,
    ledger,
    momentum,
    newborns,
    reordered,
    same,
    task_of,
)
from kernel_scenes import chain, heap, meeting, single
from kernel_scenes import in_jax as in_steps

from microcosmos import bodies, coupling, fields, fluid, world
from microcosmos.genomes.living import live, newborn
from microcosmos.world import nodes, slots

kernels = pytest.importorskip(
    "microcosmos_kernels", reason="microcosmos-kernels is not installed: no compiler?"
)
QUICK = ("soft chains", "bodies from plans")
EVERY = 3


def kinds(quick=QUICK):
    return pytest.mark.parametrize(
        "name",
        [pytest.param(one, marks=() if one in quick else pytest.mark.long) for one in BODIES],
    )


def apart(one, other, size):
    """The largest distance of two sets of places along an axis of a periodic box."""
    away = np.asarray(one) - np.asarray(other)
    return np.abs(away - size * np.round(away / size)).max()


def agree(of_kernel, of_jax, share):
    """Compare measures, to a share of the largest of each; floors flip single quanta."""
    for name in ("displacement", "path", "turned", "work", "contact", "limited", "mach"):
        expected = np.asarray(getattr(of_jax, name))
        most = np.abs(expected).max()
        assert most > 0 or name in ("contact", "limited"), name
        np.testing.assert_allclose(
            getattr(of_kernel, name), expected, rtol=0, atol=share * most + 2e-5, err_msg=name
        )
    np.testing.assert_array_equal(of_kernel.touched, of_jax.touched)
    np.testing.assert_allclose(of_kernel.capped, of_jax.capped, atol=1)
    for name in ("intake", "grown", "lost"):
        expected = np.asarray(getattr(of_jax, name), float)
        if expected.shape[1:]:
            expected, found = (
                4096.0 * np.asarray(one)[:, 0] + np.asarray(one)[:, 1]
                for one in (getattr(of_jax, name), getattr(of_kernel, name))
            )
        else:
            found = np.asarray(getattr(of_kernel, name), float)
        assert expected.max() > 0, name
        np.testing.assert_allclose(found, expected, rtol=share, atol=500, err_msg=name)


@kinds()
def test_the_kernel_lives_as_jax(name):
    """Contact and senses make differences grow, so bounds grow with the steps."""
    place, held, living = crowd(name, count=6)
    found = expected = living
    for near in (5e-5, 2e-4, 2e-3):
        expected, of_jax = in_jax(place, held, expected, 10, EVERY)
        found, of_kernel = in_kernel(place, held, found, 10, EVERY)
        assert apart(found.positions, expected.positions, 48) < near
        assert np.abs(found.angles - expected.angles).max() < 10 * near
        for plane, other in zip(found.populations, expected.populations, strict=True):
            np.testing.assert_allclose(plane, other, atol=near)
        for shape in ("command", "paced", "rest"):
            one, other = getattr(found, shape), getattr(expected, shape)
            np.testing.assert_allclose(one.angle, other.angle, atol=100 * near)
            np.testing.assert_allclose(one.length, other.length, atol=100 * near)
        np.testing.assert_array_equal(found.age, expected.age)
        away = np.abs(np.asarray(found.food - expected.food))
        assert np.percentile(away, 99) <= 10, np.percentile(away, [50, 99, 100])
        agree(of_kernel, of_jax, 20 * near)
    assert np.abs(found.positions - living.positions).max() > 0.01


@pytest.mark.parametrize("two", [False, pytest.param(True, marks=pytest.mark.long)])
def test_creatures_sense_and_take_the_energy_of_the_paper(two):
    senses = ("energy", "energy_across", "energy_along")
    place, held, living = crowd(count=4, senses=senses, fed=False)
    packets = fields.packets((48, 48), fields.Packets(5, 4.0, 1.0, 0))
    energy = fields.Energy(single(packets), single(0.05), single(0.1))
    form = replace(place.form, layers=2) if two else place.form
    place = replace(place, energy=energy, form=form)
    living = replace(living, energy=energy.start, collected=jnp.zeros((SLOTS, 12)))
    end, of_jax = in_jax(place, held, living, 20, EVERY)
    found, of_kernel = in_kernel(place, held, living, 20, EVERY)
    assert apart(found.positions, end.positions, 48) < 2e-4
    np.testing.assert_allclose(found.energy, end.energy, atol=1e-4)
    np.testing.assert_allclose(found.collected, end.collected, atol=1e-4)
    np.testing.assert_allclose(of_kernel.intake, of_jax.intake, atol=1e-3)
    assert np.max(of_jax.intake) > 0.1
    assert np.abs(end.command.angle - living.command.angle).max() > 0.01


@pytest.mark.parametrize("every", [1, 5, 20])
def test_food_changes_in_the_kernel_as_in_jax(every):
    """Nobody lives: a uniform force drives the water past walls."""
    place, held, living = crowd(count=1)
    solid = jnp.zeros((48, 48), bool).at[10, 5:30].set(True).at[30].set(True)
    around = fluid.Surroundings(force=single([2e-4, -1e-4]), solid=solid)
    given = replace(food(), every=every)
    place = replace(place, surroundings=around, food=given)
    random = np.random.default_rng(0)
    cells = np.where(solid, 0, random.integers(0, 2**18, (48, 48)))
    nobody = replace(held, filled=jnp.zeros_like(held.filled))
    living = replace(living, food=jnp.asarray(cells, jnp.int32))
    end, of_jax = in_jax(place, nobody, living, 40)
    found, of_kernel = in_kernel(place, nobody, living, 40)
    assert np.abs(end.food - living.food).max() > 1000
    # Velocities differ in their last digits, so a floor may give one quantum more.
    assert np.abs(found.food - end.food).max() <= 20
    assert np.mean(found.food != end.food) < 0.2
    assert not np.any(found.food[30] > np.asarray(given.capacity)[30])
    for one, other in ((of_kernel.grown, of_jax.grown), (of_kernel.lost, of_jax.lost)):
        assert abs(fields.food.total(one) - fields.food.total(other)) < 2000


@kinds(("chains", "bodies from plans"))
def test_neither_threads_nor_slots_nor_windows_change_a_bit(name):
    place, held, living = crowd(name, count=6, seed=1)
    end, tally = in_kernel(place, held, living, 40, EVERY)
    for threads in (2, 3, 4):
        assert same((end, tally), in_kernel(place, held, living, 40, EVERY, None, threads))
    for instructions in kernels.instruction_sets():
        assert same((end, tally), in_kernel(place, held, living, 40, EVERY, instructions))
    split = living
    for steps in (1, 7, 32):
        split, _ = in_kernel(place, held, split, steps, EVERY)
    assert same(split, end)
    order = np.random.default_rng(2).permutation(SLOTS)
    moved = in_kernel(place, reordered(held, order), reordered(living, order), 40, EVERY)
    assert same(moved, (reordered(end, order), reordered(tally, order)))
    filled = np.flatnonzero(held.filled)
    few = in_kernel(place, reordered(held, filled), reordered(living, filled), 40, EVERY)
    assert same(few, (reordered(end, filled), reordered(tally, filled)))


def test_empty_slots_stay_as_they_were_and_a_world_may_be_empty():
    place, held, living = crowd(count=3)
    nobody = replace(held, filled=jnp.zeros_like(held.filled))
    end, tally = in_kernel(place, nobody, living, 20)
    expected, of_jax = in_jax(place, nobody, living, 10)
    expected, _ = in_jax(place, nobody, expected, 10)
    assert same(
        replace(end, **{n: getattr(living, n) for n in ("populations", "food", "time")}), living
    )
    assert not np.any(tally.path)
    assert not np.any(of_jax.path)
    assert np.abs(end.food - expected.food).max() <= 1


@pytest.mark.parametrize("simulate", [in_kernel, pytest.param(in_jax, marks=pytest.mark.long)])
def test_no_quantum_is_lost_in_windows_with_births_and_deaths(simulate):
    compiled, born = None, 0
    for balanced, last in ledger(simulate, 60):
        assert balanced
        born = last[-1]
        # A birth, a death and another creature in a slot compile nothing.
        compiled = compiled or simulate._cache_size()
        assert simulate._cache_size() == compiled
    assert born > 10


def test_a_great_age_is_no_other_clock():
    place, held, living = crowd(senses=(), fed=False)
    grown_up = replace(living, age=jnp.full_like(living.age, int(PERIOD) + 7))
    old = replace(living, age=grown_up.age + 40_000 * int(PERIOD))
    young_end, old_end = (in_kernel(place, held, one, 30)[0] for one in (grown_up, old))
    assert same(replace(old_end, age=young_end.age), young_end)


def test_two_creatures_in_one_place_swim_as_one_where_nothing_parts_them():
    place, held, living = crowd(count=1, touch=False, fed=False, senses=())
    slot = int(np.flatnonzero(held.filled)[0])
    one = jax.tree.map(lambda x: x[slot], held.occupants)
    other = (slot + 1) % SLOTS
    both, two = birth(held, living, other, one, living.positions[slot], 1, 0)
    two = replace(two, age=two.age.at[other].set(two.age[slot]))
    alone, _ = in_kernel(place, held, living, 200)
    pair, _ = in_kernel(place, both, two, 200)
    np.testing.assert_array_equal(pair.positions[slot], pair.positions[other])
    moved = np.abs(alone.positions[slot] - living.positions[slot]).max()
    assert moved > 0.5
    np.testing.assert_allclose(pair.positions[slot], alone.positions[slot], atol=1e-3 * moved)


def test_copies_in_a_larger_box_do_the_same():
    place, held, living = crowd(count=2, room=2, senses=("flow_along", "touch"), fed=False)
    end, _ = in_kernel(place, held, living, 100)
    large, _, _ = crowd(count=1, room=8, side=96, senses=("flow_along", "touch"), fed=False)
    copies = jax.tree.map(lambda x: jnp.concatenate([x] * 4), held)
    copies = replace(copies, number=jnp.arange(8))
    four = {
        name: jax.tree.map(lambda x: jnp.concatenate([x] * 4), getattr(living, name))
        for name in ("positions", "angles", "boxes", "age", "command", "paced", "rest")
    }
    shift = 48.0 * np.repeat([[0, 0], [0, 1], [1, 0], [1, 1]], 2, axis=0)
    four["positions"] = four["positions"] + jnp.float32(shift)[:, None]
    planes = tuple(jnp.tile(plane, (2, 2)) for plane in living.populations)
    many = replace(living, populations=planes, **four)
    found, _ = in_kernel(large, copies, many, 100)
    for copy in range(4):
        at = slice(2 * copy, 2 * copy + 2)
        places = found.positions[at] + 96 * found.boxes[at][:, None]
        expected = end.positions + 48 * end.boxes[:, None] + np.float32(shift[at])[:, None]
        np.testing.assert_allclose(places, expected, atol=1e-4)


@kinds(("chains",))
def test_creatures_push_the_water_nowhere(name):
    place, held, living = crowd(name, count=6, seed=4)
    end, tally = in_kernel(place, held, living, 400, EVERY)
    moving = momentum(end)
    assert np.abs(moving).sum() > 0.1
    assert np.all(np.asarray(tally.path)[np.asarray(held.filled)] > 0)
    np.testing.assert_allclose(moving.sum((0, 1)), 0, atol=2e-6 * np.abs(moving).sum())


def test_who_is_far_away_changes_no_bit():
    place, held, living = crowd(count=3, side=128, seed=3)
    filled = np.flatnonzero(held.filled)
    where = np.stack([[20.0, 20.0], [24.0, 30.0], [84.0, 84.0]])
    middles = np.asarray(living.positions).mean(1)
    for slot, at in zip(filled, where, strict=True):
        shifted = living.positions[slot] + np.float32(at - middles[slot])[None]
        living = replace(living, positions=living.positions.at[slot].set(shifted))
    # Each step a cell further by streaming, and two windows of four cells an iteration.
    steps = 2
    with_it, _ = in_kernel(place, held, living, steps)
    without, _ = in_kernel(place, slots.removed(held, int(filled[2])), living, steps)
    for slot in filled[:2]:
        for name in ("positions", "angles", "account"):
            np.testing.assert_array_equal(
                getattr(with_it, name)[slot], getattr(without, name)[slot]
            )
    assert np.any(with_it.positions[filled[2]] != without.positions[filled[2]])


@pytest.mark.parametrize("way", [(0.0, 0.0), (17.3, -20.2)])
def test_the_density_of_pairs_is_that_of_the_lattice(way):
    box, start, _ = meeting(heap(), matched=True)
    places = start.positions + np.float32(way)[None]
    at = coupling.windows(places, box.size, coupling.HAT)
    member = np.asarray(box.groups.member)

    def gradient(body):
        ones = jnp.asarray(member == body, jnp.float32)[:, None]
        plane = coupling.spread(ones, at, box.size)[0]
        return coupling.interpolate(fields.binomial(plane), at)

    of_others = np.where((member == 0)[:, None], gradient(1), gradient(0))
    found = fields.density(places, box.size, jnp.asarray(member[:, None] != member[None]))
    assert np.abs(of_others).max() > 0.05
    np.testing.assert_allclose(found.gradient, of_others, atol=1e-6)


def test_the_kernel_counts_contact_with_obstacles_as_jax():
    place, held, living = crowd(count=4, side=48, seed=5)
    solid = np.zeros((48, 48), bool)
    solid[::12, ::3] = True
    place = replace(
        place,
        surroundings=fluid.Surroundings(solid=jnp.asarray(solid)),
        barrier=fields.Barrier(single(fields.away(solid)), single(0.1)),
    )
    end, of_jax = in_jax(place, held, living, 10)
    found, of_kernel = in_kernel(place, held, living, 10)
    assert np.max(of_jax.contact) > 0.1
    np.testing.assert_allclose(of_kernel.contact, of_jax.contact, atol=1e-3)
    assert apart(found.positions, end.positions, 48) < 1e-3


@pytest.mark.parametrize("strength", [0.5, 4.0, 400.0])
def test_contact_moves_no_cluster_as_a_whole(strength):
    box, start, _ = meeting(heap(), matched=True, strength=strength)
    found = nodes.repel(box, start.positions)
    drift = np.asarray(found.drift)
    assert np.abs(drift).max() > 1e-3
    np.testing.assert_allclose(drift.sum(0), 0, atol=1e-6)
    assert found.touched.all()
    assert found.limited.all() == found.limited.any() == (strength > 4)
    # The centre and the farthest node by rotation move by the limit at most.
    assert np.abs(drift).max() <= 2 * 0.1 + 1e-6


def test_one_factor_holds_for_all_that_touch_each_other():
    """Of three filaments side by side the first two are close; two others touch far away."""
    rows = ((10.0, 10.0), (11.0, 10.0), (15.5, 10.0), (34.0, 30.0), (38.5, 30.0))
    body = bodies.combined([bodies.placed(chain(11), at, np.pi / 2) for at in rows])
    box, start, rest = meeting(body, matched=True, strength=20.0)
    given = nodes.repel(box, start.positions)
    assert given.touched.all()
    np.testing.assert_array_equal(given.limited, [True, True, True, False, False])
    drift = np.asarray(given.drift).reshape(5, 11, 2)
    np.testing.assert_allclose(drift[:3].sum((0, 1)), 0, atol=1e-5)
    alone = replace(box, contact=contact(20.0, 1e9))
    free = np.asarray(nodes.repel(alone, start.positions).drift).reshape(5, 11, 2)
    factor = np.linalg.norm(drift[:3], axis=2).sum() / np.linalg.norm(free[:3], axis=2).sum()
    assert factor < 0.9
    np.testing.assert_allclose(drift[:3], factor * free[:3], atol=1e-5)
    np.testing.assert_array_equal(drift[3:], free[3:])
    one = jax.tree.map(lambda x: np.asarray(x)[:1], rest)
    end, _ = jax.jit(in_steps)(box, start, one)
    for threads in (1, 2):
        found, _ = jax.jit(partial(world.native.rollout, threads=threads))(box, start, one)
        np.testing.assert_allclose(found.positions, end.positions, atol=2e-5)


def test_an_eater_gets_its_part_rounded_down_and_the_rest_stays():
    cells = jnp.zeros((8, 8), jnp.int32).at[2, 3].set(10).at[7, 0].set(100).at[0, 0].set(5)
    places = jnp.float32([[2.2, 3.1], [1.8, 2.9], [2.4, 3.4], [-1.1, 8.2], [7.6, 7.6], [4, 4]])
    left, ate = fields.eaten(cells, places, jnp.array([1, 1, 1, 1, 1, 1], bool), jnp.float32(7))
    np.testing.assert_array_equal(ate, [3, 3, 3, 7, 5, 0])
    assert int(left[2, 3]) == 1
    assert int(left[7, 0]) == 93
    assert int(left[0, 0]) == 0
    assert int(left.sum() + ate.sum()) == int(cells.sum())
    _, ate = fields.eaten(cells, places, jnp.array([1, 0, 0, 0, 1, 1], bool), jnp.float32(7))
    np.testing.assert_array_equal(ate, [7, 0, 0, 0, 5, 0])


def total(cells):
    return int(np.asarray(cells, np.int64).sum())


def test_food_drifts_with_the_water_and_none_passes_walls():
    given = replace(food(64, regrowth=0.0, decay=0.0, diffusion=0.0), every=20)
    x = np.arange(64)
    blob = np.exp(-((x[:, None] - 20) ** 2 + (x[None] - 30) ** 2) / 50)
    start = jnp.asarray(2**22 * blob, jnp.int32)
    velocity = jnp.stack([jnp.full((64, 64), 0.03), jnp.full((64, 64), -0.01)])
    moved = start
    for _ in range(20):
        moved, grew, lost = fields.changed(moved, given, velocity, None)
        assert not np.any(grew)
        assert not np.any(lost)
    assert total(moved) == total(start)
    middle = [
        float(
            (np.asarray(moved, float).sum(1 - axis) * x).sum() / np.asarray(start, float).sum()
        )
        for axis in (0, 1)
    ]
    # 400 steps; what is rounded towards zero stays behind.
    np.testing.assert_allclose(middle, [20 + 12, 30 - 4], atol=0.1)
    solid = jnp.zeros((64, 64), bool).at[26].set(True).at[60].set(True)
    start = start.at[26].set(0).at[60].set(0)
    kept = start
    for _ in range(40):
        kept, _, _ = fields.changed(
            kept, replace(given, diffusion=jnp.float32(0.2)), velocity, solid
        )
    assert total(kept[61:]) + total(kept[:26]) == total(start[61:]) + total(start[:26])
    assert not np.any(kept[26])


def test_food_regrows_to_its_capacity_and_decays():
    given = food(16, regrowth=0.5, decay=0.0, diffusion=0.0)
    still = jnp.zeros((2, 16, 16))
    left = given.capacity // 5
    for _ in range(40):
        left, _, _ = fields.changed(left, given, still, None)
    assert np.abs(left - given.capacity).max() <= 1
    gone, grew, lost = fields.changed(
        left, replace(given, decay=jnp.float32(0.25)), still, None
    )
    np.testing.assert_allclose(gone - left, -left / 4 + left / 8, atol=2)
    assert fields.food.total(lost) - fields.food.total(grew) == total(left - gone)


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"size": (12, 48)}, "`size` must be at least 16"),
        (
            {"steric": fields.Steric(single(4.0), single(0.1), fields.binomial)},
            "`steric` or `contact`",
        ),
    ],
)
def test_worlds_in_which_bodies_cannot_meet_are_refused(change, named):
    box, _, _ = meeting(heap(), matched=True)
    with pytest.raises(ValueError, match=named):
        replace(box, **change)


def changed(tree, path, value):
    """Return slots, or their state, with the first number of an array replaced."""

    def found(tree):
        return reduce(getattr, path.split("."), tree)

    array = jnp.asarray(found(tree))
    wrong = array.reshape(-1).at[0].set(value).reshape(array.shape)
    return eqx.tree_at(found, tree, wrong)


@pytest.mark.parametrize(
    ("path", "value", "reason"),
    [
        ("slots.occupants.rods.edges", 99, "refers to what it lacks"),
        ("slots.occupants.rods.joints", -1, "refers to what it lacks"),
        ("slots.occupants.network.source", 99, "refers to what it lacks"),
        ("slots.occupants.network.target", -1, "refers to what it lacks"),
        ("slots.occupants.network.joint_node", 12, "refers to what it lacks"),
        ("slots.occupants.network.activation", 9, "refers to what it lacks"),
        ("slots.occupants.actuation.period", 0.0, "a clock or a bound is out of range"),
        ("slots.occupants.actuation.max_speed", 0.0, "a clock or a bound is out of range"),
        ("slots.occupants.actuation.max_bend", np.nan, "a clock or a bound is out of range"),
        ("slots.number", 1, "two creatures have one number"),
        ("living.age", -1, "an age is negative"),
        ("living.account", -1, "food, an account, a time or a share is out of range"),
        ("living.food", -1, "food, an account, a time or a share is out of range"),
        ("place.food.capacity", 2**24 + 1, "food, an account, a time or a share"),
        ("place.food.bite", np.inf, "food, an account, a time or a share is out of range"),
        ("place.food.diffusion", 0.3, "food, an account, a time or a share is out of range"),
    ],
)
def test_slots_that_cannot_live_are_refused(path, value, reason):
    place, held, living = crowd(count=SLOTS)
    given = {"place": place, "slots": held, "living": living}
    name, rest = path.split(".", 1)
    given[name] = changed(given[name], rest, value)
    with pytest.raises(Exception, match=f"microcosmos-kernels: .*{reason}"):
        jax.block_until_ready(in_kernel(given["place"], given["slots"], given["living"], 2))


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"every": 0}, "`every` must be at least 1"),
        ({"steps": 0}, "`steps` must be at least 1"),
        ({"steps": 10**8}, "`steps` must be fewer"),
        ({"living": {"food": None}}, "`living` must have food"),
    ],
)
@pytest.mark.parametrize("simulate", [live, world.native.live])
def test_windows_that_no_world_can_live_are_refused(simulate, change, named):
    place, held, living = crowd(count=2)
    living = replace(living, **change.get("living", {}))
    with pytest.raises(ValueError, match=named):
        simulate(place, held, living, change.get("steps", 3), change.get("every", 1))


def test_a_creature_of_another_size_or_form_is_refused():
    _, held, living = crowd(count=2)
    (one, positions), *_ = newborns("rings", 48, world.SENSES, 1, 0)
    with pytest.raises(ValueError, match=r"`rods\.edges` must have the shape"):
        slots.born(held, living, 0, one, positions, 9)
    (one, positions), *_ = newborns("chains", 48, (), 1, 0)
    with pytest.raises(ValueError, match="must have the senses"):
        slots.born(held, living, 0, one, positions, 9)


@pytest.mark.parametrize(
    ("senses", "named"),
    [
        (("touch", "energy"), "in this order"),
        (("smell",), "must be of energy"),
        (("account",), "must not have account"),
        (("energy_along",), "must not have energy_along"),
    ],
)
def test_senses_for_what_is_not_there_are_refused(senses, named):
    box, start, _ = meeting(heap(), matched=True)
    with pytest.raises(ValueError, match=named):
        world.senses.sensed(box, start, senses)


def test_food_must_suit_its_world():
    box, _, _ = meeting(heap(), matched=True)
    with pytest.raises(ValueError, match=r"`food.capacity` must have the shape \(48, 48\)"):
        replace(box, food=food(32))
    energy = fields.Energy(jnp.zeros((48, 48)), None, None)
    with pytest.raises(ValueError, match="`energy` or `food`"):
        replace(box, food=food(), energy=energy)
    with pytest.raises(ValueError, match="without a fluid"):
        replace(box, food=food(), form=replace(box.form, fluid=False))
    with pytest.raises(ValueError, match="`every` must be at least 1"):
        food(every=0)
    with pytest.raises(ValueError, match="must be in whole quanta"):
        eqx.tree_at(lambda one: one.capacity, food(), jnp.zeros((48, 48))).__check_init__()


def test_creatures_that_no_slot_holds_are_refused():
    _, task = task_of("chains")
    driven = task.encoding.drive(task.world, task.start, newborn_genes(task), None)
    with pytest.raises(ValueError, match="must have a network"):
        newborn(replace(driven, controller=None), task.actuators, PERIOD, PERIOD)
    bare = replace(driven, world=replace(task.world, layout=None), layout=None)
    with pytest.raises(ValueError, match="must have a layout"):
        newborn(bare, None, PERIOD, PERIOD)


def newborn_genes(task):
    return jax.jit(lambda key: task.encoding.newcomer(key=key))(jax.random.key(0))
