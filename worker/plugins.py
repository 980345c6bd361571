"""What this worker has of users' own: asked in a process of its own, then loaded where needed.

A module may do anything when it is imported: load JAX, which a supervisor does without, or end
the process. `python -m worker.plugins` tells what there is, as JSON.
"""

import json
import logging
import os
import subprocess
import sys
import threading
from collections.abc import Sequence
from contextlib import redirect_stdout, suppress
from dataclasses import dataclass
from hashlib import sha256
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any

from microcosmos import plugins
from microcosmos.plugins.loading import GROUP
from server.settings import Settings

SECONDS = 120.0
"""How long modules may take to be imported."""

log = logging.getLogger(__name__)


def files(settings: Settings) -> list[Path]:
    """The modules that the environment names."""
    return [Path(part) for part in settings.modules.split(os.pathsep) if part]


def load(settings: Settings) -> Sequence[plugins.Unloaded]:
    """Load all there is; what cannot be loaded is told and left out."""
    failed = plugins.load_all(files(settings))
    for one in failed:
        log.warning("%s is not loaded: %s", one.module, one.reason)
    return failed


@dataclass(frozen=True)
class Told:
    """What a worker reports."""

    plugins: tuple[dict[str, Any], ...] = ()
    unloaded: tuple[dict[str, Any], ...] = ()

    @property
    def plugin_versions(self) -> set[str]:
        return {one["source"] for one in self.plugins}


def ask(settings: Settings) -> Told:
    """What there is, found out at a safe distance and without touching a GPU."""
    named = [str(file) for file in files(settings)]
    if not named and not entry_points(group=GROUP):
        return Told()
    try:
        answer = subprocess.run(
            [sys.executable, "-m", "worker.plugins"],
            env=os.environ | {"JAX_PLATFORMS": "cpu"},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            timeout=SECONDS,
            check=True,
        )
        return Told(**json.loads(answer.stdout.splitlines()[-1]))
    except subprocess.TimeoutExpired:
        reason = f"it was not imported within {SECONDS:g} s"
    except (subprocess.CalledProcessError, ValueError, IndexError) as error:
        reason = f"the process that imported it ended badly ({error})"
    log.warning("No modules of users' own: %s", reason)
    return Told(unloaded=tuple({"module": one, "reason": reason} for one in named))


class Shelf(threading.Thread):
    """What there is, asked again when a file changes, in a thread of its own."""

    def __init__(self, settings: Settings, interval: float):
        super().__init__(name="shelf", daemon=True)
        self._settings, self._interval = settings, interval
        self._ended = threading.Event()
        self._seen = self._look()
        self.last = ask(settings)

    def run(self) -> None:
        while files(self._settings) and not self._ended.wait(self._interval):
            if (now := self._look()) != self._seen:
                self._seen, self.last = now, ask(self._settings)

    def end(self) -> None:
        self._ended.set()

    def _look(self) -> tuple[str | None, ...]:
        return tuple(map(_digest, files(self._settings)))


def _digest(file: Path) -> str | None:
    with suppress(OSError):
        return sha256(file.read_bytes()).hexdigest()
    return None


def main() -> None:
    """Say it in the last line, whatever modules print."""
    with redirect_stdout(sys.stderr):
        failed = load(Settings())
    told = {
        "plugins": [one.declaration.model_dump(mode="json") for one in plugins.loaded()],
        "unloaded": [vars(one) for one in failed],
    }
    print(f"\n{json.dumps(told)}")


if __name__ == "__main__":
    main()
