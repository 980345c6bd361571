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
    "MAP-Elites, iso+line, direct": {
        "control": {"encoding": "direct"},
        "search": {"emitters": [{"operator": "iso+line"}]},
    },
}
"""Differences between the searches; everything else is the default of the spec."""
BARS = {
    ("MAP-Elites, NEAT", "qd_score"): 1.3,
    ("MAP-Elites, NEAT", "best"): 1.2,
    ("NEAT", "best"): 1.0,
}
"""Least ratios of medians to those of random search."""
FIGURES = {
    "best": "best fitness (lengths in 1,000 steps)",
    "coverage": "coverage",
    "qd_score": "QD score",
}
PURE = 0.9
"""Least share of a gait's power in one harmonic for a sinusoidal gait."""

SLOPE_METHODS = {
    "NEAT": ("cppn", {"operator": "neat"}, 200),
    "NEAT that learns": ("cppn", {"operator": "lamarckian", "lessons": 1, "step": 0.5}, 50),
    "iso+line, direct": ("direct", {"operator": "iso+line"}, 200),
    "CMA-MEGA, direct": ("direct", {"operator": "cma-mega"}, 120),
}
"""Encoding, emitter and generations, so that all take about as long."""
PAIRS = (("NEAT that learns", "NEAT"), ("CMA-MEGA, direct", "iso+line, direct"))
"""With derivatives, and without."""


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
    """24 nodes, 48 × 48 cells, 2,000 steps, 20 × 20 cells, 50 generations of 64."""
    chosen = METHODS[method]
    search = {**chosen.get("search", {}), "generations": 50, "batch": 64}
    return written({**chosen, "seed": seed, "search": search})


def compare(product: Installation, runs: dict[str, list[dict]]) -> bool:
    """Print and draw medians and ranges; tell whether medians reach their bars."""
    found = {n: [[run[f] for run in some] for f in FIGURES] for n, some in runs.items()}
    rich.print(table("median (range)", FIGURES.values(), found))
    good = True
    for (method, figure), bar in BARS.items():
        own, other = ([run[figure] for run in runs[n]] for n in (method, "random"))
        ratio = statistics.median(own) / statistics.median(other)
        good &= ratio > bar
        rich.print(
            f"{method}, {figure}: {ratio:.2f} × random search (bar {bar}), {rank(own, other)}"
        )
    draw(runs)
    for method, some in runs.items():
        purities = [purity(file) for run in some for file in fittest(product, run["id"], 10)]
        rich.print(
            f"{method}: {np.mean(np.array(purities) >= PURE):.0%} of the ten fittest of each "
            f"seed are sinusoidal (median {statistics.median(purities):.0%} of the power in "
            "one harmonic)"
        )
    return good


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


def draw(runs: dict[str, list[dict]]) -> None:
    """A panel for each figure, a point for each seed, a bar at the median."""
    figure = Figure(figsize=(10, 3.2), layout="constrained")
    for axes, (key, title) in zip(figure.subplots(1, 3), FIGURES.items(), strict=True):
        for column, found in enumerate(runs.values()):
            values = [run[key] for run in found]
            axes.plot([column] * len(values), values, "o", alpha=0.5, color=f"C{column}")
            middle = statistics.median(values)
            axes.plot([column - 0.3, column + 0.3], [middle] * 2, color=f"C{column}", lw=2)
        labels = [method.replace(", ", ",\n") for method in runs]
        axes.set_xticks(range(len(runs)), labels, fontsize=7)
        axes.set_title(title, fontsize=10)
        axes.set_ylim(bottom=0)
        axes.spines[["top", "right"]].set_visible(False)
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
    driven = search.drive(task, actuator)
    angle = np.asarray(driven.inputs.angle, float)
    # At equal times of the controller's clock, which slows where the body would be too fast.
    phase = np.arange(len(angle)) if driven.clock is None else np.asarray(driven.clock, float)
    last = phase[-1] // scene.control.period * scene.control.period
    at = last - scene.control.period * np.arange(1, 65) / 64
    angle = np.stack([np.interp(at, phase, one) for one in angle.T], 1)
    power = (np.abs(np.fft.rfft(angle, axis=0)) ** 2).sum(1)[1:]
    return float(power.max() / power.sum()) if power.sum() > 0 else 0.0


def slope_spec(seed: int, method: str) -> dict:
    """16 nodes, 32 × 32 cells, 800 steps, 20 × 20 cells."""
    encoding, emitter, generations = SLOPE_METHODS[method]
    control = {"encoding": encoding, "period": 120, "angle_scale": 0.6}
    search = {"generations": generations, "batch": 32, "emitters": [emitter]}
    size = {"world": {"width": 32, "height": 32}, "body": {"nodes": 16}, "task": {"steps": 800}}
    return written({**size, "seed": seed, "control": control, "search": search})


def compare_slopes(product: Installation) -> bool:
    """Compare searches with derivatives and without, by evaluations and by device-seconds.

    Either may win.
    """
    curves = {
        method: [
            curve(product, carry_out(product, slope_spec(s, method), f"{method}, seed {s}"))
            for s in SEEDS
        ]
        for method in SLOPE_METHODS
    }
    most = [min(one[axis][-1] for runs in curves.values() for one in runs) for axis in (0, 1)]
    found = {
        method: [[score_at(one, axis, most[axis]) for one in runs] for axis in (0, 1)]
        for method, runs in curves.items()
    }
    columns = ("equal evaluations", "equal device-seconds")
    rich.print(table("median QD score (range)", columns, found))
    rich.print(f"at {most[0]:.0f} evaluations, and at {most[1]:.1f} device-seconds")
    for pair in PAIRS:
        for column, own, other in zip(columns, found[pair[0]], found[pair[1]], strict=True):
            ratio = statistics.median(own) / statistics.median(other)
            rich.print(f"{pair[0]}: {ratio:.2f} × {pair[1]} at {column}, {rank(own, other)}")
    draw_slopes(curves)
    return True


def curve(product: Installation, run: dict) -> np.ndarray:
    """Evaluations, device-seconds without compilation, and QD score, (3, generation)."""
    found = product.get(f"runs/{run['id']}/generations")
    seconds = np.array(found["summary"]["device_seconds"], float)
    seconds[0] = 0.0  # The first generation compiles the programs.
    return np.array([found["evaluations"], np.cumsum(seconds), found["qd_score"]])


def score_at(one: np.ndarray, axis: int, most: float) -> float:
    """The QD score of the last generation that ended by then."""
    return float(one[2, np.searchsorted(one[axis], most, side="right") - 1])


def draw_slopes(curves: dict[str, list[np.ndarray]]) -> None:
    """QD score against evaluations and against device-seconds, a line for each seed."""
    figure = Figure(figsize=(10, 3.6), layout="constrained")
    panels = figure.subplots(1, 2, sharey=True)
    for axis, label in enumerate(("evaluations", "device-seconds")):
        for number, (method, runs) in enumerate(curves.items()):
            for seed, one in enumerate(runs):
                once = method if seed == 0 else f"_{method}"
                style = {"color": f"C{number}", "lw": 1, "alpha": 0.8, "label": once}
                panels[axis].plot(one[axis], one[2], **style)
        panels[axis].set(xlabel=label, ylim=(0, None))
        panels[axis].spines[["top", "right"]].set_visible(False)
    panels[0].set_ylabel("QD score")
    panels[0].legend(fontsize=8, frameon=False)
    figure.savefig(PICTURES / "slopes.png", dpi=150)


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
