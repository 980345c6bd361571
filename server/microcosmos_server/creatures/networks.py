"""Write the network of a creature in several forms, and the figures of its stroke."""

import json
from collections.abc import Callable
from dataclasses import asdict
from typing import Any

from pydantic import TypeAdapter

from microcosmos import networks
from microcosmos.networks import Network
from microcosmos.quantities.files import Stroke, stroke
from microcosmos.viz import networks as pictures

from ..core.errors import Invalid, NotFound


def positions(identity: dict[str, Any]) -> str:
    return json.dumps(asdict(pictures.positions(identity)))


def tensorneat(network: Network) -> bytes:
    return networks.dump_tensorneat(networks.write_tensorneat(network))


def of(write: Callable[[Network], str | bytes]) -> Callable[[dict[str, Any]], str | bytes]:
    """Return a writer of a creature's network."""
    return lambda identity: write(networks.of_creature(identity))


FORMS: dict[str, tuple[str, str, Callable[[dict[str, Any]], str | bytes]]] = {
    "json": ("application/json", "positions of its nodes", positions),
    "svg": ("image/svg+xml", "a picture", of(pictures.svg)),
    "dot": ("text/vnd.graphviz", "a graph for Graphviz", of(pictures.dot)),
    "py": ("text/x-python", "a Python module that needs NumPy alone", of(networks.numpy_code)),
    "npz": ("application/octet-stream", "a genome of TensorNEAT", of(tensorneat)),
}
"""Media type, description and writer of each form, by the ending of the file."""


def write(identity: bytes, form: str) -> bytes:
    """Return the network in a form. Call it only in the sandbox: it evaluates the network."""
    creature = json.loads(identity)
    encoding = creature["genome"]["encoding"]
    if "nodes" not in creature["genome"]:
        detail = (
            f"The creature has no network: its `genome.encoding` is {encoding!r}, "
            "which has no genes of nodes and connections."
        )
        raise NotFound(detail, title="No network")
    try:
        data = FORMS[form][2](creature)
    except ValueError as error:
        detail = f"The network cannot be written as .{form}: {error}."
        raise Invalid(detail, title="Not expressible") from error
    return data.encode() if isinstance(data, str) else data


STROKE = b"stroke"
"""The task of the sandbox beside the forms of a network."""
ANSWER = TypeAdapter(Stroke)


def write_stroke(file: bytes) -> bytes:
    """Return length, stroke and sperm number of a creature's identity and measures as JSON.

    It is null for a creature without a stroke. Call this only in the sandbox: it grows the
    body, and seeks the modes of its joints.
    """
    try:
        return ANSWER.dump_json(stroke(json.loads(file)))
    except ValueError:
        return b"null"
