"""Addresses of sinks, records of runs in them, and messages to their processes."""

import hashlib
import json
import re
import struct
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

from ..archive.file_names import stem

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
    # Addresses stand in logs and records (test_passwords_do_not_stand_in_addresses).
    if re.search(r"//[^/]*@", target):
        raise ValueError(
            "a sink must have no user and password in its address: MLflow reads them from "
            "MLFLOW_TRACKING_USERNAME and MLFLOW_TRACKING_PASSWORD, W&B from WANDB_API_KEY"
        )
    return Address(kind, target)


def parse_all(texts: Sequence[str]) -> tuple[Address, ...]:
    """Return addresses, each once."""
    return tuple(dict.fromkeys(parse(text) for text in texts if text.strip()))


@dataclass(frozen=True)
class Record:
    """The identity and the spec of a run in a sink."""

    id: str
    """Equal for all attempts at one run; letters, digits, `-`, `_` and `.`."""
    name: str
    spec: dict[str, Any]
    generation: int = 0
    """The generation from which this attempt goes on."""

    def header(self) -> dict[str, Any]:
        return asdict(self)


def of_file(path: Path, spec: Mapping[str, Any], generation: int) -> Record:
    """Return the record of a run that `evolve` carries out into a file.

    The same path and spec, whatever the number of generations, give the same `id`.
    """
    kept: dict[str, Any] = json.loads(json.dumps(spec))
    kept.get("search", {}).pop("generations", None)
    text = json.dumps([str(path.resolve()), kept], sort_keys=True)
    name = stem(path)
    short = re.sub(r"[^A-Za-z0-9_.-]", "-", name)[:40]
    digest = hashlib.sha256(text.encode()).hexdigest()[:8]
    return Record(f"{short}-{digest}", name, dict(spec), generation)


class Refused(Exception):
    """A sink has taken all values but some: the reasons by their names."""

    def __init__(self, reasons: Mapping[str, str]):
        self.reasons = dict(reasons)
        super().__init__(self.reasons)


LENGTHS = struct.Struct("<IQ")
"""Bytes of the header, and of what follows it."""


class Message(NamedTuple):
    """`kind` is `report`, `archive`, `file` or `end`."""

    header: dict[str, Any]
    data: bytes = b""

    @property
    def kind(self) -> str:
        return self.header["kind"]


def send(stream: BinaryIO, message: Message) -> None:
    """Write a message; it may block. Raises `OSError` if nobody reads."""
    text = json.dumps(message.header).encode()
    stream.write(LENGTHS.pack(len(text), len(message.data)) + text)
    stream.write(message.data)
    stream.flush()


def receive(stream: BinaryIO) -> Message | None:
    """Return the next message; None at the end of the stream, also within a message."""
    head = stream.read(LENGTHS.size)
    if len(head) < LENGTHS.size:
        return None
    header, data = LENGTHS.unpack(head)
    text, content = stream.read(header), stream.read(data)
    if len(text) < header or len(content) < data:
        return None
    return Message(json.loads(text), content)
