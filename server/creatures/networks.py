"""Write a creature's network as SVG, Graphviz, Python or TensorNEAT."""

import json
from collections.abc import Callable
from typing import Any

from microcosmos.viz import networks
from microcosmos.viz.networks import Network

from ..core.errors import ProblemError


def network_of(identity: dict[str, Any]) -> Network:
    """Return the network of a creature; raise `ProblemError` if its genes have none."""
    genome: dict[str, Any] = identity["genome"]
    if "nodes" not in genome:
        detail = (
            f"The creature has no network: its `genome.encoding` is {genome['encoding']!r}, "
            "which has no genes of nodes and connections."
        )
        raise ProblemError(404, "No network", detail)
    return networks.of_creature(identity)


def tensorneat(network: Network) -> bytes:
    return networks.dump_tensorneat(networks.write_tensorneat(network))


FORMS: dict[str, tuple[str, str, Callable[[Network], str | bytes]]] = {
    "svg": ("image/svg+xml", "a picture", networks.svg),
    "dot": ("text/vnd.graphviz", "a graph for Graphviz", networks.dot),
    "py": ("text/x-python", "a Python module that needs NumPy alone", networks.numpy_code),
    "npz": ("application/octet-stream", "a genome of TensorNEAT", tensorneat),
}
"""Media type, description and writer of each form, by the ending of the file."""


def write(identity: bytes, form: str) -> bytes:
    """Return the network in a form. Call it only in the sandbox: it evaluates the network."""
    network = network_of(json.loads(identity))
    try:
        data = FORMS[form][2](network)
    except ValueError as error:
        detail = f"The network cannot be written as .{form}: {error}."
        raise ProblemError(422, "Not expressible", detail) from error
    return data.encode() if isinstance(data, str) else data
