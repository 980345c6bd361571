"""Whether bodies evolve: `zoo` over five seeds, against frozen random plans and chains.

The audit simulates elites again in variants that should not matter, with the bars of fixed
bodies in `swimming`. Then bodies are evolved upstream in a channel and past a row of posts,
where the fittest of `standard` are put too.
"""

import statistics
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import rich
from drive import Installation
from searches import SEEDS, carry_out, rank, summary
from swimming import BARS as AGREE
from swimming import chosen, feasible_share, needed

from microcosmos.archive import creature
from microcosmos.audit import audit
from microcosmos.build import build_block
from microcosmos.build.experiments import room_of
from microcosmos.search.evaluation import judged
from microcosmos.spec import parse
from microcosmos.spec.quality_diversity import PRESETS
from microcosmos.viz.replay import actuator_of

FEASIBLE_SHARE = 0.6
"""Least share of feasible evaluations in the second half of a run."""
VARIETY = 1.5
"""Least ratio of the motion distance to that of `standard`."""
TRUSTED = 0.99
"""Least share of elites that the audit trusts."""
VARIANTS = {
    "wider limits": "doubled",
    "no limits": "off",
    "refined": "fine",
    "heading": "turned",
}
"""Bars of elites of fixed bodies, by the audit's variants."""
NODES = 16
"""Least nodes of a body whose stride counts."""
CONTROL_GENERATIONS = 100
"""Generations of the controls, and at which evolving bodies are compared with them."""
TASK_GENERATIONS = 100
"""Generations of searches for bodies that solve a task."""
FROZEN = {"body_rate": 0.0, "shape_rate": 0.0}
"""Rates with which plans stay as they were drawn."""
POSTS = [{"kind": "post", "x": 64.0, "y": y, "radius": 2.5} for y in (0.0, 16.0, 32.0)]
PLACES: dict[str, dict[str, Any]] = {
    "upstream": {
        "world": {"flow": {"kind": "poiseuille", "speed": 0.005}},
        "task": {"fitness": "upstream", "steps": 6000},
    },
    "through": {
        "world": {"width": 96, "obstacles": POSTS},
        "task": {"fitness": "through", "steps": 4000},
    },
}
"""Parts of the spec that ask for bodies, by task.

In 2,000 steps one turn in the current passes for swimming.
"""
DISTANCE = {"upstream": 24.0, "through": 19.0}
"""Least displacement in cells: the longest body, and to be past the posts."""
SHORT = {"length": 24.0}
"""Bodies between whose start and the posts there is room."""


def bodies(product: Installation) -> bool:
    """Tell whether bodies of `zoo` evolve, swim truly, and solve tasks of their own."""
    zoo, standard = PRESETS["zoo"][1], PRESETS["standard"][1]
    runs = [carry_out(product, seeded(zoo, seed), f"zoo, seed {seed}") for seed in SEEDS]
    plain = [
        carry_out(product, seeded(standard, seed), f"standard, seed {seed}") for seed in SEEDS
    ]
    good = [varied(product, runs, plain), truly(product, runs)]
    good.append(controls(product, runs))
    good += [solves(product, task, plain) for task in PLACES]
    return all(good)


def seeded(preset: Any, seed: int, **parts: Any) -> dict[str, Any]:
    """The document of a preset with another seed and other fields in some parts."""
    document = preset.model_dump(mode="json")
    changed = {name: {**document[name], **fields} for name, fields in parts.items()}
    return parse({**document, **changed, "seed": seed}).model_dump(mode="json")


def varied(product: Installation, runs: list[dict], plain: list[dict]) -> bool:
    """Print feasible shares, strides and motion distances; tell whether they reach the bars."""
    shares = [feasible_share(product, run["id"]) for run in runs]
    rich.print(f"zoo: feasible in the second half {summary(shares)}")
    fittest, longest = zip(*(strides(product, run["id"]) for run in runs), strict=True)
    usual, usual_longest = zip(*(strides(product, run["id"]) for run in plain), strict=True)
    rich.print(
        f"lengths a stroke, at least {NODES} nodes: of the fittest, zoo {summary(fittest)}, "
        f"standard {summary(usual)}; longest, zoo {summary(longest)}, standard "
        f"{summary(usual_longest)}"
    )
    found = [run["summary"]["motion_distance"] for run in runs]
    others = [run["summary"]["motion_distance"] for run in plain]
    ratio = statistics.median(found) / statistics.median(others)
    kinds = [run["summary"]["kinds"] for run in runs]
    rich.print(
        f"motion distance: zoo {summary(found)}, standard {summary(others)}: {ratio:.2f} × "
        f"(bar {VARIETY}); kinds {summary(kinds)}"
    )
    faster = statistics.median(fittest) >= statistics.median(usual)
    return min(shares) >= FEASIBLE_SHARE and faster and ratio >= VARIETY


def strides(product: Installation, run: str) -> tuple[float, float]:
    """The stride of the fittest elite with enough nodes, and the longest one, in lengths."""
    table = product.get(f"runs/{run}/archive")
    files = [product.get(f"creatures/{name}")["measured"] for name in table["creature"]]
    large = [file for file in files if file["measures"]["nodes"] >= NODES]
    fittest = max(large, key=lambda file: file["fitness"])
    return fittest["measures"]["stride"], max(file["measures"]["stride"] for file in large)


def truly(product: Installation, runs: list[dict]) -> bool:
    """Print how far elites go in each variant of the audit, relative to the recorded distance;
    tell whether they agree within the bars of fixed bodies, and the audit trusts them."""
    files = [file for run in runs for file in chosen(product, run["id"])]
    with ProcessPoolExecutor(mp_context=get_context("spawn")) as processes:
        audits = list(processes.map(audit, files))
    good = []
    for name, bars in VARIANTS.items():
        low, high = AGREE[bars]
        found = [row["value"] for one in audits for row in one["rows"] if row["name"] == name]
        inside = np.mean([low <= share <= high for share in found])
        middle = statistics.median(found)
        rich.print(
            f"zoo, {len(found)} elites, {name}: median {middle:.4f} "
            f"({min(found):.4f}–{max(found):.4f}), {inside:.0%} within {low:g} to {high:g}"
        )
        good.append(low <= middle <= high if bars == "fine" else inside >= needed(bars))
    for file, one in zip(files, audits, strict=True):
        if not one["verdict"]["trusted"]:
            rich.print(f"zoo, not trusted: {file['sha256']} {one['verdict']['reasons']}")
    trusted = np.mean([one["verdict"]["trusted"] for one in audits])
    rich.print(f"zoo, {len(audits)} elites: the audit trusts {trusted:.0%}")
    return all(good) and trusted >= TRUSTED


def controls(product: Installation, runs: list[dict]) -> bool:
    """Print how evolving bodies compare with frozen random plans and chains at equal
    evaluations, with rank tests; tell whether they are better than both."""
    zoo = PRESETS["zoo"][1]
    short = {"generations": CONTROL_GENERATIONS}
    chain, place = PRESETS["standard"][1], zoo.model_dump(mode="json")
    parts = {name: place[name] for name in ("world", "archive")}
    others = {
        "frozen": [
            carry_out(product, seeded(zoo, s, genome=FROZEN, search=short), f"frozen, seed {s}")
            for s in SEEDS
        ],
        "chains": [
            carry_out(product, seeded(chain, s, **parts, search=short), f"chains, seed {s}")
            for s in SEEDS
        ],
    }
    good = True
    for figure in ("best", "qd_score", "coverage"):
        own = [at_generation(product, run, figure) for run in runs]
        for name, some in others.items():
            other = [at_generation(product, run, figure) for run in some]
            rich.print(
                f"{figure} after {CONTROL_GENERATIONS} generations: evolved {summary(own)}, "
                f"{name} {summary(other)}, {rank(own, other)}"
            )
            good &= figure == "best" or statistics.median(own) > statistics.median(other)
    return good


def at_generation(product: Installation, run: dict, figure: str) -> float:
    found = product.get(f"runs/{run['id']}/generations")
    return found[figure][CONTROL_GENERATIONS - 1]


def solves(product: Installation, task: str, plain: list[dict]) -> bool:
    """Tell whether the fittest evolved for a task gets there, and beats those of `standard`."""
    parts = {"body": SHORT, "search": {"generations": TASK_GENERATIONS}, **PLACES[task]}
    run = carry_out(product, seeded(PRESETS["zoo"][1], 0, **parts), f"zoo, {task}")
    put = [fitness_there(product, one, task) for one in plain]
    went = chosen(product, run["id"])[0]["measured"]["measures"]["displacement"]
    rich.print(
        f"{task}: evolved {run['best']:.3f}, {went:.1f} of {DISTANCE[task]:g} cells; fittest "
        f"of standard {summary(put)}"
    )
    return run["best"] > max(put) and went >= DISTANCE[task]


def fitness_there(product: Installation, run: dict, task: str) -> float:
    """The fitness of a run's fittest elite in the world of a task; −inf if infeasible."""
    file = chosen(product, run["id"])[0]
    there = parse(seeded(PRESETS["standard"][1], 0, **PLACES[task]))
    genotype = actuator_of(creature.parse(file), there.scene)
    block = jax.tree.map(lambda x: jnp.asarray(x)[None], genotype)
    found = judged(jax.device_get(build_block(there.scene, room_of(there))(block)))
    return float(found.fitness[0]) if found.status[0] == 0 else -np.inf
