"""The experiment and the scene of a search that runs in seconds."""

from typing import Any

SMALL_SCENE: dict[str, Any] = {
    "experiment": "quality-diversity",
    "world": {"width": 32, "height": 32},
    "body": {"nodes": 12},
    "control": {"period": 30},
    "task": {"steps": 60, "fitness": "displacement"},
}
