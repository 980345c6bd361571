"""Networks in Graphviz' language."""

import json

from .colours import NEGATIVE, POSITIVE, described, fill, label, thickness
from .network import Network


def dot(network: Network) -> str:
    """A directed graph from left to right, the inputs in one rank and the outputs in one."""
    lines = [
        "digraph network {",
        f"  label={_quoted(described(network))};",
        "  rankdir=LR; bgcolor=transparent;",
        '  node [shape=box, style="rounded,filled", fontname="sans-serif"];',
    ]
    for key in network.keys:
        words = label(network, key)
        if key in network.outputs:
            words = f"{network.names[key]}\n{words}"
        lines.append(
            f"  {key} [label={_quoted(words)}, fillcolor={_quoted(fill(network, key))}];"
        )
    for rank, keys in (("min", range(network.inputs)), ("max", network.outputs)):
        lines.append(f"  {{rank={rank}; {' '.join(f'{key};' for key in keys)}}}")
    for link in network.links:
        lines.append(
            f"  {link.source} -> {link.target} "
            f"[penwidth={thickness(network, link.weight, 0.5, 4.0):.2f}, "
            f"color={_quoted(POSITIVE if link.weight >= 0 else NEGATIVE)}, "
            f"tooltip={_quoted(f'{link.weight:.4g}')}];"
        )
    return "\n".join([*lines, "}", ""])


def _quoted(words: str) -> str:
    return json.dumps(words, ensure_ascii=False)
