"""Replays and pictures for notebooks, which need no network and stay when saved."""

import json
import re
from base64 import b64encode
from functools import cached_property
from gzip import compress
from html import escape
from pathlib import Path
from typing import Any

from ..archive.atomic import write_whole
from ..viz import motion, replay_file
from ..widgets import assets

WIDTH = 480
CONTROLS = 96
"""Pixels below the picture."""


class Picture:
    """A PNG."""

    def __init__(self, data: bytes):
        self.data = data

    def _repr_png_(self) -> bytes:
        return self.data

    def __repr__(self) -> str:
        return f"<a picture of {len(self.data):,} bytes>"

    def save(self, path: str | Path) -> Path:
        write_whole(Path(path), self.data)
        return Path(path)


class Replay:
    """The recorded motion of a creature, and the vorticity of the fluid around it."""

    def __init__(self, data: bytes):
        self.data = data
        """The file, see docs/formats.md."""
        self.motion = replay_file.read_replay(data)
        """Its arrays: `positions`, `vorticity`, `drive`, `edges` …"""

    @property
    def header(self) -> dict[str, Any]:
        return self.motion.header

    def __repr__(self) -> str:
        width, height = self.motion.size
        steps = self.motion.step(self.motion.frames - 1)
        name = str(self.header.get("creature", ""))[:12]
        return f"<Replay of {name}: {steps} steps in {width} × {height} cells>"

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> dict[str, str]:
        return {"text/plain": repr(self), "text/html": self._repr_html_()}

    def _repr_html_(self) -> str:
        """Return an iframe with the page, apart from the notebook's scripts and styles."""
        width, height = self.motion.size
        shown = round(WIDTH * height / width) + CONTROLS
        return (
            f'<iframe title="Replay" sandbox="allow-scripts" width="{WIDTH}" height="{shown}" '
            f'style="border:0;max-width:100%" srcdoc="{escape(self.html)}"></iframe>'
        )

    @cached_property
    def html(self) -> str:
        """Return the whole page, which loads nothing.

        It is the page that the browser saves of a creature, with a recorded motion alone. Raise
        `FileNotFoundError` in a checkout where `make web` has not built it.
        """
        about = {"title": repr(self)[1:-1], "creature": None, "note": note(self.motion)}
        # Without the time in its header, the same motion is the same page.
        packed = b64encode(compress(motion.encode(self.motion), mtime=0)).decode()
        # A script must not contain its own end tag.
        texts = {"about": json.dumps(about).replace("<", "\\u003c"), "motion": packed}
        data = "".join(
            f'<script type="text/plain" id="{name}">{text}</script>'
            for name, text in texts.items()
        )
        head, body, end = re.split("<!--(?:title|data)-->", assets.page())
        return "".join((head, escape(about["title"]), body, data, end))

    def save(self, path: str | Path) -> Path:
        """Write `.html`, a page that plays by itself, or the replay file."""
        path = Path(path)
        write_whole(path, self.html.encode() if path.suffix.lower() == ".html" else self.data)
        return path


def note(recorded: replay_file.Replay) -> str:
    """Say what the page leaves out; empty where it has all."""
    kept, (width, height) = motion.header(recorded), recorded.size
    parts = []
    if (every := motion.stride(recorded)) > 1:
        parts.append(f"one frame in {every}")
    if kept["moments"] < kept["frames"]:
        parts.append(f"the fluid at {kept['moments']} moments")
    if (side := kept["square"]) > 1:
        parts.append(f"{width} × {height} cells in squares of {side} × {side}")
    if not parts:
        return ""
    return f"To stay small this shows {' and '.join(parts)}; save() has all."
