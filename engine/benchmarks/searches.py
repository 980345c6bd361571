"""Searches for swimmers beside each other, at equal numbers of simulations.

Prints tables and asserts nothing. Every run is an archive file in `--results`: a call goes on
where the last one ended. The figures of a finished run are a row of `searches.csv` beside this
file, and it is not repeated: they are the same on every machine. Delete the rows of a search
that has changed. Coverage and QD score count feasible creatures only, as archives do.
`generation.py` has the seconds.
"""

import argparse
import csv
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import timing
from ranking import holm, quartiles, ranks

import microcosmos as mc
from microcosmos.archive import file, variety
from microcosmos.spec import parse
from microcosmos.spec.quality_diversity import PRESETS

NEAT = {"operator": "neat", "select": "mixed"}
DIRECT: dict[str, Any] = {"control": {"encoding": "direct"}}


AT_THE_END = {"every": 1_000_000, "samples": 4}
"""Re-evaluation of the elites once, after the last generation."""


def emitters(*given: Mapping[str, Any], **search: Any) -> dict[str, Any]:
    return {"search": {"emitters": list(given), "screening": None, **search}}


def screened(rounds: int, candidates: int) -> dict[str, Any]:
    return {"rounds": rounds, "candidates": candidates}


def container(kind: str, **settings: int) -> dict[str, Any]:
    return emitters(NEAT) | {"container": {"kind": kind, **settings}}


METHODS: dict[str, dict[str, Any]] = {
    "random": emitters({"operator": "random"}),
    "NEAT alone": {"experiment": "neuroevolution", "search": {"screening": None}},
    "MAP-Elites": emitters(NEAT),
    "curiosity": emitters(NEAT | {"select": "curiosity"}),
    "crossover": emitters(NEAT | {"crossover": 0.3}),
    "NEAT + MAP-Elites": emitters(NEAT, {"operator": "population"}),
    "dominated novelty": container("dominated-novelty", size=400),
    "learned axes": container("learned", bins=20),
    "Pareto fronts": container("fronts"),
    "screened 1 x 10": emitters(NEAT, screening=screened(1, 10)),
    "screened 1 x 40": emitters(NEAT, screening=screened(1, 40)),
    "screened 2 x 20": emitters(NEAT, screening=screened(2, 20)),
    "screened 4 x 10": emitters(NEAT, screening=screened(4, 10)),
    "screened 4 x 40": emitters(NEAT, screening=screened(4, 40)),
    "direct iso+line": DIRECT | emitters({"operator": "iso+line"}),
    "direct CMA-MAE": DIRECT | emitters({"operator": "cma-mae", "emitters": 4}),
    "direct screened": DIRECT | emitters({"operator": "iso+line"}, screening=screened(4, 40)),
}
"""Differences from the preset."""
BASELINE = "MAP-Elites"
"""The search that others are compared with."""
AXES = {
    "preset": None,
    "flow": [
        {"name": "strouhal", "low": 0.3, "high": 10.0, "scale": "log10", "bins": 20},
        {"name": "heading_angle", "bins": 20},
    ],
}
"""Axes of the archive: the preset's, or two that only the fluid tells."""
COLUMNS = ("QD score", "corrected QD score", "coverage, %", "best", "feasible, %", "kinds")
"""Corrected: from the means of four disturbed evaluations of every elite. Kinds: of motion."""
TESTED = 4
"""Columns that are tested."""
RECORD = Path(__file__).with_name("searches.csv")
"""Figures of finished runs."""
RUN = ("preset", "axes", "method", "generations", "seed")
"""Columns that identify a run in the record."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--preset", choices=PRESETS, default="standard")
    parser.add_argument("--axes", choices=AXES, default="preset")
    parser.add_argument("--seeds", type=int, default=2)
    parser.add_argument("--generations", type=int, default=10)
    parser.add_argument("--methods", nargs="+", choices=METHODS, default=["MAP-Elites"])
    parser.add_argument("--results", type=Path, required=True, help="folder of archive files")
    chosen = parser.parse_args()
    mc.prepare()
    found: dict[str, list[list[float]]] = {method: [] for method in chosen.methods}
    for seed in range(chosen.seeds):
        for method in chosen.methods:
            found[method].append(recorded(chosen, method, seed))
    rows = {method: np.array(values) for method, values in found.items()}
    evaluations = chosen.generations * PRESETS[chosen.preset][1].search.batch
    title = f"{chosen.preset}, {evaluations:,} simulations, {chosen.seeds} seeds"
    lines = [(method, *map(quartiles, values.T)) for method, values in rows.items()]
    timing.print_table(f"{title}: median (quartiles)", ("", *COLUMNS), lines)
    print_tests(rows)


def recorded(chosen: argparse.Namespace, method: str, seed: int) -> list[float]:
    """Return the columns of a run, from the record or by carrying it out."""
    run = (chosen.preset, chosen.axes, method, str(chosen.generations), str(seed))
    with RECORD.open(newline="") as stream:
        for row in csv.DictReader(stream):
            if tuple(row[name] for name in RUN) == run:
                return [float(row[name]) for name in COLUMNS]
    found = figures(carried_out(chosen, method, seed))
    with RECORD.open("a", newline="") as stream:
        csv.writer(stream, lineterminator="\n").writerow([*run, *(f"{x:.6g}" for x in found)])
    return found


def carried_out(chosen: argparse.Namespace, method: str, seed: int) -> Path:
    """Return the archive file of a finished run."""
    preset = PRESETS[chosen.preset][1]
    document = preset.model_dump(mode="json", exclude_unset=True)
    document["control"] = preset.control.model_dump(mode="json")  # With its `encoding`.
    changes = METHODS[method]
    search = document.get("search", {}) | changes.get("search", {})
    search = {name: value for name, value in search.items() if value is not None}
    search |= {"generations": chosen.generations, "reevaluation": AT_THE_END}
    archive = document.get("archive", {})
    if axes := AXES[chosen.axes]:
        archive["descriptors"] = axes
    changes = dict(changes)
    archive["container"] = changes.pop("container", None)
    document |= changes | {"seed": seed, "search": search, "archive": archive}
    document.setdefault("experiment", "quality-diversity")
    name = f"{chosen.preset} {chosen.axes} {method} {chosen.generations} {seed}.h5"
    path = chosen.results / name
    path.parent.mkdir(parents=True, exist_ok=True)
    if not path.exists() or not is_whole(path):
        mc.evolve(parse(document), path)
    print(f"{name}: " + ", ".join(f"{x:.3f}" for x in figures(path)), flush=True)
    return path


def is_whole(path: Path) -> bool:
    """Return whether a run has ended."""
    _, attributes = file.load(path.read_bytes())
    return json.loads(attributes["ended"]) is not None


def figures(path: Path) -> list[float]:
    """Return the columns of a finished run."""
    tree, _ = file.load(path.read_bytes())
    curves = {name: np.asarray(column) for name, column in tree["curves"].items()}
    infeasible = curves["infeasible"][-2] / curves["evaluations"][-2]
    names = ("qd_score", "corrected_qd_score", "coverage", "best")
    scales = (1, 1, 100, 1)
    values = [scale * curves[name][-1] for name, scale in zip(names, scales, strict=True)]
    kinds = variety.of(path.read_bytes()).kinds
    return [float(x) for x in (*values, 100 * (1 - infeasible), kinds)]


def print_tests(rows: dict[str, np.ndarray]) -> None:
    """Print tests of every method against MAP-Elites."""
    if BASELINE not in rows or len(rows) < 2:
        return
    lines, p_values, base = [], [], rows[BASELINE]
    for method, values in rows.items():
        if method == BASELINE:
            continue
        for i, column in enumerate(COLUMNS[:TESTED]):
            share, p = ranks(values[:, i], base[:, i])
            ratio = np.median(values[:, i]) / np.median(base[:, i])
            lines.append((method, column, f"{ratio:.2f}", f"{100 * share:.0f} %"))
            p_values.append(p)
    corrected = [f"{p:.2g}" for p in holm(p_values)]
    lines = [(*line, p) for line, p in zip(lines, corrected, strict=True)]
    title = f"Beside {BASELINE}: two-sided tests of Mann and Whitney"
    columns = ("", "of", "ratio of medians", "greater in", "p, Holm")
    timing.print_table(title, columns, lines)


if __name__ == "__main__":
    main()
