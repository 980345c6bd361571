"""Searches at full size, compared with each other, as tables and figures."""

import statistics
import time
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import rich
from drive import ROOT, Installation
from matplotlib.figure import Figure
from rich.table import Table
from scipy.stats import mannwhitneyu

from microcosmos.naming import decode, encode, name
from microcosmos.spec import parse

SEEDS = (0, 1, 2, 3, 4)
PICTURES = ROOT / "docs" / "pictures"
HOURS = 3600

METHODS = {
    "random": {"search": {"emitters": [{"operator": "random"}]}},
    "NEAT": {"experiment": "neuroevolution"},
    "MAP-Elites, NEAT": {"search": {"emitters": [{"operator": "neat"}]}},
    "MAP-Elites, NEAT, screened": {
        "search": {"emitters": [{"operator": "neat"}], "screening": {}},
    },
    "MAP-Elites, iso+line, direct": {
        "control": {"encoding": "direct"},
        "search": {"emitters": [{"operator": "iso+line"}]},
    },
}
"""Differences between the searches; everything else is the default of the spec."""
BUDGETS = (3_200, 6_400)
"""Evaluations after which searches are compared."""
BARS = {
    (3_200, "MAP-Elites, NEAT", "qd_score"): 1.3,
    (6_400, "MAP-Elites, NEAT", "qd_score"): 1.3,
    (3_200, "MAP-Elites, NEAT", "best"): 1.2,
    (3_200, "NEAT", "best"): 1.0,
    (6_400, "MAP-Elites, NEAT, screened", "qd_score"): 2.0,
    (6_400, "MAP-Elites, NEAT, screened", "best"): 1.1,
}
"""Least ratios of medians to those of random search."""
FIGURES = {
    "best": "best fitness (lengths in 1,000 steps)",
    "coverage": "coverage",
    "qd_score": "QD score",
}
FITTEST = 10
"""Elites of each seed whose gaits are examined."""
PURE = 0.9
"""Least share of a gait's power in one harmonic for a sinusoidal gait."""


def carry_out(product: Installation, document: dict, title: str) -> dict:
    """Carry out a run, print a line about it and return it from the API.

    A run that another part has carried out is not repeated.
    """
    for run in product.get("runs", status="finished", limit=200)["items"]:
        if product.get(f"runs/{run['id']}")["spec"] == document:
            return product.get(f"runs/{run['id']}")
    began = time.monotonic()
    found = product.wait(product.submit(document), "finished", seconds=2 * HOURS)
    seconds = time.monotonic() - began
    rich.print(
        f"{title}: QD score {found['qd_score']:.1f}, coverage {found['coverage']:.3f}, best "
        f"{found['best']:.2f}, infeasible {found['infeasible']}, {seconds / 60:.1f} min, "
        f"{found['evaluations'] / seconds:.1f} evaluations/s"
    )
    return found


def written(spec: dict[str, Any]) -> dict[str, Any]:
    return parse({"experiment": "quality-diversity", **spec}).model_dump(mode="json")


def spec(seed: int, method: str) -> dict:
    """24 nodes, 48 × 48 cells, 2,000 steps, 20 × 20 cells, generations of 64."""
    chosen = METHODS[method]
    search = {**chosen.get("search", {}), "generations": BUDGETS[-1] // 64, "batch": 64}
    return written({**chosen, "seed": seed, "search": search})


def compare(product: Installation, runs: dict[str, list[dict]]) -> bool:
    """Print and draw medians and ranges; tell whether medians reach their bars."""
    found = {
        budget: {
            method: [figures_at(product, run, budget) for run in some]
            for method, some in runs.items()
        }
        for budget in BUDGETS
    }
    for budget, methods in found.items():
        lists = {n: [[run[f] for run in some] for f in FIGURES] for n, some in methods.items()}
        rich.print(table(f"{budget:,} evaluations: median (range)", FIGURES.values(), lists))
    good = True
    for (budget, method, figure), bar in BARS.items():
        own, other = ([run[figure] for run in found[budget][n]] for n in (method, "random"))
        ratio = statistics.median(own) / statistics.median(other)
        good &= ratio > bar
        rich.print(
            f"{method}, {figure} after {budget:,} evaluations: {ratio:.2f} × random search "
            f"(bar {bar}), {rank(own, other)}"
        )
    draw(found)
    for method, some in runs.items():
        files = [file for run in some for file in fittest(product, run["id"], FITTEST)]
        purities = [purity(file) for file in files]
        rich.print(
            f"{method}: {np.mean(np.array(purities) >= PURE):.0%} of the {FITTEST} fittest of "
            f"each seed are sinusoidal (median {statistics.median(purities):.0%} of the power "
            "in one harmonic)"
        )
    return good


def figures_at(product: Installation, run: dict, evaluations: int) -> dict[str, float]:
    """The figures of a run after so many evaluations."""
    found = product.get(f"runs/{run['id']}/generations")
    at = np.searchsorted(found["evaluations"], evaluations, side="right") - 1
    return {figure: found[figure][at] for figure in FIGURES}


def rank(own: list[float], other: list[float]) -> str:
    """The one-sided rank test of Mann and Whitney (Ann. Math. Stat. 18, 50, 1947)."""
    found = mannwhitneyu(own, other, alternative="greater", method="exact")
    pairs = len(own) * len(other)
    return f"greater in {found.statistic:.0f} of {pairs} pairs, p = {found.pvalue:.3f}"


def table(title: str, columns: Iterable[str], found: Mapping[str, list[list[float]]]) -> Table:
    """Medians and ranges of lists of values: a row for each name."""
    rows = Table(title, *columns)
    for method, lists in found.items():
        rows.add_row(method, *map(summary, lists))
    return rows


def summary(values: list[float]) -> str:
    digits = 3 if max(values) <= 1 else 2
    low, middle, high = min(values), statistics.median(values), max(values)
    return f"{middle:.{digits}f} ({low:.{digits}f}–{high:.{digits}f})"


def draw(found: dict[int, dict[str, list[dict]]]) -> None:
    """A panel for each figure, a point for each seed, a bar at the median: after the smaller
    budget pale, after the larger one strong."""
    figure = Figure(figsize=(10, 3.4), layout="constrained")
    for axes, (key, title) in zip(figure.subplots(1, 3), FIGURES.items(), strict=True):
        for shade, methods in zip((0.3, 0.8), found.values(), strict=True):
            for column, some in enumerate(methods.values()):
                values, place = [run[key] for run in some], column + 0.4 * shade - 0.22
                color = f"C{column}"
                axes.plot([place] * len(values), values, "o", alpha=shade, color=color)
                middle = statistics.median(values)
                ends = [place - 0.12, place + 0.12]
                axes.plot(ends, [middle] * 2, color=color, lw=2)
        labels = [method.replace(", ", ",\n") for method in methods]
        axes.set_xticks(range(len(labels)), labels, fontsize=7)
        axes.set_title(title, fontsize=10)
        axes.set_ylim(bottom=0)
        axes.spines[["top", "right"]].set_visible(False)
    budgets = " and ".join(f"{budget:,}" for budget in found)
    figure.suptitle(f"After {budgets} evaluations, left to right", fontsize=9)
    figure.savefig(PICTURES / "searches.png", dpi=150)


def fittest(product: Installation, run: str, count: int) -> list[dict]:
    archive = product.get(f"runs/{run}/archive")
    order = np.argsort(archive["fitness"])[::-1][:count]
    return [product.get(f"creatures/{archive['creature'][i]}") for i in order]


def purity(file: dict) -> float:
    """The share of one harmonic in the power of all joints' rest angles."""
    import jax
    import jax.numpy as jnp

    from microcosmos import search
    from microcosmos.archive import creature
    from microcosmos.build import build_task
    from microcosmos.viz.replay import actuator_of

    scene = creature.scene_of(creature.parse(file))
    task = build_task(scene, room=creature.room(file))
    actuator = jax.tree.map(jnp.asarray, actuator_of(file, scene))

    def commanded(actuator: Any) -> tuple[jax.Array, jax.Array | None]:
        driven = search.drive(task, actuator)
        return driven.inputs.angle, driven.clock

    angles, clock = jax.jit(commanded)(actuator)
    angle = np.asarray(angles, float)
    # At equal times of the controller's clock, which slows where the body would be too fast.
    phase = np.arange(len(angle)) if clock is None else np.asarray(clock, float)
    last = phase[-1] // scene.control.period * scene.control.period
    at = last - scene.control.period * np.arange(1, 65) / 64
    angle = np.stack([np.interp(at, phase, one) for one in angle.T], 1)
    power = (np.abs(np.fft.rfft(angle, axis=0)) ** 2).sum(1)[1:]
    return float(power.max() / power.sum()) if power.sum() > 0 else 0.0


def forage_spec(seed: int, fitness: str) -> dict:
    """NEAT among packets of energy, which networks sense; 1 : 1 as in the paper.

    Bodies are small beside the distance of packets, and a life is long enough to reach one.
    Packets lie elsewhere in each of four worlds, so only sensing finds them.
    """
    energy = {"packets": 5, "width": 3.0, "placements": 4}
    control = {"sense_energy": True, "period": 120, "angle_scale": 0.6}
    parts = {
        "experiment": "neuroevolution",
        "world": {"width": 48, "height": 48, "energy": energy},
        "body": {"builder": "chain", "nodes": 16},
        "task": {"fitness": fitness, "energy_weight": 1.0, "steps": 3200},
        "search": {"generations": 24, "batch": 64},
    }
    return written({**parts, "seed": seed, "control": control})


def forage(product: Installation) -> bool:
    """Tell whether selection for energy collects more, and blindness less, as medians."""
    from microcosmos.audit.reproducibility import check

    found: dict[str, list[float]] = {"displacement+energy": [], "displacement": [], "blind": []}
    for seed in SEEDS:
        for fitness in ("displacement+energy", "displacement"):
            run = carry_out(product, forage_spec(seed, fitness), f"{fitness}, seed {seed}")
            (best,) = fittest(product, run["id"], 1)
            found[fitness].append(best["measured"]["measures"]["energy"])
            if fitness == "displacement+energy":
                found["blind"].append(check(blinded(best)).repeated["energy"])
    middle = {kind: statistics.median(values) for kind, values in found.items()}
    for kind, values in found.items():
        listed = ", ".join(f"{value:.0f}" for value in values)
        rich.print(f"energy collected by {kind}: median {middle[kind]:.0f} ({listed})")
    for kind in ("displacement", "blind"):
        ranked = rank(found["displacement+energy"], found[kind])
        rich.print(f"selected for energy, than {kind}: {ranked}")
    return middle["displacement+energy"] > max(middle["displacement"], middle["blind"])


def blinded(file: dict) -> dict:
    """The same creature with no weight on what it senses."""
    identity = file["identity"]
    genome = identity["genome"]
    connections, sensor = genome["connections"], genome["inputs"].index("energy")
    weights = decode(connections["weight"]).copy()
    weights[[source == sensor for source in connections["source"]]] = 0.0
    genome = {**genome, "connections": {**connections, "weight": encode(weights)}}
    changed = {**identity, "genome": genome}
    return {**file, "identity": changed, "sha256": name(changed)}
