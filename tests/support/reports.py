"""Creatures, reports, archives and replays, as experiments and renderers make them."""

import json
import struct
from types import SimpleNamespace
from typing import Any

import numpy as np

from microcosmos.archive import creature, file
from microcosmos.archive import poses as pose_streams
from microcosmos.naming import encode
from microcosmos.spec import EXPERIMENTS, QualityDiversity

EFFORTS = ("bending_effort", "stretching_effort")
_DEMO = EXPERIMENTS["quality-diversity"].presets[0].spec.model_dump()
DEMO = QualityDiversity.model_validate(
    _DEMO
    | {"archive": {"descriptors": [{"name": name, "bins": 16} for name in EFFORTS]}}
    | {"task": _DEMO["task"] | {"fitness": "displacement"}}
)
"""The demonstration with another fitness and other axes, in which these reports are made."""
PROVENANCE = {"parents": ["ab" * 32], "operator": "neat", "seed": 0, "version": "0.1.0"}


def archive_file(spec: dict[str, Any]) -> bytes:
    """The file of an archive with one elite, in cell 17."""
    archive = {
        "genomes": {"bias": np.zeros((1, 2)), "weight": np.ones((1, 3))},
        "measures": np.array([[0.01, 1.0]]),
        "fitness": np.array([2.5]),
        "generation": np.array([3]),
        "creature": np.zeros((1, 32), np.uint8),
        "cell": np.array([17]),
    }
    measures = json.dumps(EFFORTS)
    attributes = {"format": file.FORMAT, "spec": json.dumps(spec), "measures": measures}
    return file.dump({"archive": archive}, attributes)


def audit(trusted: bool) -> bytes:
    """The file of an audit without rows."""
    reasons = [] if trusted else ["it pushes itself"]
    return json.dumps(
        {"verdict": {"trusted": trusted, "reasons": reasons}, "rows": []}
    ).encode()


def replay(positions: np.ndarray, planes: int = 1, **more: Any) -> bytes:
    """A replay with these positions, (frame, node, 2), and still fluid, 8 x 4 cells."""
    frames, nodes, _ = positions.shape
    header = {
        "format": "microcosmos-replay/2",
        "frames": frames,
        "every": 5,
        "steps": 5 * (frames - 1),
        "nodes": nodes,
        "edges": [[i, i + 1] for i in range(nodes - 1)],
        "size": [8, 4],
        "vorticity": {"scale": 1.0},
        **more,
    }
    text = json.dumps(header).encode()
    angles = len(more["joints"]) + nodes - 1 if "joints" in more else 0
    floats = positions.astype("<f4").tobytes() + np.zeros((frames, angles), "<f4").tobytes()
    fluid = np.zeros((frames, planes, *header["size"]), np.int8).tobytes()
    return struct.pack("<I", len(text)) + text + floats + fluid


def pose_stream(creature: str, frames: int = 64) -> bytes:
    """The pose stream of a body of three nodes that swims to the right over two strokes."""
    stroke = np.arange(1, frames + 1)[:, None] * 2 / frames
    node = np.arange(3)[None]
    swing = np.sin(2 * np.pi * (stroke - node / 3))
    places = np.stack([40 + node + 10 * stroke, 30 + swing], -1)
    positions, middles, scale = pose_streams.quantised(places)
    return pose_streams.PoseStream(
        positions=positions,
        path=places.mean(1)[::8],
        middles=middles,
        scale=scale,
        edges=np.array([[0, 1], [1, 2]]),
        start=40,
        stop=120,
        strokes=2,
        steps=120,
        size=(24, 24),
        length=2.0,
        creature=creature,
    ).encode()


def identity(number: int = 1) -> dict[str, Any]:
    """The identity of a swimmer whose one weight is a number."""
    demo = DEMO.model_dump(mode="json")
    genome = {
        "encoding": "cppn",
        "inputs": ["position", "sine", "cosine", "wave_sine", "wave_cosine"],
        "outputs": ["rest_angle", "rest_length"],
        "control": demo["control"],
        "nodes": {
            "id": list(range(7)),
            "activation": ["identity"] * 7,
            "bias": encode(np.zeros(7)),
        },
        "connections": {
            "innovation": [0],
            "source": [1],
            "target": [5],
            "enabled": [True],
            "weight": encode(np.array([number])),
        },
    }
    return {
        "format": "microcosmos-creature/1",
        "genome": genome,
        "world": {**demo["world"], "coupling": demo["coupling"]},
        "body": demo["body"],
        "task": demo["task"],
    }


def creature_of(number: int) -> dict[str, Any]:
    found = identity(number)
    return {"creature": creature.name(found), "identity": creature.canonical(found)}


def table(generation: int, *rows: dict[str, Any], summary: Any = None) -> Any:
    """The report of an experiment without an archive: rows of values."""
    nothing = dict.fromkeys(("creature", "identity", "measured", "provenance"))
    return SimpleNamespace(
        generation=generation,
        evaluations=generation,
        infeasible=0,
        elites=(),
        emptied=(),
        rows=tuple(
            SimpleNamespace(
                values=values,
                **nothing | (creature_of(values["number"]) if "number" in values else {}),
            )
            for values in rows
        ),
        summary=summary,
        **dict.fromkeys(("qd_score", "coverage", "best", "mean")),
    )


def report(
    generation: int,
    elites: dict[int, float] | None = None,
    descriptors: tuple[float, ...] = (0.25, 0.5),
    measures: dict[str, float] | None = None,
    summary: dict[str, Any] | None = None,
    poses: bool = False,
    emptied: tuple[int, ...] = (),
) -> Any:
    """The report of a generation: new elites by cell, with their fitness, or also poses."""
    efforts = {"bending_effort": 0.25, "stretching_effort": 0.5}

    def elite(cell: int, fitness: float) -> Any:
        named = creature_of(1000 * generation + cell)
        return SimpleNamespace(
            cell=cell,
            fitness=fitness,
            descriptors=descriptors,
            generation=generation,
            **named,
            poses=pose_stream(named["creature"]) if poses else None,
            measured={
                "fitness": fitness,
                "descriptors": efforts,
                "measures": {"displacement": fitness, **efforts, **(measures or {})},
                "block": 16,
                "room": [24, 64],
                "device": "a device",
            },
            provenance=PROVENANCE | {"generation": generation},
        )

    return SimpleNamespace(
        generation=generation,
        qd_score=10.0 * generation,
        coverage=generation / 256,
        best=float(generation),
        mean=0.5 * generation,
        evaluations=16 * generation,
        infeasible=generation,
        elites=tuple(elite(*item) for item in (elites or {}).items()),
        emptied=emptied,
        rows=(),
        summary=summary,
    )
