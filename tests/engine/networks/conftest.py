"""Genomes computed by TensorNEAT itself, and creatures' genes grown at random."""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from microcosmos.naming import ACTIVATIONS, encode

HERE = Path(__file__).parent / "tensorneat"
INPUTS, OUTPUTS = ("position", "sine", "cosine"), ("rest_angle", "rest_length")


@dataclass(frozen=True)
class Reference:
    """A file of genomes with what TensorNEAT computes for `inputs` (input, point)."""

    nodes: np.ndarray
    conns: np.ndarray
    meta: dict
    inputs: np.ndarray
    outputs: dict[int | None, np.ndarray]
    """(genome, output, point) in double precision, by steps; None as `meta` has them."""


def read(name: str) -> Reference:
    with np.load(HERE / f"{name}.npz") as file:
        arrays = dict(file)

    def double(name):
        return np.swapaxes(arrays[name].astype(float) + arrays[f"{name}_lo"], 1, 2)

    steps = [t for t in (1, 2, 3) if f"outputs_t{t}" in arrays]
    return Reference(
        arrays["nodes"],
        arrays["conns"],
        json.loads(str(arrays["meta"])),
        arrays["inputs"].T.astype(float),
        {None: double("outputs")} | {t: double(f"outputs_t{t}") for t in steps},
    )


@pytest.fixture(scope="session", params=["ff_bias", "ff_default", "ff_origin", "recurrent"])
def reference(request):
    return read(request.param)


@pytest.fixture(scope="session")
def plain():
    return read("ff_bias")


@pytest.fixture(scope="session")
def grown():
    """400 creatures' genes, each the work of up to 40 random mutations."""
    return [grow(np.random.default_rng([3, number])) for number in range(400)]


def grow(random: np.random.Generator) -> dict:
    """Genes with gaps in their numbers, disabled connections, and nodes without sources."""
    fixed = len(INPUTS) + len(OUTPUTS)
    nodes = {key: (0, 0.0) for key in range(len(INPUTS))}
    nodes |= {key: (random.integers(9), random.normal()) for key in range(len(INPUTS), fixed)}
    links = {(i, o): [True, random.normal()] for i in range(3) for o in (3, 4)}
    next_key = fixed
    for _ in range(random.integers(0, 41)):
        kind = random.integers(4)
        pairs = list(links)
        pair = pairs[random.integers(len(pairs))]
        if kind == 0:
            links[pair][0] = not links[pair][0]
        elif kind == 1:
            next_key += int(random.integers(1, 50))
            nodes[next_key] = (random.integers(9), random.normal())
            links[pair][0] = False
            links[pair[0], next_key] = [True, 1.0]
            links[next_key, pair[1]] = [True, links[pair][1]]
        elif kind == 2:
            source, target = (list(nodes)[i] for i in random.integers(0, len(nodes), 2))
            free = target > 2 and (source, target) not in links
            if free and not leads(links, target, source):
                links[source, target] = [True, random.normal()]
        else:
            key = list(nodes)[random.integers(3, len(nodes))]
            nodes[key] = (nodes[key][0], random.normal())
    return {
        "nodes": {
            "id": list(nodes),
            "activation": [ACTIVATIONS[name] for name, _ in nodes.values()],
            "bias": encode(np.array([bias for _, bias in nodes.values()])),
        },
        "connections": {
            "innovation": np.cumsum(random.integers(1, 9, len(links))).tolist(),
            "source": [source for source, _ in links],
            "target": [target for _, target in links],
            "enabled": [bool(on) for on, _ in links.values()],
            "weight": encode(np.array([weight for _, weight in links.values()])),
        },
    }


def leads(links: dict, start: int, end: int) -> bool:
    return start == end or any(leads(links, t, end) for s, t in links if s == start)
