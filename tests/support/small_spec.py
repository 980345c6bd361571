"""The experiment and the scene of a search that runs in seconds, and a whole small search."""

from typing import Any

SMALL_SCENE: dict[str, Any] = {
    "experiment": "quality-diversity",
    "world": {"width": 32, "height": 32},
    "body": {"nodes": 12},
    "control": {"period": 30},
    "task": {"steps": 60, "fitness": "displacement"},
}

SMALL_RUN: dict[str, Any] = {
    "experiment": "quality-diversity",
    "world": {"width": 24, "height": 24},
    "body": {"nodes": 8},
    "control": {"period": 40},
    "task": {"steps": 100},
    "search": {"generations": 4, "batch": 8},
}
