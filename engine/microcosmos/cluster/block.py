"""What travels to a helper and back, and what a helper does with it."""

import json
import time
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import jax

from ..build import build
from ..experiments.evolution import Evolution
from ..spec import parse

RUNS = 4
"""Runs whose programs a helper keeps."""


@dataclass(frozen=True)
class Work:
    """One block to compute."""

    spec: str
    """The whole spec of the run as JSON."""
    program: str
    """A name of `Evolution.block_programs`."""
    items: Any
    """Arrays whose first axis is the block."""


@dataclass(frozen=True)
class Answer:
    """The results of a block."""

    found: Any
    """As the program returns them, in NumPy arrays."""
    seconds: float
    """Time that the device took."""


@lru_cache(maxsize=RUNS)
def experiment_of(spec: str) -> Evolution:
    """Build the run of a spec, without what only its coordinator needs."""
    found = build(parse(json.loads(spec)))
    assert isinstance(found, Evolution)
    return found


def refusal(spec: str, device: str) -> str | None:
    """Return why this process cannot compute the blocks of a run, None if it can."""
    try:
        found = experiment_of(spec).device
    except Exception as error:  # Such as a missing plug-in: whatever it is, others may compute.
        return f"{type(error).__name__}: {error}"
    return None if found == device else f"its device is {found!r}, the run's {device!r}"


def compute(work: Work) -> Answer:
    """Compute a block on the first device of this process."""
    program = experiment_of(work.spec).block_programs()[work.program]
    return timed(program, work.items, jax.local_devices()[0])


def timed(program: Any, items: Any, device: Any) -> Answer:
    """Compute a block on a device; return its results and time."""
    began = time.monotonic()
    found = jax.device_get(program(jax.device_put(items, device)))
    return Answer(found, time.monotonic() - began)
