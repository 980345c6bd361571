"""Four searches at equal evaluations: what they find, as a table and a figure."""

import statistics
from pathlib import Path

import numpy as np
from drive import Installation
from rich.console import Console
from rich.table import Table

from microcosmos.spec import parse

SEEDS = (0, 1, 2, 3, 4)
GENERATIONS, BATCH = 50, 64

METHODS = {
    "random": {"search": {"emitters": [{"operator": "random"}]}},
    "NEAT": {"experiment": "neuroevolution"},
    "MAP-Elites, NEAT": {"search": {"emitters": [{"operator": "neat"}]}},
    "MAP-Elites, iso+line, direct": {
        "control": {"encoding": "direct"},
        "search": {"emitters": [{"operator": "iso+line"}]},
    },
}
"""What differs between the searches; everything else is the default of the spec."""

BARS = {
    ("MAP-Elites, NEAT", "qd_score"): 1.3,
    ("MAP-Elites, NEAT", "best"): 1.2,
    ("NEAT", "best"): 1.0,
}
"""How far medians have to be above random search's, as ratios."""

FIGURES = {"best": "best fitness (cells)", "coverage": "coverage", "qd_score": "QD score"}
PURE = 0.9
"""Share of a gait's power in one harmonic from which on it counts as sinusoidal."""


def spec(seed: int, method: str) -> dict:
    """32 nodes, 64 × 64 cells, 500 steps, 20 × 20 cells, 50 generations of 64."""
    own = METHODS[method]
    size = {"generations": GENERATIONS, "batch": BATCH}
    search = {**own.get("search", {}), **size}
    whole = {"experiment": "quality-diversity", **own, "seed": seed, "search": search}
    return parse(whole).model_dump(mode="json")


def compare(runs: dict[str, list[dict]], console: Console) -> bool:
    """Print medians and ranges; whether medians are above random search's as they have to."""
    table = Table("median (range)", *FIGURES.values())
    for name, found in runs.items():
        table.add_row(name, *(_summary([run[f] for run in found]) for f in FIGURES))
    console.print(table)
    good = True
    for (name, figure), bar in BARS.items():
        own, other = (statistics.median(r[figure] for r in runs[n]) for n in (name, "random"))
        good &= own / other > bar
        console.print(f"{name}, {figure}: {own / other:.2f} × random search (bar {bar})")
    return good


def draw(runs: dict[str, list[dict]], path: Path) -> None:
    """A panel for each figure, a point for each seed, a bar at the median."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10, 3.2), layout="constrained")
    for axes, (name, title) in zip(figure.subplots(1, 3), FIGURES.items(), strict=True):
        for place, found in enumerate(runs.values()):
            values = [run[name] for run in found]
            axes.plot([place] * len(values), values, "o", alpha=0.5, color=f"C{place}")
            middle = statistics.median(values)
            axes.plot([place - 0.3, place + 0.3], [middle] * 2, color=f"C{place}", lw=2)
        labels = [method.replace(", ", ",\n") for method in runs]
        axes.set_xticks(range(len(runs)), labels, fontsize=7)
        axes.set_title(title, fontsize=10)
        axes.set_ylim(bottom=0)
        axes.spines[["top", "right"]].set_visible(False)
    figure.savefig(path, dpi=150)


def sinusoidal(place: Installation, runs: dict[str, list[dict]], console: Console) -> None:
    """Print which share of the fittest creatures moves by sinusoidal gaits."""
    for name, found in runs.items():
        purities = [purity(creature) for run in found for creature in fittest(place, run["id"])]
        share = np.mean(np.array(purities) >= PURE)
        console.print(
            f"{name}: {share:.0%} of the ten fittest of each seed are sinusoidal (median "
            f"{statistics.median(purities):.0%} of the power in one harmonic)"
        )


def fittest(place: Installation, run: str, count: int = 10) -> list[dict]:
    """The creature files of a run's fittest elites."""
    archive = place.http.get(f"/api/v1/runs/{run}/archive").raise_for_status().json()
    order = np.argsort(archive["fitness"])[::-1][:count]
    addresses = [f"/api/v1/creatures/{archive['creature'][i]}" for i in order]
    return [place.http.get(address).raise_for_status().json() for address in addresses]


def purity(file: dict) -> float:
    """The share of one harmonic in the power of all joints' rest angles, once at full size."""
    import jax
    import jax.numpy as jnp

    from microcosmos import search
    from microcosmos.archive import creature
    from microcosmos.build import build_task
    from microcosmos.viz.replay import actuator_of

    scene = creature.scene_of(creature.parse(file))
    task = build_task(scene, room=creature.room(file))
    actuator = jax.tree.map(jnp.asarray, actuator_of(file, scene))
    angle = np.asarray(search.drive(task, actuator).inputs.angle, float)
    period = round(scene.control.period)
    whole = (len(angle) - period) // period * period
    power = (np.abs(np.fft.rfft(angle[-whole:], axis=0)) ** 2).sum(1)[1:]
    return float(power.max() / power.sum()) if power.sum() > 0 else 0.0


def _summary(values: list[float]) -> str:
    digits = 3 if max(values) <= 1 else 2
    low, middle, high = min(values), statistics.median(values), max(values)
    return f"{middle:.{digits}f} ({low:.{digits}f}–{high:.{digits}f})"
