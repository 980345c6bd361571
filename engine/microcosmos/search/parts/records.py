"""Records of a run: the names, parents and poses of elites, the curves, the failures.

Every run has these parts; a search of your own (`Search`) has none of them.
"""

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Any

import equinox as eqx
import jax
import numpy as np
from jaxtyping import Float, Int, UInt8

from ... import naming
from ...archive import poses
from ...archive.poses import PoseStream
from ...archive.report import Elite
from ...archive.variety import variety
from ...genomes import Encoding, Genotype, take, write
from ...operators import FORK, OPERATORS
from ..containers import best_of_cells
from ..emitters import NO_PARENT, Population
from ..evaluation import STATUSES
from ..insertion import Inserted, clipped
from ..loop import ENDS, Leaf, Part, Plan, State, Turn
from ..window import Poses

NO_NAME = np.zeros(32, np.uint8)
"""The name that stands for no creature."""

CURVES = ("qd_score", "coverage", "best", "mean", "evaluations", "infeasible", "clipped")
"""Names of the curves that every run has, in this order."""

OUTCOMES = ("children", "inserted", "improved")
"""Counts of an emitter's children: all, those in new cells, those that replaced an elite.
Slots that a part took count for no emitter."""

VARIETY = ("motion_distance", "nearest_motion", "kinds")
"""Figures of `Variety` in the summary of the last generation."""

MAX_INFEASIBLE = 256
"""Number of infeasible creatures to keep, the newest."""


@dataclass(frozen=True)
class RunFacts:
    """Facts that all creatures of a run share, and their origin."""

    spec: str
    """The whole spec as JSON."""
    identity_template: Mapping[str, Any]
    """The identity that all creatures of the run share, without genes."""
    encoding: Encoding
    block: int
    descriptors: tuple[str, ...]
    device: str
    plugins: Mapping[str, Any] = field(default_factory=dict)
    """Versions of the plug-ins among the measures."""
    force_free: bool = True
    """True if bodies cannot push themselves; if not, swimming may be an artefact."""
    operators: tuple[str, ...] = OPERATORS
    """Names of the operators, by number; those of plug-ins come last."""


class Entries(eqx.Module):
    """Parents and measures of each entry into the archive, in order."""

    creature: UInt8[np.ndarray, "entry 32"]
    parents: UInt8[np.ndarray, "entry 2 32"]
    """Zeros for none."""
    operator: Int[np.ndarray, "entry"]
    generation: Int[np.ndarray, "entry"]
    cell: Int[np.ndarray, "entry"]
    fitness: Float[np.ndarray, "entry"]
    descriptors: Float[np.ndarray, "entry axis"]


class Lineage(eqx.Module):
    """Names, parents and poses of elites, in NumPy arrays."""

    creatures: UInt8[np.ndarray, "cell 32"]
    """The SHA-256 of each cell's elite."""
    operators: Int[np.ndarray, "cell"]
    device_of: Int[np.ndarray, "cell"]
    """Index in `State.devices` of the device that measured each cell's elite."""
    nearest_ancestors: UInt8[np.ndarray, "slot 2 32"]
    """The nearest recorded creatures of each slot of the last generation: itself if it entered,
    else its ancestors; zeros for none."""
    pieces: tuple[Entries, ...]
    """All entries in their order, in pieces each of which is larger than the next."""
    poses: Mapping[int, PoseStream]
    """The pose stream of each cell's elite."""

    @property
    def names(self) -> UInt8[np.ndarray, "parent 32"]:
        """The names that parent numbers index: those of cells, then of slots."""
        return np.concatenate([self.creatures, self.nearest_ancestors[:, 0]])

    @property
    def entries(self) -> Entries:
        return _joined(self.pieces)


def lineage(facts: RunFacts) -> Part:
    """Return the part that names elites and records their parents and poses."""
    return Part(
        name="lineage",
        begin=_no_lineage,
        leaves={
            "creatures": Leaf("cell", "archive/creature"),
            "operators": Leaf("cell", "archive/operator"),
            "device_of": Leaf("cell", "archive/device"),
            "nearest_ancestors": Leaf("slot", "loop/nearest_ancestors"),
            "pieces": Leaf(
                "entry",
                "lineage",
                write=lambda pieces, cells: dict(vars(_joined(pieces))),
                read=_read_entries,
            ),
            "poses": Leaf(
                "cell",
                "archive/poses",
                write=_written_poses,
                read=_read_poses,
            ),
        },
        placed=lambda own, turn: _with_entered(facts, own, turn),
        figures=_variety,
    )


def _no_lineage(plan: Plan) -> Lineage:
    none = np.zeros(0, np.int32)
    return Lineage(
        creatures=np.zeros((plan.cell_count, 32), np.uint8),
        operators=np.zeros(plan.cell_count, np.int32),
        device_of=np.zeros(plan.cell_count, np.int32),
        nearest_ancestors=np.zeros((plan.batch, 2, 32), np.uint8),
        pieces=(
            Entries(
                creature=np.zeros((0, 32), np.uint8),
                parents=np.zeros((0, 2, 32), np.uint8),
                operator=none,
                generation=none,
                cell=none,
                fitness=np.zeros(0, np.float32),
                descriptors=np.zeros((0, len(plan.axes)), np.float32),
            ),
        ),
        poses={},
    )


def _joined(pieces: tuple[Entries, ...]) -> Entries:
    return jax.tree.map(lambda *columns: np.concatenate(columns), *pieces)


def appended(pieces: tuple[Entries, ...], new: Entries) -> tuple[Entries, ...]:
    """Return the pieces with new entries.

    Copying a million entries takes 35 ms, too long for every generation. So the last pieces are
    joined only while they are no larger than what follows them: that copies each entry a few
    times in a whole run.
    """
    kept, rows = len(pieces), len(new.cell)
    while kept and len(pieces[kept - 1].cell) <= rows:
        kept -= 1
        rows += len(pieces[kept].cell)
    return (*pieces[:kept], _joined((*pieces[kept:], new))) if rows else pieces


def _read_entries(
    tree: Mapping[str, Any], attributes: Mapping[str, str], cells: np.ndarray
) -> tuple[Entries, ...]:
    columns = tree["lineage"]
    return (Entries(**{one.name: columns[one.name] for one in fields(Entries)}),)


def _written_poses(kept: Mapping[int, PoseStream], cells: np.ndarray) -> dict[str, Any]:
    return poses.columns([kept[cell] for cell in cells.tolist()])


def _read_poses(
    tree: Mapping[str, Any], attributes: Mapping[str, str], cells: np.ndarray
) -> dict[int, PoseStream]:
    return dict(zip(cells.tolist(), poses.streams(tree, attributes), strict=True))


def _with_entered(facts: RunFacts, own: Lineage, turn: Turn) -> tuple[Lineage, Turn]:
    """Record the new elites, and forget those of emptied cells."""
    batch, inserted = turn.batch, turn.settled.inserted
    slots = np.flatnonzero(inserted.entered)
    cells = np.asarray(inserted.cell)[slots]
    names = own.names if batch.names is None else batch.names
    ancestors = _ancestors_of(own, names, np.asarray(batch.children.parents))
    elites = tuple(
        _new_elite(facts, turn, ancestors, slot, cell)
        for slot, cell in zip(slots.tolist(), cells.tolist(), strict=True)
    )
    new = _entries(facts, elites, ancestors[slots], len(turn.plan.axes))
    creatures, operators = own.creatures.copy(), own.operators.copy()
    device_of, nearest_ancestors = own.device_of.copy(), ancestors.copy()
    operators[cells], device_of[cells] = new.operator, len(turn.before.devices) - 1
    creatures[cells] = new.creature
    nearest_ancestors[slots] = 0
    nearest_ancestors[slots, 0] = new.creature
    # Containers of survivors and learned axes leave places empty; grids never do.
    lost = list(turn.emptied)
    creatures[lost], operators[lost], device_of[lost] = 0, 0, 0
    seen = {one.cell: poses.decode(one.poses) for one in elites if one.poses}
    grown = Lineage(
        creatures=creatures,
        operators=operators,
        device_of=device_of,
        nearest_ancestors=nearest_ancestors,
        pieces=appended(own.pieces, new),
        poses={cell: one for cell, one in {**own.poses, **seen}.items() if cell not in lost},
    )
    return grown, replace(turn, elites=elites)


def _new_elite(
    facts: RunFacts, turn: Turn, ancestors: np.ndarray, slot: int, cell: int
) -> Elite:
    evaluation, children = turn.evaluation, turn.batch.children
    return _elite(
        facts,
        turn.plan,
        take(children.genotypes, slot),
        float(evaluation.fitness[slot]),
        np.asarray(evaluation.measures[slot]),
        cell=cell,
        generation=turn.number,
        operator=int(np.asarray(children.operator)[slot]),
        parents=ancestors[slot],
        device=facts.device,
        seen=jax.tree.map(lambda x: x[slot], evaluation.poses),
    )


def _entries(
    facts: RunFacts, elites: tuple[Elite, ...], parents: np.ndarray, axes: int
) -> Entries:
    """Return the entries of new elites in the lineage; `parents` are (elite, 2, 32)."""
    parents[[not elite.parents for elite in elites]] = 0
    names = [np.frombuffer(bytes.fromhex(elite.creature), np.uint8) for elite in elites]
    operators = [facts.operators.index(elite.operator) for elite in elites]
    measured = [elite.descriptors for elite in elites]
    return Entries(
        creature=np.array(names, np.uint8).reshape(-1, 32),
        parents=parents,
        operator=np.array(operators, np.int32),
        generation=np.array([elite.generation for elite in elites], np.int32),
        cell=np.array([elite.cell for elite in elites], np.int32),
        fitness=np.array([elite.fitness for elite in elites], np.float32),
        descriptors=np.array(measured, np.float32).reshape(-1, axes),
    )


def creature_file(facts: RunFacts, plan: Plan, state: State, cell: int) -> dict[str, Any]:
    """Return the creature file of a cell's elite."""
    elites = jax.tree.map(lambda x: np.asarray(x)[cell], state.elites)
    own: Lineage = state.parts["lineage"]
    entries = own.entries
    entry = np.flatnonzero(entries.cell == cell)[-1]
    elite = _elite(
        facts,
        plan,
        elites.genotypes,
        float(elites.fitness),
        elites.measures,
        cell=cell,
        generation=int(elites.generation),
        operator=int(own.operators[cell]),
        parents=entries.parents[entry],
        device=state.devices[own.device_of[cell]],
    )
    return naming.document(json.loads(elite.identity), elite.measured, elite.provenance)


def identity(template: Mapping[str, Any], genotype: Genotype) -> dict[str, Any]:
    """Return the identity of a genotype in the world, body and task of `template`."""
    return {**template, "genome": {**template["genome"], **write(genotype)}}


def measurement(
    fitness: float,
    measures: Mapping[str, float],
    descriptors: Iterable[str] = (),
    *,
    block: int,
    device: str,
    room: tuple[int, int] | None = None,
    plugins: Mapping[str, Any] | None = None,
) -> dict[str, Any]:
    """Return the part `measured` of a creature file."""
    return {
        "fitness": fitness,
        "descriptors": {name: measures[name] for name in descriptors},
        "measures": measures,
        "block": block,
        "room": list(room) if room else None,
        "device": device,
        **({"plugins": dict(plugins)} if plugins else {}),
    }


def _ancestors_of(own: Lineage, names: np.ndarray, parents: np.ndarray) -> np.ndarray:
    """Return the nearest recorded ancestors (slot, 2, 32) of children of parents (slot, 2).

    A parent from the archive is recorded. A parent from the last generation may not be: then
    its own nearest recorded ancestors take its place.
    """
    nearest = np.concatenate([names, NO_NAME[None]])
    ancestors = nearest[parents]  # −1, for no parent, finds the last row.
    slot = parents[:, 0] - len(own.creatures)
    alone = (parents[:, 1] == NO_PARENT) & (slot >= 0) & (slot < len(own.nearest_ancestors))
    # A single parent that was not recorded passes on both of its ancestors.
    ancestors[alone] = own.nearest_ancestors[slot[alone]]
    same = (ancestors[:, 0] == ancestors[:, 1]).all(-1)
    ancestors[same, 1] = 0
    return ancestors


def _elite(
    facts: RunFacts,
    plan: Plan,
    genotype: Genotype,
    fitness: float,
    values: np.ndarray,
    *,
    cell: int,
    generation: int,
    operator: int,
    parents: np.ndarray,
    device: str,
    seen: Poses | None = None,
) -> Elite:
    whole = identity(facts.identity_template, genotype)
    measures: dict[str, float] = dict(zip(plan.measures, values.tolist(), strict=True))
    creature = naming.name(whole)
    named = tuple(bytes(parent).hex() for parent in parents if parent.any())
    if facts.operators[operator] == FORK:  # It may be that creature.
        named = tuple(name for name in named if name != creature)
    measured = measurement(
        fitness,
        measures,
        facts.descriptors,
        block=facts.block,
        room=facts.encoding.room,
        device=device,
        plugins=facts.plugins,
    )
    provenance = naming.provenance(
        facts.operators[operator], generation=generation, parents=named, seed=plan.seed
    )
    return Elite(
        cell=cell,
        fitness=fitness,
        descriptors=tuple(values[[axis.measure for axis in plan.axes]].tolist()),
        measures=measures,
        creature=creature,
        identity=naming.canonical(whole),
        parents=named,
        operator=facts.operators[operator],
        generation=generation,
        measured=measured,
        provenance=provenance,
        poses=None if seen is None else pose_stream(facts.spec, seen, creature).encode(),
    )


def pose_stream(text: str, seen: Poses, creature: str) -> PoseStream:
    """Return the pose stream of one creature; its nodes are those that have grown.

    `text` is the spec of its run as JSON.
    """
    spec, present, last = json.loads(text), seen.present, seen.window
    edges = np.asarray(seen.edges)
    edges = edges[np.all(present[edges], 1)]
    return PoseStream(
        positions=np.asarray(seen.positions)[:, present],
        path=np.asarray(seen.path),
        middles=np.asarray(seen.middles),
        scale=float(seen.scale),
        edges=(np.cumsum(present) - 1)[edges].astype(np.int32),
        start=int(last.start),
        stop=int(last.stop),
        strokes=int(last.strokes),
        steps=spec["task"]["steps"],
        size=(spec["world"]["width"], spec["world"]["height"]),
        length=float(seen.length),
        creature=creature,
    )


def _variety(own: Lineage, turn: Turn) -> dict[str, int | float]:
    """Return motion distances of the elites of a run that is over; a second for 512."""
    if not turn.over or len(own.poses) < 2:
        return {}
    fitness = np.asarray(turn.after.elites.fitness)
    cells = sorted(own.poses, key=lambda cell: (-fitness[cell], cell))
    compared = variety([own.poses[cell] for cell in cells])
    return {name: getattr(compared, name) for name in VARIETY}


class Outcomes(eqx.Module):
    """Counts of each emitter's children."""

    counts: Int[np.ndarray, "generation emitter outcome"]
    """Columns of `OUTCOMES`."""


def outcomes() -> Part:
    """Return the part that counts each emitter's children by their outcome."""
    return Part(
        name="outcomes",
        begin=lambda plan: Outcomes(np.zeros((0, len(plan.emitters), len(OUTCOMES)), np.int64)),
        leaves={"counts": columns_of("emitters", OUTCOMES)},
        placed=_with_outcomes,
        figures=_outcome_figures,
    )


def _with_outcomes(own: Outcomes, turn: Turn) -> tuple[Outcomes, Turn]:
    row = counted(turn.batch.emitter, turn.settled.inserted, len(turn.plan.emitters))
    return Outcomes(np.concatenate([own.counts, row[None]])), turn


def counted(
    emitter: Int[np.ndarray, "slot"], inserted: Inserted, emitters: int
) -> Int[np.ndarray, "emitter outcome"]:
    """Return a row of `OUTCOMES` for each emitter, from the emitter of each slot."""
    entered, fresh = np.asarray(inserted.entered), np.asarray(inserted.fresh)
    counts = np.stack([np.ones(len(entered), int), entered & fresh, entered & ~fresh], 1)
    # Slots of parts have negative numbers, so no emitter counts them.
    theirs = np.arange(emitters)[:, None] == emitter[None]
    return theirs.astype(int) @ counts


def _outcome_figures(own: Outcomes, turn: Turn) -> dict[str, int | float]:
    figures: dict[str, int | float] = {}
    for i, name in enumerate(turn.plan.names):
        _, inserted, improved = own.counts[-1, i].tolist()
        figures |= {f"emitter.{name}.inserted": inserted, f"emitter.{name}.improved": improved}
    for state in turn.after.emitters:
        if isinstance(state, Population):
            sizes = state.sizes().items()
            return figures | {f"species.{number}": int(count) for number, count in sizes}
    return figures


class Failures(eqx.Module):
    """Infeasible creatures, with the reasons."""

    generation: Int[np.ndarray, "row"]
    slot: Int[np.ndarray, "row"]
    status: Int[np.ndarray, "row"]
    genotypes: Genotype


def failures() -> Part:
    """Return the part that keeps the newest infeasible creatures, with the reasons."""
    return Part(
        name="failures",
        begin=_no_failures,
        leaves={
            name: Leaf("row", f"infeasible/{name}")
            for name in ("generation", "slot", "status", "genotypes")
        },
        placed=_with_failures,
        figures=_failure_figures,
    )


def _no_failures(plan: Plan) -> Failures:
    none = np.zeros(0, np.int32)
    return Failures(none, none, none, no_genotypes(plan))


def no_genotypes(plan: Plan) -> Genotype:
    """Return no rows of genotypes, as NumPy arrays."""
    return jax.tree.map(lambda x: np.zeros((0, *x.shape), x.dtype), plan.genotype)


def _with_failures(own: Failures, turn: Turn) -> tuple[Failures, Turn]:
    status = np.asarray(turn.evaluation.status)
    failed = np.flatnonzero(status)
    new = Failures(
        generation=np.full(len(failed), turn.number, np.int32),
        slot=failed.astype(np.int32),
        status=status[failed].astype(np.int32),
        genotypes=jax.tree.map(lambda x: np.asarray(x)[failed], turn.batch.children.genotypes),
    )
    grown = jax.tree.map(lambda a, b: np.concatenate([a, b])[-MAX_INFEASIBLE:], own, new)
    return grown, turn


def _failure_figures(own: Failures, turn: Turn) -> dict[str, int | float]:
    status = np.asarray(turn.evaluation.status)
    counts = np.bincount(status, minlength=len(STATUSES)).tolist()
    reasons = list(zip(STATUSES, counts, strict=True))[1:]
    return {f"infeasible.{reason}": count for reason, count in reasons if count}


class Curves(eqx.Module):
    """A row of figures for each generation, in double precision."""

    rows: Float[np.ndarray, "generation curve"]


def curves() -> Part:
    """Return the part that records the curves; it comes after all that evaluate."""
    return Part(
        name="curves",
        begin=lambda plan: Curves(np.zeros((0, len(CURVES)))),
        leaves={"rows": columns_of("curves", CURVES)},
        learn=_with_curves,
        figures=_curve_figures,
        prolong=_with_fewer_evaluations,
    )


def _with_curves(own: Curves, turn: Turn) -> tuple[Curves, Turn]:
    """Add a row; sums are in double precision."""
    after = turn.after
    of_cells = best_of_cells(after.elites, after.container)
    fitness = of_cells[np.isfinite(of_cells)]
    best, mean = (fitness.max(), fitness.mean()) if len(fitness) else (np.nan, np.nan)
    coverage = len(fitness) / len(of_cells)
    assert turn.settled.candidates is not None
    beyond = clipped(turn.settled.candidates, after.container.axes)
    # Sums of float32 would depend on how a machine adds them up.
    row = [fitness.sum(), coverage, best, mean, after.evaluations, after.infeasible, beyond]
    return Curves(np.concatenate([own.rows, np.array(row, float)[None]])), turn


def _curve_figures(own: Curves, turn: Turn) -> dict[str, int | float]:
    values = dict(zip(CURVES, own.rows[-1].tolist(), strict=True))
    values |= {"clipped": int(values["clipped"]), "device_seconds": turn.seconds}
    values |= {"evaluations": turn.after.evaluations, "infeasible": turn.after.infeasible}
    if turn.after.ended:
        values[f"ended.{ENDS[turn.after.ended]}"] = turn.number
    return values


def _with_fewer_evaluations(own: Curves, state: State) -> tuple[Curves, State]:
    """Return the curves without evaluations that a part made because the run ended."""
    rows = own.rows.copy()
    if len(rows):
        rows[-1, CURVES.index("evaluations")] = state.evaluations
    return Curves(rows), state


def columns_of(group: str, names: tuple[str, ...]) -> Leaf:
    """Return the place of an array whose last axis has these names."""

    def write(rows: np.ndarray, cells: np.ndarray) -> dict[str, np.ndarray]:
        return {name: rows[..., i] for i, name in enumerate(names)}

    def read(
        tree: Mapping[str, Any], attributes: Mapping[str, str], cells: np.ndarray
    ) -> np.ndarray:
        return np.stack([tree[group][name] for name in names], -1)

    return Leaf("generation", group, write=write, read=read)
