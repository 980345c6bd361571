"""A player of one creature: its replay with the fluid, or the strokes of its pose stream."""

from collections.abc import Mapping
from importlib import import_module
from typing import Any, Protocol, runtime_checkable

from ..archive import poses
from ..optional import require
from ..viz.replay_file import read_replay
from .assets import script, styles

NOTEBOOK = "microcosmos[notebook]"
anywidget: Any = require("anywidget", NOTEBOOK)
traitlets: Any = require("traitlets", NOTEBOOK)


@runtime_checkable
class Recorded(Protocol):
    """A replay that was read from a server: `microcosmos.client.Replay`."""

    data: bytes


class Player(anywidget.AnyWidget):
    """One creature in motion. Nothing is asked of a server once it is shown.

    A replay plays with the vorticity of the fluid, and has a slider over its time. A pose
    stream repeats the last two strokes.
    """

    _esm = traitlets.Unicode().tag(sync=True)
    _css = traitlets.Unicode().tag(sync=True)
    _kind = traitlets.Unicode("player").tag(sync=True)
    _replay = traitlets.Bytes(b"").tag(sync=True)
    _poses = traitlets.Bytes(b"").tag(sync=True)
    _creature = traitlets.Unicode("").tag(sync=True)
    _about = traitlets.Unicode("").tag(sync=True)

    def __init__(self, source: Mapping[str, Any] | poses.PoseStream | bytes | Any):
        """Play a creature file, the bytes of a replay, a pose stream, or a replay of a server.

        A creature file is simulated, which loads JAX. Raise `ValueError` for other bytes.
        """
        super().__init__(**content(source), _esm=script(), _css=styles())

    def __repr__(self) -> str:
        return f"<Player: {self._about}>"


def content(source: Any) -> dict[str, Any]:
    """Return the fields of the player. Raise `ValueError` for what cannot be played."""
    if isinstance(source, poses.PoseStream):
        name, steps = source.creature, f"steps {source.start} to {source.stop}"
        return {
            "_poses": poses.batch([source.encode()]),
            "_creature": name,
            "_about": f"{name[:12]} · {steps}",
        }
    if isinstance(source, Mapping):
        source = import_module("microcosmos").record(source)  # Loads JAX.
    data = source.data if isinstance(source, Recorded) else source
    if not isinstance(data, bytes):
        raise ValueError(
            f"a creature file, a replay or a pose stream is needed, got {type(source).__name__}"
        )
    header = read_replay(data).header
    name = str(header.get("creature", ""))[:12]
    return {"_replay": data, "_about": f"{name} · {header['steps']} steps"}
