"""The network of a creature in forms for other programs and for people."""

import json
from collections.abc import Callable
from typing import Any

from microcosmos.viz import networks
from microcosmos.viz.networks import Network

from ..core.errors import ProblemError
from ..tables import Creature


def network_of(row: Creature) -> Network:
    """The network of a creature; raises `ProblemError` where its genes are none."""
    identity = json.loads(row.identity)
    genome: dict[str, Any] = identity["genome"]
    if "nodes" not in genome:
        detail = (
            f"The creature has no network: its `genome.encoding` is {genome['encoding']!r}; "
            "needed are genes of nodes and connections."
        )
        raise ProblemError(404, "No network", detail)
    return networks.of_creature(identity)


def tensorneat(network: Network) -> bytes:
    """A genome of TensorNEAT."""
    return networks.dump_tensorneat(networks.write_tensorneat(network))


FORMS: dict[str, tuple[str, Callable[[Network], str | bytes]]] = {
    "svg": ("image/svg+xml", networks.svg),
    "dot": ("text/vnd.graphviz", networks.dot),
    "py": ("text/x-python", networks.numpy_code),
    "npz": ("application/octet-stream", tensorneat),
}
"""What a network is written as, by the ending of the file: media type and writer."""


def written(row: Creature, form: str) -> bytes:
    """The network in a form; raises `ProblemError` where it cannot be written so."""
    network = network_of(row)
    try:
        data = FORMS[form][1](network)
    except ValueError as error:
        detail = f"The network cannot be written as .{form}: {error}."
        raise ProblemError(422, "Not expressible", detail) from error
    return data.encode() if isinstance(data, str) else data
