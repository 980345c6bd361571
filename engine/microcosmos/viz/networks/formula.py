"""A network as readable lines, one for each node."""

from .graph import order
from .network import Network


def formula(network: Network) -> str:
    """Write every node's value to four digits, sources before their targets."""
    names = {key: f"n{key}" for key in network.keys}
    names |= {key: name.replace(" ", "_") for key, name in network.names.items()}
    keys = network.keys if network.steps else order(network.keys, network.pairs)
    computed = [key for key in keys if key >= network.inputs]
    lines = [f"{names[key]} = {_value(network, key, names)}" for key in computed]
    if network.steps:
        lines.insert(0, f"{network.steps} times, all at once from the values before:")
    if network.output_transform not in (None, "identity"):
        outputs = ", ".join(names[key] for key in network.outputs)
        lines.append(f"at the end {network.output_transform} of {outputs}")
    return "\n".join(lines) + "\n"


def _value(network: Network, key: int, names: dict[int, str]) -> str:
    node = network.node[key]
    terms = [(link.weight, names[link.source]) for link in network.links if link.target == key]
    if not terms and network.rule == "live":
        return "no value"
    if node.aggregation != "sum" and len(terms) > 1:
        listed = ", ".join(_term(weight, name) for weight, name in terms)
        terms = [(node.response, f"{node.aggregation}({listed})")]
    else:
        terms = [(node.response * weight, name) for weight, name in terms]
    z = _sum(node.bias, terms)
    return z if node.activation == "identity" else f"{node.activation}({z})"


def _sum(bias: float, terms: list[tuple[float, str]]) -> str:
    parts = [(bias, _number(bias))] if bias or not terms else []
    parts += [(weight, _term(abs(weight), name)) for weight, name in terms]
    first = parts[0]
    text = first[1] if first[1].startswith("−") or first[0] >= 0 else f"−{first[1]}"
    for weight, part in parts[1:]:
        text += f" {'−' if weight < 0 else '+'} {part}"
    return text


def _term(weight: float, name: str) -> str:
    return name if weight == 1 else f"{_number(weight)}·{name}"


def _number(value: float) -> str:
    return f"{value:.4g}".replace("-", "−")
