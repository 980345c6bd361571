"""Networks from the arrays of a TensorNEAT genome and the names that belong to them."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from .network import LARGEST_KEY, Link, Network, Node

NODES = {
    "DefaultNode": ("bias", "response", "aggregation", "activation"),
    "OriginNode": ("bias", "response", "aggregation", "activation"),
    "BiasNode": ("bias", "aggregation", "activation"),
}
"""Columns after the key, by class of nodes."""

CONNECTIONS = {"DefaultConn": ("weight",), "OriginConn": ("marker", "weight")}
"""Columns after source and target, by class of connections."""

GENOMES = ("DefaultGenome", "RecurrentGenome")

MAX_STEPS = 10_000


def read_tensorneat(nodes: np.ndarray, conns: np.ndarray, meta: Mapping[str, Any]) -> Network:
    """Return the network of one genome: `nodes` and `conns` (row, column), NaN if unused.

    `meta` names the classes and, in order, the functions; see `docs/networks.md`. Outputs are
    linear and inputs have no attributes, whatever their columns hold. Raises `ValueError`.
    """
    one_of(meta, "genome_class", GENOMES)
    node_columns = NODES[one_of(meta, "node_class", tuple(NODES))]
    conn_columns = CONNECTIONS[one_of(meta, "conn_class", tuple(CONNECTIONS))]
    inputs, outputs = _ends(meta)
    if meta.get("input_transform") is not None:
        raise ValueError(f"`input_transform` must be null, got {meta['input_transform']!r:.80}")
    nodes = _table("nodes", nodes, ("key", *node_columns))
    conns = _table("conns", conns, ("source", "target", *conn_columns))
    keys = _whole("nodes", "key", nodes[:, 0], 0, LARGEST_KEY)
    _refuse_other_rows(keys, (*range(inputs), *outputs))
    used, given = ~np.isnan(nodes[:, 0]), ~np.isnan(conns[:, 0])
    columns = dict(zip(node_columns, nodes[used, 1:].T, strict=True))
    activations = (*_names(meta, "activation_names"), "identity")  # So that −1 is identity.
    activation = _function("activation", columns["activation"], activations, -1)
    aggregations = _names(meta, "aggregation_names")
    aggregation = _function("aggregation", columns["aggregation"], aggregations, 0)
    kept = keys[used]
    is_input = kept < inputs
    linear = is_input | np.isin(kept, outputs)
    response = columns.get("response", np.ones(len(kept)))
    columns_of_nodes = (
        kept.tolist(),
        np.where(is_input, 0, columns["bias"]).tolist(),
        np.where(is_input, 1, response).tolist(),
        np.where(is_input, "sum", aggregation).tolist(),
        np.where(linear, "identity", activation).tolist(),
    )
    return Network(
        inputs=inputs,
        outputs=outputs,
        nodes=tuple(Node(*row) for row in zip(*columns_of_nodes, strict=True)),
        links=_links(conns[given], "marker" in conn_columns),
        rule="live",
        steps=_steps(meta),
        output_transform=_transform(meta),
        input_names=_labels(meta, "input_names"),
        output_names=_labels(meta, "output_names"),
    )


def _links(conns: np.ndarray, marked: bool) -> tuple[Link, ...]:
    columns = (
        _keys("source", conns[:, 0]),
        _keys("target", conns[:, 1]),
        conns[:, -1].tolist(),
        *([_keys("historical marker", conns[:, 2])] if marked else []),
    )
    return tuple(Link(*row) for row in zip(*columns, strict=True))


def one_of(meta: Mapping[str, Any], field: str, allowed: tuple[str, ...]) -> str:
    """Return the word in a field, which must be one of those allowed."""
    if not isinstance(meta, Mapping):
        raise ValueError(f"`meta` must be an object of names, got {type(meta).__name__}")
    value = meta.get(field)
    if not isinstance(value, str) or value not in allowed:
        raise ValueError(f"`{field}` must be one of {', '.join(allowed)}, got {value!r:.80}")
    return value


def _integer(field: str, value: Any, low: int, high: int) -> int:
    whole = isinstance(value, int) and not isinstance(value, bool)
    if not whole or not low <= value < high:
        raise ValueError(
            f"`{field}` must be whole, from {low} to {high - 1}, got {value!r:.80}"
        )
    return value


def _ends(meta: Mapping[str, Any]) -> tuple[int, tuple[int, ...]]:
    inputs = _integer("num_inputs", meta.get("num_inputs"), 1, LARGEST_KEY)
    count = _integer("num_outputs", meta.get("num_outputs"), 1, LARGEST_KEY - inputs)
    if meta.get("output_keys") is None:
        return inputs, tuple(range(inputs, inputs + count))
    outputs = meta["output_keys"]
    if not isinstance(outputs, list) or len(outputs) != count:
        raise ValueError(f"`output_keys` must be a list of {count}, got {outputs!r:.80}")
    return inputs, tuple(_integer("output_keys", key, inputs, LARGEST_KEY) for key in outputs)


def _steps(meta: Mapping[str, Any]) -> int | None:
    if meta["genome_class"] == "DefaultGenome":
        return None
    return _integer("activate_time", meta.get("activate_time"), 1, MAX_STEPS + 1)


def _transform(meta: Mapping[str, Any]) -> str | None:
    name = meta.get("output_transform")
    if name is not None and not isinstance(name, str):
        raise ValueError(f"`output_transform` must be null or a name, got {name!r:.80}")
    return name


def _names(meta: Mapping[str, Any], field: str) -> tuple[str, ...]:
    names = meta.get(field)
    if not isinstance(names, list) or not names or any(not isinstance(n, str) for n in names):
        raise ValueError(f"`{field}` must be a list of names in order, got {names!r:.80}")
    return tuple(names)


def _labels(meta: Mapping[str, Any], field: str) -> tuple[str, ...]:
    return () if not meta.get(field) else _names(meta, field)


def _table(field: str, table: np.ndarray, columns: tuple[str, ...]) -> np.ndarray:
    """Return the rows in double precision; a used one has every column."""
    table = np.asarray(table)
    if table.ndim != 2 or table.shape[1] != len(columns):
        raise ValueError(
            f"`{field}` must be (rows, {len(columns)}) with columns {', '.join(columns)}, "
            f"got {table.shape}"
        )
    if table.dtype.kind != "f":
        raise ValueError(f"`{field}` must hold floats, got {table.dtype}")
    rows = np.flatnonzero(~np.isnan(table[:, 0]))
    if not np.isfinite(table[rows]).all():
        row = rows[~np.isfinite(table[rows]).all(1)][0]
        raise ValueError(f"`{field}` must be finite in used rows, got {table[row]} in {row}")
    return table.astype(float)


def _whole(field: str, column: str, values: np.ndarray, low: int, high: int) -> np.ndarray:
    """Return whole numbers from low to below high, −1 for an unused row."""
    used = ~np.isnan(values)
    valid = (values == np.floor(values)) & (values >= low) & (values < high)
    if (wrong := values[used & ~valid]).size:
        raise ValueError(
            f"`{field}` must have a {column} that is whole, from {low} to {high - 1}, "
            f"got {wrong[0]:g}"
        )
    return np.where(used, values, -1).astype(np.int64)


def _keys(column: str, values: np.ndarray) -> tuple[int, ...]:
    return tuple(_whole("conns", column, values, 0, LARGEST_KEY).tolist())


def _function(
    column: str, values: np.ndarray, names: tuple[str, ...], low: int
) -> tuple[str, ...]:
    places = _whole("nodes", f"function index ({column})", values, low, len(names) + low)
    return tuple(names[place] for place in places)


def _refuse_other_rows(keys: np.ndarray, ends: tuple[int, ...]) -> None:
    """Refuse inputs and outputs outside the rows of their keys, which TensorNEAT uses."""
    for key in ends:
        if key >= len(keys) or keys[key] != key:
            came = keys[key] if key < len(keys) else "no such row"
            raise ValueError(
                f"`nodes` must have the input or output {key} in row {key}, got {came}"
            )
