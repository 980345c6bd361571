"""The sink TensorBoard: event files in a folder of the run."""

import json
import os
from collections.abc import Sequence
from pathlib import Path

from ..archive.atomic import write_whole
from ..optional import require
from .address import Record
from .process import Report

EXTRA = "microcosmos[tensorboard]"


class TensorBoard:
    """Events of one attempt; they take the place of those of earlier attempts at its steps.

    The first event is a restart at the first step of the attempt: TensorBoard forgets what
    earlier files have from there on.
    """

    def __init__(self, target: str, record: Record):
        library = require("tensorboardX", EXTRA)
        self._folder = Path(target, record.id)
        first = record.generation + 1 if record.generation else 0
        self._writer = library.SummaryWriter(
            str(self._folder), purge_step=first, flush_secs=5, filename_suffix=f".{os.getpid()}"
        )
        text = json.dumps(record.spec, indent=1)
        self._writer.add_text("spec", f"```json\n{text}\n```", record.generation)

    def reports(self, reports: Sequence[Report]) -> None:
        for step, values in reports:
            for name, value in values.items():
                self._writer.add_scalar(name, value, step)
        self._writer.flush()

    def picture(self, step: int, png: bytes) -> None:
        proto = require("tensorboardX.proto.summary_pb2", EXTRA).Summary
        image = proto.Image(encoded_image_string=png, colorspace=4)
        summary = proto(value=[proto.Value(tag="archive", image=image)])
        self._writer.file_writer.add_summary(summary, step)
        self._writer.flush()

    def file(self, name: str, data: bytes) -> None:
        write_whole(self._folder / name, data)

    def close(self, done: bool) -> None:
        self._writer.close()
