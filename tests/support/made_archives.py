"""Archives that tests of exports make up."""

import json

import numpy as np

from microcosmos.archive import file, poses
from microcosmos.measures import RECORDED

AXES = [
    {"name": "bending_effort", "low": 1e-4, "high": 100.0, "bins": 4, "scale": "log10"},
    {"name": "straightness", "low": 0.0, "high": 1.0, "bins": 3, "scale": "linear"},
]
AROUND = np.random.default_rng(0).random((12, 2)).astype(np.float32)
CELLS = np.array([1, 6, 11], np.int32)


def stream(nodes, length, creature):
    draw = np.random.default_rng(nodes)
    places, middles, scale = poses.quantised(draw.random((64, nodes, 2)) * 9)
    edges = np.stack([np.arange(nodes - 1), np.arange(1, nodes)], 1)
    path = draw.random((65, 2)).astype(np.float32)
    return poses.PoseStream(
        places, path, middles, scale, edges, 40, 100, 2, 100, (24, 24), length, creature
    )


def elites(kind, sizes, generations, lengths):
    """Return the group `archive` of the elites, whose bodies have so many nodes."""
    names, draw = np.arange(96, dtype=np.uint8).reshape(3, 32), np.random.default_rng(1)
    bodies = zip(sizes, lengths, names, strict=True)
    streams = [stream(n, length, bytes(name).hex()) for n, length, name in bodies]
    found = {
        "cell": CELLS,
        "fitness": np.array([1.5, 2.5, np.pi], np.float32),
        "measures": draw.random((3, len(RECORDED))).astype(np.float32),
        "generation": np.array(generations, np.int32),
        "curiosity": np.ones(3, np.float32),
        "operator": np.array([0, 1, 1], np.int32),
        "device": np.zeros(3, np.int32),
        "creature": names,
        "genomes": {"weight": draw.random((3, 4)).astype(np.float32)},
        "poses": poses.columns(streams),
    }
    return found | ({"centroids": AROUND} if kind == "cvt" else {})


def made(
    kind="grid",
    sizes=(3, 5, 4),
    parents=None,
    generations=(1, 2, 2),
    lengths=(7.5, 7.5, 7.5),
    spec=None,
    **arrays,
):
    """Return the bytes of an archive whose elites lie in cells 1, 6 and 11."""
    container = {"kind": "novelty", "size": 12} if kind == "pool" else None
    described = {"descriptors": AXES, "container": container}
    described |= {"centroids": 12 if kind == "cvt" else None}
    archive = elites(kind, sizes, generations, lengths)
    copied = ("creature", "operator", "generation", "cell", "fitness")
    lineage = {
        **{name: archive[name] for name in copied},
        "parents": np.zeros((3, 2, 32), np.uint8) if parents is None else parents,
        "descriptors": archive["measures"][:, :2],
    }
    curves = ("qd_score", "coverage", "best", "mean", "evaluations")
    tree = {
        "archive": archive,
        "curves": {name: np.full(3, 3.0) for name in curves},
        "emitters": {"children": np.full((3, 1), 8)},
        "lineage": lineage,
        "loop": {"generation": np.int64(3)},
        **arrays,
    }
    document = {
        "experiment": "quality-diversity",
        "archive": described,
        "seed": 0,
        "task": {"fitness": "speed", "steps": 400},
        "world": {"width": 24, "height": 24},
        "body": {"nodes": 12},
        "search": {"generations": 3},
        **(spec or {}),
    }
    attributes = {
        "format": file.FORMAT,
        "version": "0.1.0",
        "device": '["cpu"]',
        "spec": json.dumps(document),
        "measures": json.dumps(list(RECORDED)),
        "operators": '["random", "neat"]',
    }
    return file.dump(tree, attributes)


def without_elites(data):
    """Return the same run as if no creature had been feasible, as a search writes it."""
    tree, attributes = file.load(data)
    for name in ("qd_score", "coverage", "best", "mean"):
        tree["curves"][name] = np.zeros_like(tree["curves"][name])
    emptied = {name: _emptied(tree[name]) for name in ("archive", "lineage")}
    return file.dump(tree | emptied, attributes)


def _emptied(part):
    return {
        name: _emptied(one)
        if isinstance(one, dict)
        else one
        if name == "centroids"
        else one[:0]
        for name, one in part.items()
    }
