"""Every benchmark runs to its end at a tiny size."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from drive import QUICK

ROOT = Path(__file__).parents[2]
FOLDERS = [ROOT / part / "benchmarks" for part in ("engine", "server", "web")]
SEARCH = {
    "world": {"width": 24, "height": 24},
    "body": {"nodes": 8},
    "control": {"period": 20},
    "task": {"steps": 20, "fitness": "displacement"},
    "search": {"batch": 8, "block": 8},
}
QD = SEARCH | {"experiment": "quality-diversity"}
SCREENED = QD | {"search": SEARCH["search"] | {"screening": {"rounds": 1, "candidates": 2}}}
GENERATION = {
    "WARM": 1,
    "TIMED": 1,
    "LARGE": {"descriptors": [{"name": n, "bins": 4} for n in ("symmetry", "curvature_mean")]},
    "SEARCHES": {
        "MAP-Elites, NEAT": QD,
        "NEAT": SEARCH | {"experiment": "neuroevolution"},
        "MAP-Elites, NEAT, screened": SCREENED,
    },
}
FOLDING = {
    "body": {"builder": "walk", "nodes": 48, "spacing": 0.5, "deviation": 0.6, "seed": 4},
    "steps": 10,
}

TINY: dict[str, tuple[str, dict[str, Any]]] = {
    "accelerator": ("", {}),
    "archive": (
        "",
        {"ROWS": 16, "GENES": 8, "SIDES": [8], "STAGES": {"early": 1}, "TURNS": 2}
        | {"CENTROIDS": 64, "SAMPLES": 100, "SEEDS": [0]},
    ),
    "aurora": ("--seeds 2 --generations 2", {}),
    "budget": ("", {"REPEATS": 1, "CELLS": 1 << 14, "SIDES": [32], "CROWDS": [20]}),
    "classic": (
        "--seeds 1 --generations 2 --tasks sphere --turns 1",
        {"classic_times.WARM": 1},
    ),
    "cluster": ("--seconds 0.01 --blocks 2 --helpers 1 --preset demo", {}),
    "cma_mega": ("", {"GENERATIONS": 2, "SEEDS": [0]}),
    "crowd": ("", {"REPEATS": 1, "CROWDS": [[64, 3, 5]]}),
    "fronts": ("--seeds 2 --generations 2 --lengths 4", {}),
    "generation": ("", GENERATION),
    "gradients": ("", {"SIZES": [[32, 8]], "STEPS": 16, "REPEATS": 1, "FOLDING": FOLDING}),
    "kernel": (
        "",
        {"REPEATS": 1, "CREATURES": 1, "STEPS": 10, "CROWDS": [200], "PRESETS": ["zoo"]},
    ),
    "networks": ("", {"SIZES": [[20, 1, 1]], "HIDDEN": [3], "FORWARD": 8}),
    "physics": (
        "",
        {"WORLDS": 2, "SIZE": [16, 16], "NODES": 8, "STEPS": 2, "REPEATS": 1, "LARGE": 1024},
    ),
    "searches": (
        "--preset demo --seeds 1 --generations 2 --methods MAP-Elites random --results found",
        {"RECORD": "searches.csv"},
    ),
    "sinks": ("--rounds 1 --generations 2", {}),
    "xor": ("1", {}),
    "load": (
        "--archive 1 --posts 4 --watch 1 --rounds 1",
        {
            "SIDE": 10,
            "FILLED": 50,
            "WATCHERS": 4,
            "ATTACKERS": 4,
            "SERVERS": [2],
            "CONNECTED": 1,
        }
        | {"SHORT": {"archive": 1.0, "posts": 4, "watch": 1.0, "rounds": 1}},
    ),
    "page": (
        "",
        {"CREATURES": 4, "BIRTHS": 100, "GENERATIONS": 3, "SECONDS": 0.2, "TIMES": 2}
        | {"REDRAWS": 3, "HOVERS": 2, "births.PANNED_SECONDS": 0.3, "TRAILS_MS": 0}
        | {"MEDIUM": 10, "LARGE": 20, "births.DRAWN_MS": 200, "SCROLLED_MS": 20},
    ),
    "simulate": ("", {"REPEATS": 1, "STEPS": 20, "SIDES": [40]}),
    "start": ("", {"TIMES": 1}),
}
"""Arguments and constants with which a benchmark takes seconds."""

RUN = """
import dataclasses, importlib, json, pathlib, sys

def main():
    name, constants, *sys.argv[1:] = sys.argv[1:]
    for place, value in json.loads(constants).items():
        of, _, constant = place.rpartition(".")
        module = importlib.import_module(of or name)
        old = getattr(module, constant)
        if dataclasses.is_dataclass(old):
            value = dataclasses.replace(old, **value)
        elif isinstance(old, (tuple, pathlib.Path)):
            value = type(old)(value)
        setattr(module, constant, value)
    importlib.import_module(name).main()

if __name__ == "__main__":
    main()
"""
"""A file, since benchmarks start processes that import it: it sets constants and runs one."""


def scripts() -> dict[str, Path]:
    files = (path for folder in FOLDERS for path in folder.glob("*.py"))
    return {path.stem: path for path in files if "__main__" in path.read_text()}


def test_every_benchmark_has_a_tiny_size():
    assert TINY.keys() == scripts().keys()


@pytest.mark.long
@pytest.mark.parametrize("name", TINY)
def test_a_benchmark_runs_to_its_end(name, tmp_path):
    arguments, constants = TINY[name]
    script = scripts()[name]
    record = script.with_name("searches.csv")
    if record.exists():
        (tmp_path / record.name).write_text(record.read_text().splitlines()[0] + "\n")
    (tmp_path / "run.py").write_text(RUN)
    command = [sys.executable, tmp_path / "run.py", name, json.dumps(constants)]
    path = os.pathsep.join([str(script.parent), os.environ.get("PYTHONPATH", "")])
    done = subprocess.run(
        [*command, *arguments.split()],
        cwd=tmp_path,
        env=os.environ | QUICK | {"PYTHONPATH": path},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr[-4000:]
    assert done.stdout.strip()
    # A measurement of the page that failed.
    assert "not there" not in done.stdout, done.stderr[-4000:]
    if missing := re.search(r"SKIPPED.*|.*is not installed.*", done.stdout):
        pytest.skip(missing[0])
