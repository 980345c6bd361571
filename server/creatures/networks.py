"""Write a creature's network as positions of its nodes, SVG, Graphviz, Python or TensorNEAT."""

import json
from collections.abc import Callable
from dataclasses import asdict
from typing import Any

from microcosmos.viz import networks
from microcosmos.viz.networks import Network

from ..core.errors import ProblemError


def positions(identity: dict[str, Any]) -> str:
    return json.dumps(asdict(networks.positions(identity)))


def tensorneat(network: Network) -> bytes:
    return networks.dump_tensorneat(networks.write_tensorneat(network))


def of(write: Callable[[Network], str | bytes]) -> Callable[[dict[str, Any]], str | bytes]:
    """Return a writer of a creature's network."""
    return lambda identity: write(networks.of_creature(identity))


FORMS: dict[str, tuple[str, str, Callable[[dict[str, Any]], str | bytes]]] = {
    "json": ("application/json", "positions of its nodes", positions),
    "svg": ("image/svg+xml", "a picture", of(networks.svg)),
    "dot": ("text/vnd.graphviz", "a graph for Graphviz", of(networks.dot)),
    "py": ("text/x-python", "a Python module that needs NumPy alone", of(networks.numpy_code)),
    "npz": ("application/octet-stream", "a genome of TensorNEAT", of(tensorneat)),
}
"""Media type, description and writer of each form, by the ending of the file."""


def write(identity: bytes, form: str) -> bytes:
    """Return the network in a form. Call it only in the sandbox: it evaluates the network."""
    creature = json.loads(identity)
    encoding = creature["genome"]["encoding"]
    if "nodes" not in creature["genome"] and (form, encoding) != ("json", "weights"):
        detail = (
            f"The creature has no network: its `genome.encoding` is {encoding!r}, "
            "which has no genes of nodes and connections."
        )
        raise ProblemError(404, "No network", detail)
    try:
        data = FORMS[form][2](creature)
    except ValueError as error:
        detail = f"The network cannot be written as .{form}: {error}."
        raise ProblemError(422, "Not expressible", detail) from error
    return data.encode() if isinstance(data, str) else data
