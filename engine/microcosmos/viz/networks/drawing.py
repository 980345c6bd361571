"""Networks as SVG pictures for light and dark schemes, and in Graphviz' language."""

import json
from html import escape
from itertools import pairwise

from ...networks.network import Link, Network
from .layout import Layout, layout

ACTIVATION = {
    "identity": "#dfe3e8",
    "sigmoid": "#b9d7f5",
    "tanh": "#9fe0da",
    "relu": "#f9d59b",
    "sin": "#d5c4f4",
    "cos": "#f3c3e4",
    "gaussian": "#c8e6a8",
    "abs": "#f6bfb4",
    "square": "#f2e59a",
}
"""Light colours, on which dark letters are readable in either scheme."""

OTHER, INPUT = "#cfd8dc", "#ffffff"
POSITIVE, NEGATIVE = "#3a86c8", "#d9643a"


def fill(network: Network, key: int) -> str:
    if key < network.inputs:
        return INPUT
    return ACTIVATION.get(activation(network, key), OTHER)


def activation(network: Network, key: int) -> str:
    """Return the activation of a node; a linear output has the output transform."""
    name = network.node[key].activation
    transform = network.output_transform
    return transform if key in network.outputs and transform and name == "identity" else name


def label(network: Network, key: int) -> str:
    if key < network.inputs:
        return network.names[key]
    name = activation(network, key)
    aggregation = network.node[key].aggregation
    return name if aggregation == "sum" else f"{aggregation} {name}"


def value_text(network: Network, key: int) -> str:
    """Return the description of a node, for a tooltip."""
    if key < network.inputs:
        return network.names[key]
    name = network.names.get(key, f"node {key}")
    return f"{name}: {label(network, key)}, bias {network.node[key].bias:.4g}"


def thickness(network: Network, weight: float, least: float, most: float) -> float:
    """Return the width of a connection, in proportion to its weight."""
    largest = max(abs(link.weight) for link in network.links)
    return least + (most - least) * (abs(weight) / largest if largest else 0.0)


def described(network: Network) -> str:
    """Return the network in one sentence."""
    kind = f"recurrent network ({network.steps} steps)" if network.steps else "network"
    inputs, outputs = _count(network.inputs, "input"), _count(len(network.outputs), "output")
    hidden = _count(len(network.hidden), "hidden node")
    return f"A {kind} with {inputs}, {outputs}, {hidden} and " + _count(
        len(network.links), "connection"
    )


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}" + ("" if number == 1 else "s")


LETTER = 7.2
"""Width of a letter, about."""

HEIGHT = 28.0
MARGIN = 20.0

STYLE = f"""
.network {{ font: 13px system-ui, sans-serif; }}
.network:root {{ color: #1b1f24; }}
@media (prefers-color-scheme: dark) {{ .network:root {{ color: #e8ebef; }} }}
.network .link {{ fill: none; stroke-linecap: round; opacity: 0.85; }}
.network .positive {{ stroke: {POSITIVE}; }}
.network .negative {{ stroke: {NEGATIVE}; }}
.network .zero {{ stroke: currentColor; stroke-dasharray: 1 5; }}
.network rect {{ stroke: #5c6670; }}
.network .node text {{ fill: #16191d; text-anchor: middle; }}
.network .name, .network .legend {{ fill: currentColor; }}
.network .legend {{ font-size: 11px; }}
"""


def svg(network: Network) -> str:
    """Draw layers from left to right, nodes coloured by activation, connections by weight.

    Inside a page, `currentColor` is the page's; alone, it follows the reader's scheme.
    """
    drawn = layout(network.keys, network.inputs, network.outputs, network.pairs)
    left, top, width, height = _frame(network, drawn)
    title = escape(described(network))
    # No thick link hides a thin one.
    thickest_first = sorted(network.links, key=lambda link: -abs(link.weight))
    box = f"{left:.1f} {top:.1f} {width:.1f} {height:.1f}"
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" class="network" role="img" '
            f'viewBox="{box}" width="{width:.0f}" height="{height:.0f}" aria-label="{title}">',
            f"<title>{title}</title>",
            f"<style>{STYLE}</style>",
            *(_link(network, link, drawn) for link in thickest_first),
            *(_node(network, key, drawn) for key in network.keys),
            *_legend(left + MARGIN, top + height - MARGIN),
            "</svg>",
            "",
        ]
    )


def _frame(network: Network, drawn: Layout) -> tuple[float, float, float, float]:
    points = [point for way in drawn.ways.values() for point in way]
    points += drawn.place.values()
    loops = any(len(way) > 1 and way[-1][0] <= way[0][0] for way in drawn.ways.values())
    names = [network.names[key] for key in network.outputs]
    left = min(x - _width(network, key) / 2 for key, (x, _) in drawn.place.items()) - MARGIN
    right = max(x + _width(network, key) / 2 for key, (x, _) in drawn.place.items())
    right = max(right + 12 + LETTER * max(map(len, names)) + MARGIN, left + 330)
    top = min(y for _, y in points) - HEIGHT / 2 - MARGIN - (40 if loops else 0)
    bottom = max(y for _, y in points) + HEIGHT / 2 + 2.4 * MARGIN
    return left, top, right - left, bottom - top


def _width(network: Network, key: int) -> float:
    return max(64.0, LETTER * len(label(network, key)) + 24)


def _link(network: Network, link: Link, drawn: Layout) -> str:
    pair, weight = (link.source, link.target), link.weight
    sign = "positive" if weight > 0 else "negative" if weight < 0 else "zero"
    ends = " → ".join(network.names.get(key, f"node {key}") for key in pair)
    return (
        f'<path class="link {sign}" d="{_path(network, pair, drawn)}" '
        f'stroke-width="{thickness(network, weight, 0.8, 5.0):.2f}">'
        f"<title>{escape(ends)}: weight {weight:.4g}</title></path>"
    )


def _path(network: Network, pair: tuple[int, int], drawn: Layout) -> str:
    way = list(drawn.ways[pair])
    source, target = pair
    way[0] = (way[0][0] + _width(network, source) / 2, way[0][1])
    way[-1] = (way[-1][0] - _width(network, target) / 2, way[-1][1])
    text = f"M{way[0][0]:.1f} {way[0][1]:.1f}"
    for (x, y), (end, level) in pairwise(way):
        if end <= x:  # Back over the nodes in between.
            text += f" C{x + 60:.1f} {y - 60:.1f} {end - 60:.1f} {level - 60:.1f}"
        else:
            bend = (end - x) / 2
            text += f" C{x + bend:.1f} {y:.1f} {end - bend:.1f} {level:.1f}"
        text += f" {end:.1f} {level:.1f}"
    return text


def _node(network: Network, key: int, drawn: Layout) -> str:
    x, y = drawn.place[key]
    width = _width(network, key)
    name = ""
    if key in network.outputs:
        at = f'x="{x + width / 2 + 10:.1f}" y="{y + 4.5:.1f}"'
        name = f'<text class="name" {at}>{escape(network.names[key])}</text>'
    return (
        f'<g class="node"><title>{escape(value_text(network, key))}</title>'
        f'<rect x="{x - width / 2:.1f}" y="{y - HEIGHT / 2:.1f}" width="{width:.1f}" '
        f'height="{HEIGHT:.1f}" rx="{HEIGHT / 2:.1f}" fill="{fill(network, key)}"/>'
        f'<text x="{x:.1f}" y="{y + 4.5:.1f}">{escape(label(network, key))}</text></g>{name}'
    )


def _legend(x: float, y: float) -> list[str]:
    entries = (("positive", 0.0, "positive weight"), ("negative", 135.0, "negative weight"))
    return [
        f'<path class="link {sign}" d="M{x + at:.1f} {y:.1f} h22" stroke-width="3"/>'
        f'<text class="legend" x="{x + at + 29:.1f}" y="{y + 4:.1f}">{words}</text>'
        for sign, at, words in entries
    ]


def dot(network: Network) -> str:
    """Write a directed graph from left to right, inputs in one rank and outputs in one."""
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
    # A string of Graphviz' language escapes quotes as JSON does.
    return json.dumps(words, ensure_ascii=False)
