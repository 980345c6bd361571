"""Addresses of sinks: `tensorboard:FOLDER`, `mlflow:URI`, `wandb:PROJECT`."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

KINDS = {
    "tensorboard": "a folder, as tensorboard:runs",
    "mlflow": "a tracking address, as mlflow:http://127.0.0.1:5000 or mlflow:sqlite:///mlflow.db",
    "wandb": "a project, as wandb:swimmers or wandb:team/swimmers",
}


@dataclass(frozen=True)
class Address:
    """The kind of a sink, and where it keeps its records."""

    kind: str
    target: str

    def __str__(self) -> str:
        return f"{self.kind}:{self.target}"


def parse(text: str) -> Address:
    """Return an address. Raises `ValueError` for another kind, or a password in it."""
    kind, separator, target = text.strip().partition(":")
    if kind not in KINDS or not separator or not target:
        needed = "; ".join(f"{name} needs {what}" for name, what in KINDS.items())
        raise ValueError(
            f"a sink must be tensorboard:…, mlflow:… or wandb:… ({needed}); got "
            f"{text.partition('//')[0]!r}"
        )
    if re.search(r"//[^/]*@", target):
        raise ValueError(
            "a sink must have no user and password in its address: MLflow reads them from "
            "MLFLOW_TRACKING_USERNAME and MLFLOW_TRACKING_PASSWORD, W&B from WANDB_API_KEY"
        )
    return Address(kind, target)


def parse_all(texts: Sequence[str]) -> tuple[Address, ...]:
    """Return addresses, each once."""
    return tuple(dict.fromkeys(parse(text) for text in texts if text.strip()))
