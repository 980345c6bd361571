"""A program that runs a part of `make acceptance` at a tiny size, whatever it finds there:
`tiny_acceptance.py PART FOLDER PORT`, the last two of a running product.

The parts compute with JAX, which a process of the tests of the server must not.
"""

import sys
import tempfile
from pathlib import Path
from typing import Any

import acceptance
import left_open
import processors
import searches
import slopes
import swimming
import takeover
import zoo
from drive import SHORT, Installation, kill_job
from small_spec import SMALL_SCENE

from microcosmos.spec import parse


def small(document: dict[str, Any]) -> Any:
    """Return the spec of a document for a hundred steps; chains are short in a small world."""
    sizes = {
        "control": {"period": 20},
        "task": {"steps": 100},
        "search": {"batch": 16, "block": 8, "screening": None, "feasible": False},
    }
    if document.get("body", {}).get("builder") != "grown":
        sizes["body"] = {"builder": "chain", "nodes": 12}
        sizes["world"] = {"width": 32, "height": 32}
    if document.get("experiment") == "neuroevolution":
        for name in ("screening", "feasible"):
            del sizes["search"][name]
    changed = {name: document.get(name, {}) | part for name, part in sizes.items()}
    return parse({"experiment": "quality-diversity", **document, **changed})


def shrink(folder: Path) -> None:
    """Give the parts one seed, few generations, few methods and small worlds."""
    presets = {}
    for name in ("demo", "zoo"):
        document = acceptance.PRESETS[name][1].model_dump(mode="json")
        document["search"]["generations"] = 2
        presets[name] = ("", small(document))
    presets["standard"] = presets["demo"]
    for module in (searches, slopes, swimming, zoo, acceptance):
        module.SEEDS = (0,)
    for module in (swimming, zoo, acceptance):
        module.PRESETS = presets
    for module in (searches, slopes):
        module.PICTURES = folder
        module.written = lambda document: small(document).model_dump(mode="json")
    methods = ("random", "MAP-Elites, NEAT")
    searches.METHODS = {name: searches.METHODS[name] for name in methods}
    searches.BUDGETS = (64 * 20, 64 * 40)
    searches.BARS = {(searches.BUDGETS[0], methods[1], "best"): 1.0}
    acceptance.METHODS = searches.METHODS
    acceptance.DOCUMENTS = {"chains": searches.spec(0, "MAP-Elites, NEAT")}
    acceptance.FAULTS = (kill_job,)
    acceptance.LATEST = 20
    acceptance.SETTINGS = SHORT
    slopes.SLOPE_METHODS = {name: (*slopes.SLOPE_METHODS[name][:2], 2) for name in slopes.PAIR}
    searches.FITTEST = 1
    swimming.EXAMINED = ("standard",)
    swimming.ELITES = {"fittest": 1, "others": 0}
    swimming.WAVES = {"amplitude": (0.2, 0.4), "number": (1.0,), "period": (20.0,)}
    zoo.NODES = 1
    zoo.CONTROL_GENERATIONS = zoo.TASK_GENERATIONS = 2
    zoo.PLACES = {"through": zoo.PLACES["through"]}
    zoo.PLACES["through"]["task"]["steps"] = 100
    takeover.TIMES = 1
    takeover.SETTINGS = SHORT
    left_open.SAMPLES, left_open.MINUTES, left_open.HOVER_MS = 3, 0.05, 100
    left_open.SPEC |= SMALL_SCENE
    processors.EMULATED = ["env"]


def main() -> None:
    part, data, port = sys.argv[1:]
    with tempfile.TemporaryDirectory() as folder:
        shrink(Path(folder))
        acceptance.PARTS[part](Installation(Path(data), SHORT, int(port)))


if __name__ == "__main__":
    main()
