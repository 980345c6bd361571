"""Replays and pictures for notebooks, which need no network and stay when saved."""

import json
from base64 import b64encode
from functools import cached_property
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

from ..archive.atomic import write_whole
from ..viz import replay_file

PLAYER = Path(__file__).with_name("player.html")
LIMIT = 1_200_000
"""Largest number of embedded bytes: notebooks are mailed and kept in version control."""
FLUID = 96
"""Largest number of cells of the fluid along its longer side."""
WIDTH = 480
CONTROLS = 76
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
        """An iframe keeps it apart from the notebook's scripts and styles."""
        width, height = self.motion.size
        shown = round(WIDTH * height / width) + CONTROLS
        return (
            f'<iframe title="Replay" sandbox="allow-scripts" width="{WIDTH}" height="{shown}" '
            f'style="border:0;max-width:100%" srcdoc="{escape(self.html)}"></iframe>'
        )

    @cached_property
    def html(self) -> str:
        """Return the whole page; it loads nothing."""
        frames, cells = thinning(self.motion)
        page = PLAYER.read_text("utf-8")
        positions = self.motion.positions[::frames].astype("<f4")
        levels = coarse(self.motion.levels[::frames], cells)
        header = {
            "frames": len(positions),
            "nodes": positions.shape[1],
            "every": self.header["every"] * frames,
            "edges": self.header["edges"],
            "size": self.header["size"],
            "grid": levels.shape[1:],
            "strongest": self.motion.strongest / self.motion.quantum,
            "note": note(self.motion, frames, levels.shape[1:]),
        }
        # A script must not contain its own end tag.
        page = page.replace("@HEADER@", json.dumps(header).replace("<", "\\u003c"))
        page = page.replace("@POSITIONS@", b64encode(positions.tobytes()).decode())
        return page.replace("@LEVELS@", b64encode(levels.tobytes()).decode())

    def save(self, path: str | Path) -> Path:
        """Write `.html`, a page that plays by itself, or the replay file."""
        path = Path(path)
        write_whole(path, self.html.encode() if path.suffix == ".html" else self.data)
        return path


def thinning(motion: replay_file.Replay) -> tuple[int, int]:
    """Return strides of frames and of cells that keep the page small."""
    width, height = motion.size
    cells = -(-max(width, height) // FLUID)
    frame = 8 * motion.positions.shape[1] + (width // cells) * (height // cells)
    most = max(2, LIMIT // frame)
    return -(-motion.frames // most), cells


def coarse(levels: np.ndarray, cells: int) -> np.ndarray:
    """Return (frame, x, y) means over squares of `cells` × `cells`."""
    if cells == 1:
        return levels
    frames, width, height = levels.shape
    whole = levels[:, : width // cells * cells, : height // cells * cells]
    squares = whole.reshape(frames, width // cells, cells, height // cells, cells)
    return np.rint(squares.mean((2, 4), dtype=np.float32)).astype(np.int8)


def note(motion: replay_file.Replay, frames: int, grid: tuple[int, ...]) -> str:
    """Say what was left out."""
    parts = []
    if frames > 1:
        parts.append(f"one frame in {frames}")
    if grid != motion.size:
        width, height = motion.size
        parts.append(f"the fluid in {grid[0]} × {grid[1]} squares of {width} × {height} cells")
    if not parts:
        return ""
    return f"To stay small this shows {' and '.join(parts)}; save() has all."
