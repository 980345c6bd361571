"""The sink Weights & Biases, online or (WANDB_MODE=offline) into a folder."""

import json
import os
import re
from collections.abc import Iterator, Sequence
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory

from ..archive.atomic import write_whole
from ..optional import require
from .address import Record
from .process import Report

EXTRA = "microcosmos[wandb]"


NOTE = "microcosmos.json"
"""The last step of an attempt that has ended, in its folder."""


class WeightsAndBiases:
    """One run of W&B, whose steps are generations; those that it has are not written again.

    W&B refuses a step before its last one. Offline each attempt has a folder of its own with
    the same id, and W&B does not know the earlier ones: a note in each has its last step.
    """

    def __init__(self, target: str, record: Record):
        library = require("wandb", EXTRA)
        entity, _, project = target.rpartition("/")
        self._run = library.init(
            project=project,
            entity=entity or None,
            id=wandb_id(record.id),
            name=record.name,
            config=record.spec,
            dir=os.environ.get("WANDB_DIR", "."),
            resume="allow",
            settings=library.Settings(silent=True, console="off", x_disable_stats=True),
        )
        self._library, self._target = library, target
        self._folder = Path(self._run.dir).parent
        self._closing = False
        online = self._run.step - 1 if self._run.resumed else -1
        # Online W&B itself knows what has arrived.
        self._last = max(online, *(self._noted() if self._run.offline else ()), -1)

    def _noted(self) -> Iterator[int]:
        """Yield the last steps that ended attempts have in this project."""
        for file in self._folder.parent.glob(f"*run-*/run-{self._run.id}.wandb"):
            note = file.with_name(NOTE)
            if note.exists():
                found = json.loads(note.read_bytes())
                if found["project"] == self._target:
                    yield found["step"]

    def reports(self, reports: Sequence[Report]) -> None:
        for step, values in reports:
            if step > self._last:
                self._run.log(values, step=step)
                self._last = step

    def picture(self, step: int, png: bytes) -> None:
        pillow = require("PIL.Image", EXTRA)
        image = self._library.Image(pillow.open(BytesIO(png)), caption=f"generation {step}")
        self._run.log({"archive": image}, step=max(self._last, step))

    def file(self, name: str, data: bytes) -> None:
        made = self._library.Artifact(f"{self._run.id}-{wandb_id(name)}", type="microcosmos")
        with TemporaryDirectory() as folder:
            path = Path(folder, name)
            path.write_bytes(data)
            made.add_file(str(path))
            self._run.log_artifact(made)

    def close(self, done: bool) -> None:
        interrupted, self._closing = self._closing, True
        self._run.finish(exit_code=0 if done else 255)
        if interrupted:  # W&B takes the run for finished: nobody knows what has arrived.
            return
        # W&B writes in blocks: before this, a kill loses steps that were logged.
        note = {"project": self._target, "step": self._last}
        write_whole(self._folder / NOTE, json.dumps(note).encode())


def wandb_id(text: str) -> str:
    """Return a name that W&B takes."""
    return re.sub(r"[^A-Za-z0-9_-]", "-", text)[:64]
