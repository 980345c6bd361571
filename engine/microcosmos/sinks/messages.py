"""Messages between a run and the process of a sink: a JSON header and bytes."""

import json
import struct
from typing import Any, BinaryIO, NamedTuple

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
