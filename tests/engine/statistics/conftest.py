"""Runs that tests of statistics make up."""

import json

import numpy as np
import pytest

from microcosmos.archive.file import FORMAT, dump
from microcosmos.spec import QualityDiversity
from microcosmos.spec.paths import replaced
from microcosmos.statistics import RunRecord

SPEC = QualityDiversity().model_dump(mode="json")
BATCH = 10


@pytest.fixture
def run():
    """A function that makes a run whose curves lead evenly to `score`."""

    def make(
        score=1.0,
        *,
        seed=0,
        name=None,
        state="finished",
        generations=4,
        batch=BATCH,
        version="0.1.0",
        corrected=None,
        curves=None,
        **fields,
    ):
        document = replaced({**SPEC, "seed": seed}, "search.batch", batch)
        for path, value in fields.items():
            document = replaced(document, path.replace("__", "."), value)
        along = np.arange(1, generations + 1) / generations
        made = {
            "evaluations": batch * np.arange(1.0, generations + 1),
            "qd_score": score * along,
            "coverage": along,
            "best": score * along**2,
            "corrected_qd_score": np.array(corrected or [np.nan] * generations, float),
        }
        name = name or f"{score:g}-seed{seed}.h5"
        return RunRecord(name, document, made | (curves or {}), version, ("cpu",), state)

    return make


@pytest.fixture
def group_of(run):
    """A function that gives the runs of a group by their scores, with seeds from 0."""

    def make(scores, **fields):
        return [run(score, seed=seed, **fields) for seed, score in enumerate(scores)]

    return make


@pytest.fixture
def saved(tmp_path):
    """A function that writes a made-up run as a search does, and returns the path."""

    def save(run, folder=""):
        path = tmp_path / folder / run.name
        path.parent.mkdir(exist_ok=True)
        attributes = {
            "format": FORMAT,
            "spec": json.dumps(run.document),
            "version": run.version,
            "device": json.dumps(run.devices),
            "ended": json.dumps({"reason": "generations"} if run.finished else None),
        }
        path.write_bytes(dump({"curves": run.curves, "archive": {}}, attributes))
        return path

    return save
