"""Plug-ins of a worker: list them in a separate process, and load them in jobs.

Importing a module may load JAX, which the supervisor must not, or end the process.
`python -m microcosmos_worker.plugins` prints the list as JSON.
"""

import json
import logging
import os
import sys
import threading
import time
from collections.abc import Sequence
from contextlib import redirect_stdout, suppress
from dataclasses import dataclass
from hashlib import sha256
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any

from microcosmos import plugins
from microcosmos.plugins.loading import GROUP
from microcosmos_server.core import processes
from microcosmos_server.settings import Settings

IMPORT_SECONDS = 120.0
AGAIN_SECONDS = 60.0
"""Time after which plug-ins are listed again if the process that imports them failed."""

log = logging.getLogger(__name__)


def files(settings: Settings) -> list[Path]:
    return [Path(part) for part in settings.modules.split(os.pathsep) if part]


def load(settings: Settings) -> Sequence[plugins.FailedModule]:
    """Load all plug-ins; log and return those that fail."""
    failed = plugins.load_all(files(settings))
    for one in failed:
        log.warning("%s is not loaded: %s", one.module, one.reason)
    return failed


@dataclass(frozen=True)
class PluginReport:
    """Declarations of the loaded plug-ins, and modules that failed with their reasons."""

    plugins: tuple[dict[str, Any], ...] = ()
    unloaded: tuple[dict[str, Any], ...] = ()
    is_complete: bool = True
    """False if the process that imports them failed."""

    @property
    def plugin_versions(self) -> set[str]:
        return {one["source"] for one in self.plugins}


def list_plugins(settings: Settings) -> PluginReport:
    """Load all plug-ins in another process, which does not touch a GPU."""
    named = [str(file) for file in files(settings)]
    if not named and not entry_points(group=GROUP):
        return PluginReport()
    command = processes.python("microcosmos_worker.plugins")
    environment = os.environ | {"JAX_PLATFORMS": "cpu"}
    try:
        # Its errors go to the worker's log.
        done = processes.run(command, environment, stderr=None, seconds=IMPORT_SECONDS)
        if done.code == 0:
            return PluginReport(**json.loads(done.output.splitlines()[-1]))
        reason = f"the process that imported it {processes.exit_reason(done.code)}"
    except processes.TooLateError:
        reason = f"it was not imported within {IMPORT_SECONDS:g} s"
    except (ValueError, IndexError) as error:
        reason = f"the process that imported it printed no list ({error})"
    log.warning("No plug-ins: %s", reason)
    unloaded = tuple({"module": one, "reason": reason} for one in named)
    return PluginReport(unloaded=unloaded, is_complete=False)


class PluginWatcher(threading.Thread):
    """Keeps a `report` of the plug-ins, renewed when a file changes."""

    def __init__(self, settings: Settings, interval: float):
        super().__init__(name="plug-ins", daemon=True)
        self._settings, self._interval = settings, interval
        self._due = threading.Event()
        self._ended = False
        self._digests = digests(settings)
        self.report = list_plugins(settings)
        self._listed_at = time.monotonic()
        self.reported: PluginReport | None = None
        """The report that the database has."""

    def run(self) -> None:
        while files(self._settings):
            self._due.wait(self._interval)
            self._due.clear()
            if self._ended:
                return
            try:
                self._renew()
            except Exception:  # Without this thread the worker would take no run any more.
                log.exception("Plug-ins are not listed")

    def _renew(self) -> None:
        now = digests(self._settings)
        failed = (
            not self.report.is_complete and time.monotonic() > self._listed_at + AGAIN_SECONDS
        )
        if now != self._digests or failed:
            self.report = list_plugins(self._settings)
            self._digests, self._listed_at = now, time.monotonic()

    def is_current(self) -> bool:
        """Return whether the database has the plug-ins of the files as they are now.

        If a file has changed, the report is renewed at once.
        """
        if digests(self._settings) != self._digests:
            self._due.set()
            return False
        return self.reported is self.report

    def end(self) -> None:
        self._ended = True
        self._due.set()


def digests(settings: Settings) -> tuple[str | None, ...]:
    """Return the SHA-256 of each module's file; None for one that cannot be read."""
    return tuple(map(_digest, files(settings)))


def _digest(file: Path) -> str | None:
    with suppress(OSError):
        return sha256(file.read_bytes()).hexdigest()
    return None


def have_changed(settings: Settings, listed: Sequence[dict[str, Any]]) -> bool:
    """Return whether a module's file has changed since its worker listed its plug-ins."""
    stems = {file.stem for file in files(settings)}
    present = set(digests(settings))
    return any(
        one["name"].partition(".")[0] in stems and one["source"] not in present
        for one in listed
    )


def main() -> None:
    """Print the list in the last line, whatever modules print."""
    processes.end_with_parent()
    with redirect_stdout(sys.stderr):
        failed = load(Settings())
    found = {
        "plugins": [one.declaration.model_dump(mode="json") for one in plugins.loaded()],
        "unloaded": [vars(one) for one in failed],
    }
    print(f"\n{json.dumps(found)}")


if __name__ == "__main__":
    main()
