"""Declarations of the plug-ins of an invented module, `mine`."""

from typing import Any

from microcosmos.plugins import Axis, Declaration, Emits

A, B = "a" * 64, "b" * 64


STRICT = {
    "type": "object",
    "additionalProperties": False,
    "properties": {
        "strictness": {"type": "number", "minimum": 0, "maximum": 10, "default": 1.0}
    },
}


def declared(source: str = A) -> list[dict[str, Any]]:
    """The declarations of a version of `mine`."""
    axis = Axis(low=0.001, high=1.0, scale="log10")
    strict = {"settings": STRICT, "defaults": {"strictness": 1.0}}
    found = (
        Declaration(
            kind="fitness", name="mine.straight", source=source, title="Straight way",
            unit="cells", about="How far.", **strict,
        ),
        Declaration(
            kind="descriptor", name="mine.sway", source=source, title="Sway", unit="cells",
            axis=axis,
        ),
        Declaration(
            kind="body", name="mine.cross", source=source, title="A cross",
            sizes={"nodes": 40}, **strict,
        ),
        Declaration(
            kind="gait", name="mine.wiggler", source=source, title="A wiggler",
            sizes={"nodes": 20},
        ),
        Declaration(
            kind="encoding", name="mine.pulse", source=source, title="A pulse",
            sizes={"genes": 2, "per_joint": 1, "per_edge": 0},
        ),
        Declaration(
            kind="emitter", name="mine.creep", source=source, title="Creeping", **strict,
            emits=Emits(varies=("numbers",), learns="offspring"),
        ),
    )  # fmt: skip
    return [one.model_dump(mode="json") for one in found]
