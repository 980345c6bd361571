"""Quality-diversity with derivatives against the same without, by evaluations and by time."""

import statistics
from collections.abc import Callable
from pathlib import Path

import numpy as np
from drive import Installation
from rich.console import Console
from rich.table import Table

from microcosmos.spec import parse

SEEDS = (0, 1, 2, 3, 4)
BATCH = 32

METHODS = {
    "NEAT": ("cppn", {"operator": "neat"}, 200),
    "NEAT that learns": ("cppn", {"operator": "lamarckian", "lessons": 1, "step": 0.5}, 50),
    "iso+line, direct": ("direct", {"operator": "iso+line"}, 200),
    "CMA-MEGA, direct": ("direct", {"operator": "cma-mega"}, 120),
}
"""Encoding, emitter and generations, so that all take about as long."""

PAIRS = (("NEAT that learns", "NEAT"), ("CMA-MEGA, direct", "iso+line, direct"))
"""With derivatives, and without."""


def spec(seed: int, method: str) -> dict:
    """16 nodes, 32 × 32 cells, 100 steps, 20 × 20 cells."""
    encoding, emitter, generations = METHODS[method]
    scale = {"period": 50, "angle_scale": 0.3, "length_scale": 0.2}
    whole = {
        "experiment": "quality-diversity",
        "seed": seed,
        "world": {"width": 32, "height": 32},
        "body": {"nodes": 16},
        "control": {"encoding": encoding, **scale},
        "task": {"steps": 100},
        "search": {"generations": generations, "batch": BATCH, "emitters": [emitter]},
    }
    return parse(whole).model_dump(mode="json")


def compare_slopes(
    place: Installation,
    carry_out: Callable[[Installation, dict, str], dict],
    console: Console,
    path: Path,
) -> None:
    """Print QD scores at equal evaluations and at equal device-seconds, and who is ahead."""
    curves = {
        name: [
            curve(place, carry_out(place, spec(s, name), f"{name}, seed {s}")) for s in SEEDS
        ]
        for name in METHODS
    }
    table = Table("median QD score (range)", "equal evaluations", "equal device-seconds")
    most = [min(one[axis][-1] for runs in curves.values() for one in runs) for axis in (0, 1)]
    found = {
        name: [[at(one, axis, most[axis]) for one in runs] for axis in (0, 1)]
        for name, runs in curves.items()
    }
    for name, columns in found.items():
        table.add_row(name, *(_summary(values) for values in columns))
    console.print(table)
    console.print(f"at {most[0]:.0f} evaluations, and at {most[1]:.1f} device-seconds")
    for with_slopes, without in PAIRS:
        ratios = [
            statistics.median(found[with_slopes][axis])
            / statistics.median(found[without][axis])
            for axis in (0, 1)
        ]
        console.print(
            f"{with_slopes}: {ratios[0]:.2f} × {without} at equal evaluations, "
            f"{ratios[1]:.2f} × at equal device-seconds"
        )
    draw_slopes(curves, path)


def curve(place: Installation, run: dict) -> np.ndarray:
    """(3, generation): evaluations, device-seconds without the first generation, in which
    programs are compiled, and QD score."""
    found = place.http.get(f"/api/v1/runs/{run['id']}/generations").raise_for_status().json()
    seconds = np.array(found["summary"]["device_seconds"], float)
    seconds[0] = 0.0
    return np.array([found["evaluations"], np.cumsum(seconds), found["qd_score"]])


def at(one: np.ndarray, axis: int, most: float) -> float:
    """The QD score of the last generation that ended by then."""
    return float(one[2, np.searchsorted(one[axis], most, side="right") - 1])


def draw_slopes(curves: dict[str, list[np.ndarray]], path: Path) -> None:
    """QD score against evaluations and against device-seconds, a line for each seed."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10, 3.6), layout="constrained")
    panels = figure.subplots(1, 2, sharey=True)
    for panel, axis, label in zip(
        panels, (0, 1), ("evaluations", "device-seconds"), strict=True
    ):
        for place, (name, runs) in enumerate(curves.items()):
            for number, one in enumerate(runs):
                label_once = name if number == 0 else f"_{name}"
                panel.plot(
                    one[axis], one[2], color=f"C{place}", lw=1, alpha=0.8, label=label_once
                )
        panel.set(xlabel=label, ylim=(0, None))
        panel.spines[["top", "right"]].set_visible(False)
    panels[0].set_ylabel("QD score")
    panels[0].legend(fontsize=8, frameon=False)
    figure.savefig(path, dpi=150)


def _summary(values: list[float]) -> str:
    return f"{statistics.median(values):.1f} ({min(values):.1f}–{max(values):.1f})"
