"""The archive file of a quality-diversity run, which is also its checkpoint.

The layout is described in `docs/formats.md`. It holds no clock, host, run or attempt: the
same run gives the same bytes, however often it was interrupted.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import equinox as eqx
import jax
import numpy as np

from .. import search
from ..archive import file
from ..version import VERSION

if TYPE_CHECKING:
    from .quality_diversity import QualityDiversity, State


class OtherDevice(ValueError):
    """The file was computed on another kind of device, where bits may differ."""


def save(experiment: QualityDiversity, state: State) -> bytes:
    """The whole state as a file; only occupied cells are written."""
    from .quality_diversity import CURVES

    state = jax.device_get(state)
    elites, cells = state.elites, np.flatnonzero(state.elites.occupied)
    features = elites.features[cells]
    tree = {
        "archive": {
            "cell": cells.astype(np.int32),
            "fitness": elites.fitness[cells],
            "descriptors": features[:, [axis.feature for axis in experiment.axes]],
            "features": features,
            "generation": elites.generation[cells],
            "slot": elites.slot[cells],
            "digest": elites.digest[cells],
            "creature": state.creatures[cells],
            "operator": state.operators[cells],
            "genomes": _columns(jax.tree.map(lambda x: x[cells], elites.networks)),
        },
        "curves": {name: state.curves[:, i] for i, name in enumerate(CURVES)},
        "lineage": _columns(state.lineage),
        "diverged": {
            **{n: v for n, v in _columns(state.quarantine).items() if n != "networks"},
            "genomes": _columns(state.quarantine.networks),
        },
        "loop": {
            "generation": np.int64(state.generation),
            "evaluations": np.int64(state.evaluations),
            "diverged": np.int64(state.diverged),
            "next_innovation": state.counters.innovation,
            "next_node": state.counters.node,
        },
    }
    attributes = {
        "format": file.FORMAT,
        "version": VERSION,
        "device": state_device(experiment, state),
        "spec": experiment.plan.spec,
        "features": json.dumps(search.FEATURES),
        "operators": json.dumps(search.OPERATORS),
        "statuses": json.dumps(search.STATUSES),
    }
    return file.dump(tree, attributes)


def restore(experiment: QualityDiversity, data: bytes, *, other_device: bool) -> State:
    """The state that `save` wrote; see `QualityDiversity.restore` for what it raises."""
    from .quality_diversity import CURVES, Diverged

    tree, attributes = file.load(data)
    if json.loads(attributes["spec"]) != json.loads(experiment.plan.spec):
        raise ValueError("`spec` in the file must be the run's own, got another")
    devices = attributes["device"].split(file.DEVICE_SEPARATOR)
    if devices[-1] != experiment.device and not other_device:
        raise OtherDevice(
            f"`device` must be {devices[-1]!r}, on which the run was computed, for the same "
            f"bits; got {experiment.device!r}. Allow another device to go on all the same."
        )
    start, archive, loop = experiment.init(), tree["archive"], tree["loop"]
    cells = archive["cell"]
    rows = search.Elites(
        occupied=np.ones(len(cells), bool),
        networks=_module(start.elites.networks, archive["genomes"]),
        **{n: archive[n] for n in ("fitness", "features", "generation", "slot", "digest")},
    )
    elites = jax.tree.map(lambda empty, x: empty.at[cells].set(x), start.elites, rows)
    creatures, operators = start.creatures, start.operators
    creatures[cells], operators[cells] = archive["creature"], archive["operator"]
    diverged = {name: v for name, v in tree["diverged"].items() if name != "genomes"}
    quarantine = Diverged(
        networks=_module(start.quarantine.networks, tree["diverged"]["genomes"]), **diverged
    )
    counters = (loop["next_innovation"], loop["next_node"])
    return type(start)(
        generation=int(loop["generation"]),
        evaluations=int(loop["evaluations"]),
        diverged=int(loop["diverged"]),
        elites=elites,
        counters=jax.tree.unflatten(
            jax.tree.structure(start.counters), [jax.numpy.asarray(c) for c in counters]
        ),
        creatures=creatures,
        operators=operators,
        curves=np.stack([tree["curves"][name] for name in CURVES], 1),
        lineage=_module(start.lineage, tree["lineage"]),
        quarantine=quarantine,
        devices=tuple(devices),
    )


def state_device(experiment: QualityDiversity, state: State) -> str:
    """Every kind of device that the run was computed on, in order."""
    devices = list(state.devices)
    if not devices or devices[-1] != experiment.device:
        devices.append(experiment.device)
    return file.DEVICE_SEPARATOR.join(devices)


def _columns(module: eqx.Module) -> dict[str, Any]:
    return dict(vars(module))


def _module(like: Any, columns: dict[str, Any]) -> Any:
    return type(like)(**columns)
