"""The evaluation of one creature by the page's kernel beside the native one, on one core.

Prints a table and asserts nothing. The page has to be built. Node stands for a browser: both
have the same engine. Numbers are microseconds a step, in the best of several evaluations.
"""

import json
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import jax
import numpy as np

from microcosmos import device, search, spec
from microcosmos.archive import creature
from microcosmos.audit import evaluation_inputs
from microcosmos.build import build, build_block
from microcosmos.viz.replay import actuator_of

WEB = Path(__file__).parents[1]
REPEATS, STEPS = 12, 1000
SIDES = (64, 128)


def main() -> None:
    device.prepare(devices=1)
    node = shutil.which("node", path=Path(sys.executable).parent) or shutil.which("node")
    if not node or not device.kernel_version():
        sys.exit("SKIPPED: needs node and the native kernel")
    print(f"{device.device_kind()}; one core; the best of {REPEATS}\n")
    print("| cells | native | page | page / native |\n|---|---|---|---|")
    for side in SIDES:
        file = any_creature(side)
        there, here = min(native(file)), min(page(node, file))
        micro = [f"{1e6 * found / STEPS:.1f}" for found in (there, here)]
        print(f"| {side} × {side} | {micro[0]} | {micro[1]} | {here / there:.1f} |")


def any_creature(side: int) -> dict:
    experiment = build(
        spec.parse(
            {
                "experiment": "quality-diversity",
                "world": {"width": side, "height": side},
                "body": {"nodes": 32},
                "task": {"steps": STEPS, "fitness": "displacement"},
                "search": {"generations": 1, "batch": 2, "block": 1},
            }
        )
    )
    return creature.parse(experiment.best(experiment.advance(experiment.init())[0]))


def native(file: dict) -> list[float]:
    """Return the seconds of evaluations by the program of a search."""
    scene = creature.scene_of(file)
    program, one = build_block(scene), jax.tree.map(np.asarray, actuator_of(file, scene))
    batch = jax.tree.map(lambda x: x[None], one)

    def seconds() -> float:
        began = time.perf_counter()
        search.evaluate_blocks(program, batch, block=1)
        return time.perf_counter() - began

    seconds()  # Compiles.
    return [seconds() for _ in range(REPEATS)]


def page(node: str, file: dict) -> list[float]:
    """Return the seconds of evaluations by the worker of the built page."""
    with tempfile.NamedTemporaryFile() as inputs:
        inputs.write(evaluation_inputs(file))
        inputs.flush()
        script = [node, WEB / "scripts" / "evaluate.mjs", WEB / "dist" / "assets"]
        answers = subprocess.check_output([*script, *[inputs.name] * REPEATS])
    return [answer["found"]["seconds"] for answer in json.loads(answers)]


if __name__ == "__main__":
    main()
