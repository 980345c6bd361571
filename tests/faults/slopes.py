"""Searches with derivatives and without, as a table and a figure."""

import statistics

import numpy as np
import rich
from drive import Installation
from matplotlib.figure import Figure
from searches import PICTURES, SEEDS, carry_out, rank, table, written

SLOPE_METHODS = {
    "NEAT": ("cppn", {"operator": "neat"}, 400),
    "iso+line, direct": ("direct", {"operator": "iso+line"}, 400),
    "CMA-MEGA, direct": ("direct", {"operator": "cma-mega"}, 60),
}
"""Encoding, emitter and generations; a gradient takes as long as many simulations."""
PAIR = ("CMA-MEGA, direct", "iso+line, direct")
"""With derivatives, and without."""


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
    curves: dict[str, list[np.ndarray]] = {method: [] for method in SLOPE_METHODS}
    for seed in SEEDS:  # The methods take turns, so that other work on the machine slows all.
        for method, found in curves.items():
            run = carry_out(product, slope_spec(seed, method), f"{method}, seed {seed}")
            found.append(curve(product, run))
    most = [min(one[axis][-1] for runs in curves.values() for one in runs) for axis in (0, 1)]
    found = {
        method: [[score_at(one, axis, most[axis]) for one in runs] for axis in (0, 1)]
        for method, runs in curves.items()
    }
    columns = ("equal evaluations", "equal device-seconds")
    rich.print(table("median QD score (range)", columns, found))
    rich.print(f"at {most[0]:.0f} evaluations, and at {most[1]:.1f} device-seconds")
    slopes, plain = PAIR
    for column, own, other in zip(columns, found[slopes], found[plain], strict=True):
        ratio = statistics.median(own) / statistics.median(other)
        rich.print(f"{slopes}: {ratio:.2f} × {plain} at {column}, {rank(own, other)}")
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
