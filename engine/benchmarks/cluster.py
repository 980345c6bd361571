"""The efficiency of helpers: blocks that sleep, and real blocks with one helper and two.

Prints two tables and asserts nothing. Efficiency is the time that blocks take, over the time of
all helpers from the first block to the last. Helpers are processes of this machine.
"""

import argparse
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import microcosmos as mc
from microcosmos import plugins
from microcosmos.build import build
from microcosmos.cluster.devices import ClusterDevices
from microcosmos.experiments.evolution import Evolution
from microcosmos.search import loop
from microcosmos.spec import Spec, parse
from microcosmos.spec.quality_diversity import PRESETS

SLEEPER = '''
"""A measure that takes a time, and no processor."""
import os, time
import jax, numpy as np
from microcosmos import plugins


def sleep(value):
    time.sleep(float(os.environ["SLEEP"]))
    return np.float32(value)


@plugins.descriptor("slept", title="Slept", low=0, high=3)
def slept(motion):
    one = jax.ShapeDtypeStruct((), np.float32)
    return jax.pure_callback(
        sleep, one, motion.measures["displacement"], vmap_method="sequential"
    )
'''
TINY = {
    "experiment": "quality-diversity",
    "world": {"width": 32, "height": 32},
    "body": {"nodes": 12},
    "control": {"period": 30},
    "task": {"steps": 30, "fitness": "displacement"},
}
PORT = 18_790


@contextmanager
def helpers(count: int, modules: list[Path], **settings: str) -> Iterator[str]:
    """Start a scheduler and helpers; yield the address."""
    url = f"tcp://127.0.0.1:{PORT}"
    options = [word for file in modules for word in ("--module", str(file))]
    commands = [("-m", "microcosmos", "cluster", "scheduler", url)]
    for number in range(count):
        commands += [("-m", "microcosmos.cluster.helper", url, f"helper {number}", *options)]
    started = []
    try:
        for command in commands:
            started += [
                subprocess.Popen(
                    [sys.executable, *command],
                    stdin=subprocess.PIPE,
                    stderr=subprocess.DEVNULL,
                    env=os.environ | settings,
                )
            ]
            time.sleep(5 if len(started) == 1 else 0)
        yield url
    finally:
        for one in started:
            one.kill()
            one.wait()


def computing(experiment: Evolution, url: str, count: int) -> ClusterDevices:
    """Return the devices of a cluster once all its helpers compute for the run."""
    devices = ClusterDevices(experiment, url, None, own=False)
    while devices.summary()["cluster.devices"] < count:
        time.sleep(0.2)
    return devices


def measured(experiment: Evolution, devices: ClusterDevices, count: int) -> tuple[float, float]:
    """Return the wall time of a generation's blocks, and the efficiency."""
    state = experiment.init()
    program = experiment.plan.programs[loop.OFFSPRING]
    genotypes = experiment.propose(state).children.genotypes
    devices.evaluate(program.run, genotypes, block=program.block)  # It compiles.
    before, began = devices.seconds(), time.perf_counter()
    devices.evaluate(program.run, genotypes, block=program.block)
    wall = time.perf_counter() - began
    return wall, (devices.seconds() - before) / (count * wall)


def built(spec: Spec) -> Evolution:
    found = build(spec)
    assert isinstance(found, Evolution)
    return found


def sleeping(seconds: list[float], count: int, blocks: int) -> None:
    print(f"\n{blocks} blocks that sleep, {count} helpers")
    print(f"{'s a block':>10} {'wall, s':>9} {'efficiency, %':>14}")
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "sleeper.py"
        file.write_text(SLEEPER)
        plugins.load(file)
        archive = {"descriptors": [{"name": "sleeper.slept", "bins": 8}]}
        search = {"batch": blocks, "block": 1, "generations": 1}
        experiment = built(parse(TINY | {"archive": archive, "search": search}))
        for each in seconds:
            with helpers(count, [file], SLEEP=str(each)) as url:
                devices = computing(experiment, url, count)
                wall, efficiency = measured(experiment, devices, count)
                devices.close()
            print(f"{each:10g} {wall:9.2f} {100 * efficiency:14.1f}", flush=True)


def real(counts: list[int], preset: str) -> None:
    print(f"\nA generation of {preset}")
    print(f"{'helpers':>8} {'wall, s':>9} {'efficiency, %':>14}")
    experiment = built(PRESETS[preset][1])
    for count in counts:
        with helpers(count, []) as url:
            devices = computing(experiment, url, count)
            wall, efficiency = measured(experiment, devices, count)
            devices.close()
        print(f"{count:8} {wall:9.2f} {100 * efficiency:14.1f}", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument(
        "--seconds", type=float, nargs="+", default=[0.1, 0.3, 1.0, 3.0, 10.0, 30.0]
    )
    parser.add_argument("--blocks", type=int, default=30)
    parser.add_argument("--helpers", type=int, default=3)
    parser.add_argument("--preset", choices=PRESETS, default="standard")
    asked = parser.parse_args()
    mc.prepare(devices=1)
    sleeping(asked.seconds, asked.helpers, asked.blocks)
    real([1, 2], asked.preset)


if __name__ == "__main__":
    main()
