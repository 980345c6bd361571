"""The sink Weights & Biases, online or (WANDB_MODE=offline) into a folder."""

import os
import re
from collections.abc import Sequence
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory

from ..archive.atomic import write_whole
from ..optional import require
from .process import Report
from .record import Record

EXTRA = "microcosmos[wandb]"


class WeightsAndBiases:
    """One run of W&B, whose steps are generations; those that it has are not written again.

    W&B refuses a step before its last one. Offline each attempt has a folder of its own with
    the same id, and W&B does not know the earlier ones: a note beside them has the last step.
    """

    def __init__(self, target: str, record: Record):
        library = require("wandb", EXTRA)
        entity, _, project = target.rpartition("/")
        name, folder = wandb_id(record.id), Path(os.environ.get("WANDB_DIR", "."))
        self._note = folder / "wandb" / f"microcosmos-{name}.step"
        recorded = int(self._note.read_text()) if self._note.exists() else -1
        self._run = library.init(
            project=project,
            entity=entity or None,
            id=name,
            name=record.name,
            config=record.spec,
            dir=str(folder),
            resume="allow",
            settings=library.Settings(silent=True, console="off", x_disable_stats=True),
        )
        online = self._run.step - 1 if self._run.resumed else -1
        self._library, self._last = library, max(recorded, online)

    def reports(self, reports: Sequence[Report]) -> None:
        before = self._last
        for step, values in reports:
            if step > self._last:
                self._run.log(values, step=step)  # It is written when the next step comes.
                before, self._last = self._last, step
        self._write_note(before)

    def _write_note(self, step: int) -> None:
        write_whole(self._note, str(step).encode())

    def picture(self, step: int, png: bytes) -> None:
        pillow = require("PIL.Image", EXTRA)
        image = self._library.Image(pillow.open(BytesIO(png)), caption=f"generation {step}")
        self._run.log({"archive": image}, step=max(self._last, 0))

    def file(self, name: str, data: bytes) -> None:
        made = self._library.Artifact(f"{self._run.id}-{wandb_id(name)}", type="microcosmos")
        with TemporaryDirectory() as folder:
            path = Path(folder, name)
            path.write_bytes(data)
            made.add_file(str(path))
            self._run.log_artifact(made)

    def close(self, done: bool) -> None:
        self._run.finish(exit_code=0 if done else 255)
        self._write_note(self._last)


def wandb_id(text: str) -> str:
    """Return a name that W&B takes."""
    return re.sub(r"[^A-Za-z0-9_-]", "-", text)[:64]
