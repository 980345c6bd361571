"""The smallest runs of each kind that still have something to look at."""

from typing import Any

from drive import Installation

TINY: dict[str, Any] = {
    "experiment": "quality-diversity",
    "world": {"width": 24, "height": 24, "energy": {"packets": 3, "width": 2.0}},
    "body": {"nodes": 8},
    "control": {"period": 20},
    "task": {"steps": 40, "fitness": "displacement"},
    "search": {"generations": 3, "batch": 8, "block": 8},
}
"""A search in a world with energy; tests that only need some run share its program."""

CENTROIDS = 40
VORONOI = {
    "descriptors": [{"name": "path_length", "high": 1.0}, {"name": "bending_effort"}],
    "centroids": CENTROIDS,
}

OF_PRESETS: dict[str, tuple[str, str, dict[str, Any]]] = {
    "search": ("quality-diversity", "demo", {"search": {"generations": 30}}),
    "population": ("neuroevolution", "demo", {"search": {"generations": 12, "batch": 16}}),
    "sweep": (
        "gaits",
        "demo",
        {"forms": ["ours", "paper"], "viscosities": [0.1, 1.0], "period": 40, "steric": {}},
    ),
    "fold": ("folding", "demo", {"updates": 4}),
    "scaling": (
        "scaling",
        "demo",
        {"nodes": [200, 400, 800], "width": 64, "height": 64, "all_pairs": 400, "steps": 10},
    ),
}
"""Experiment, preset, and the fields that replace the preset's."""


def submit_small_runs(product: Installation) -> dict[str, str]:
    """Submit one of each: their ids by name."""
    presets = {
        (experiment["experiment"], preset["name"]): preset["spec"]
        for experiment in product.get("experiments")
        for preset in experiment["presets"]
    }
    of_presets = {
        name: product.submit(changed(presets[experiment, preset], less))
        for name, (experiment, preset, less) in OF_PRESETS.items()
    }
    return of_presets | {"voronoi": product.submit(TINY | {"archive": VORONOI})}


def changed(spec: dict[str, Any], less: dict[str, Any]) -> dict[str, Any]:
    """A spec with some of its fields replaced, at any depth."""
    return {
        name: changed(value, less[name])
        if isinstance(value, dict) and name in less
        else less.get(name, value)
        for name, value in spec.items()
    }
