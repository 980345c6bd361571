"""Networks as text: a Python module that needs NumPy alone, and readable lines."""

import inspect
import re
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from math import isfinite
from textwrap import TextWrapper

import numpy as np

from .functions import ACTIVATIONS, AGGREGATIONS, WITHIN_ONE
from .network import Network, agree, evaluate, order, probes, reached

TOLERANCE = 1e-12
CHECKED_STEPS = 4
"""Steps of a recurrent network in the check; more steps would prove nothing further."""


def messages(*values):
    values = np.stack(values)
    return values, ~np.isnan(values)


def kept(old, new, *sources):
    return np.where(np.any(~np.isnan(np.stack(sources)), 0), new, old)


def numpy_code(network: Network) -> str:
    """Return the text of a module with a function `network(inputs)`, (input, …) to (output, …).

    Raises `ValueError` if it differs from the network on random inputs over a few steps.
    """
    few = replace(network, steps=network.steps and min(network.steps, CHECKED_STEPS))
    require_same(few, _module(few))
    return _module(network)


def _module(network: Network) -> str:
    body = _recurrent(network) if network.steps else _feed_forward(network)
    function = _function(network, body)
    return "\n".join([_head(network, "\n".join(function)), *function, ""])


def require_same(network: Network, text: str) -> None:
    """Run the code on random inputs; raise `ValueError` if a value differs by 1e-12."""
    space: dict[str, Callable] = {}
    # Our own text: names of inputs and outputs are cut to letters
    # (test_names_cannot_end_the_text_they_stand_in).
    exec(compile(text, "<network>", "exec"), space)
    inputs = probes(network.inputs)
    with np.errstate(all="ignore"):
        values = space["network"](inputs)
    if not agree(evaluate(network, inputs), values, TOLERANCE):
        raise ValueError(
            f"standalone code must compute the same within {TOLERANCE:g}, got other values: "
            "the network's own overflow"
        )


@cache
def _sources() -> dict[str, str]:
    """Return the texts of our functions, read once: a sandbox cannot open files later."""
    functions = (*ACTIVATIONS.values(), *AGGREGATIONS.values(), messages, kept)
    ours = [one for one in functions if not isinstance(one, np.ufunc)]
    return {one.__name__: inspect.getsource(one) for one in ours}


def _head(network: Network, body: str) -> str:
    sources = _sources()
    used = [name for name in sources if re.search(rf"\b{name}\(", body)]
    # The text of `mean` calls `total`.
    if "mean" in used and "total" not in used:
        used.insert(0, "total")
    lines = [
        f'"""A network of {network.inputs} inputs, {len(network.outputs)} outputs and '
        f"{len(network.hidden)} hidden nodes, written by Microcosmos.",
        "",
        f"Inputs: {_listed(network, range(network.inputs))}.",
        f"Outputs: {_listed(network, network.outputs)}.",
        '"""',
        "",
        *(["from functools import reduce", ""] if {"total", "product"} & set(used) else []),
        "import numpy as np",
        "",
    ]
    for name in used:
        lines += ["", *sources[name].splitlines(), ""]
    return "\n".join(lines)


def _function(network: Network, body: list[str]) -> list[str]:
    inputs = ", ".join(f"x{i}" for i in range(network.inputs))
    result = f"np.stack([{', '.join(_variable(network, key) for key in network.outputs)}])"
    if network.output_transform not in (None, "identity"):
        result = _called(network.output_transform, result)
    return [
        "",
        "def network(inputs):",
        *_wrapped(f"({inputs},) = np.asarray(inputs, float)"),
        *body,
        *_wrapped(f"return {result}"),
    ]


def _feed_forward(network: Network) -> list[str]:
    live = set(network.keys)
    if network.rule == "live":
        live = reached(range(network.inputs), network.pairs)
    lines = []
    for key in order(network.keys, network.pairs):
        if key not in live and key in network.outputs:
            lines += _wrapped(f"n{key} = np.full_like(x0, np.nan)")
        elif key >= network.inputs and key in live:
            lines += _wrapped(f"n{key} = {_node(network, key, live)}")
    return lines


def _recurrent(network: Network) -> list[str]:
    keys = [key for key in network.keys if key >= network.inputs]
    start = "np.nan" if network.rule == "live" else "0.0"
    lines = [f"    n{key} = np.full_like(x0, {start})" for key in keys]
    lines.append(f"    for _ in range({network.steps}):")
    for key in keys:
        new = _node(network, key, set(network.keys))
        sources = [_variable(network, link.source) for link in network.incoming[key]]
        if network.rule == "live":
            new = f"kept(n{key}, {new}, {', '.join(sources)})" if sources else f"n{key}"
        lines += _wrapped(f"m{key} = {new}", 8)
    return lines + [f"        n{key} = m{key}" for key in keys]


def _node(network: Network, key: int, live: set[int]) -> str:
    """Return the expression of a node's value, adding in the order in which `evaluate` does."""
    node = network.node[key]
    terms = [
        # `repr` keeps every bit of a weight.
        f"{link.weight!r} * {_variable(network, link.source)}"
        for link in network.incoming[key]
        if link.source in live
    ]
    name = AGGREGATIONS[node.aggregation].__name__
    plain = network.steps is None or network.rule == "always"
    if not terms:
        gathered = "np.zeros_like(x0)"
    elif plain and (len(terms) == 1 or name == "total"):
        gathered = " + ".join(terms)
    else:
        gathered = f"{name}(*messages({', '.join(terms)}))"
    if node.response != 1:
        gathered = f"{node.response!r} * ({gathered})"
    if node.bias:
        gathered = f"{node.bias!r} + ({gathered})"
    value = gathered if node.activation == "identity" else _called(node.activation, gathered)
    if isfinite(network.bound) and node.activation not in WITHIN_ONE:
        return f"np.clip({value}, -{network.bound!r}, {network.bound!r})"
    return value


def _called(activation: str, z: str) -> str:
    function = ACTIVATIONS[activation]
    return f"{'np.' if isinstance(function, np.ufunc) else ''}{function.__name__}({z})"


def _variable(network: Network, key: int) -> str:
    return f"x{key}" if key < network.inputs else f"n{key}"


def _listed(network: Network, keys) -> str:
    """Return names for a docstring, without characters that could end it."""
    names = network.names
    return ", ".join(re.sub(r"[^\w .()-]", "", names[key]) or str(key) for key in keys)


def _wrapped(line: str, indent: int = 4) -> list[str]:
    name, equals, value = line.partition(" = ")
    if len(line) + indent > 96 and equals:
        line = f"{name}\u00a0=\u00a0({value})"  # No break beside the sign.
    wrapper = TextWrapper(96, break_long_words=False, break_on_hyphens=False)
    wrapper.initial_indent, wrapper.subsequent_indent = " " * indent, " " * (indent + 4)
    return [part.replace("\u00a0", " ") for part in wrapper.wrap(line)]


def formula(network: Network) -> str:
    """Write every node's value to four digits, sources before their targets."""
    names = {key: f"n{key}" for key in network.keys}
    names |= {key: name.replace(" ", "_") for key, name in network.names.items()}
    keys = network.keys if network.steps else order(network.keys, network.pairs)
    computed = [key for key in keys if key >= network.inputs]
    lines = [f"{names[key]} = {_written_value(network, key, names)}" for key in computed]
    if network.steps:
        lines.insert(0, f"{network.steps} times, all at once from the values before:")
    if network.output_transform not in (None, "identity"):
        outputs = ", ".join(names[key] for key in network.outputs)
        lines.append(f"at the end {network.output_transform} of {outputs}")
    return "\n".join(lines) + "\n"


def _written_value(network: Network, key: int, names: dict[int, str]) -> str:
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
