"""Exchange of networks with TensorNEAT: the arrays of a genome, their names, and its file.

The file is a NumPy archive of `nodes`, `conns`, `fitness` and `meta` (JSON text).
"""

import json
import zlib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from io import BytesIO
from math import inf, isinf, prod
from typing import Any
from zipfile import BadZipFile, LargeZipFile, ZipFile

import numpy as np

from .functions import ACTIVATIONS, AGGREGATIONS, BOUNDED, TO_REGISTER
from .network import (
    LARGEST_KEY,
    Link,
    Network,
    Node,
    agree,
    delegated,
    evaluate,
    outputs_first,
    probes,
    renumbered,
    require_agreement,
)

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
    # A row is used where its key is no NaN; unused rows may stand between others.
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


FORMAT = "microcosmos-tensorneat/1"

SMALLEST = 16
"""Least number of rows, doubled until they suffice: few shapes need few compilations."""


@dataclass(frozen=True)
class Genome:
    """The arrays of a network for TensorNEAT, and the names that it does not keep."""

    nodes: np.ndarray
    conns: np.ndarray
    meta: dict[str, Any]


def write_tensorneat(
    network: Network, max_nodes: int | None = None, max_conns: int | None = None
) -> Genome:
    """Return the genome of a network, checked: read back, it computes the same.

    Raises `ValueError` if it does not, or if there is no room.
    """
    written = _written(outputs_first(as_live(network)), max_nodes, max_conns)
    back = read_tensorneat(written.nodes, written.conns, written.meta)
    require_agreement("the exported network", network, back)
    return written


def as_live(network: Network) -> Network:
    """Return the same function under TensorNEAT's rule, where outputs are linear.

    An output's activation goes to a hidden node before it; a node without sources, which
    would have no value, gets one with weight 0.
    """
    network = _unbounded(network)
    if network.rule == "always":
        # Links that are added have no historical number, so none keeps its own.
        links = [replace(link, marker=None) for link in network.links]
        computed = network.keys[network.inputs :]
        links += [Link(0, key, 0.0) for key in computed if not network.incoming[key]]
        network = replace(network, rule="live", links=tuple(links))
    for output in network.outputs:
        if network.node[output].activation != "identity":
            network = delegated(network, output, "identity")
    if max(network.keys) < LARGEST_KEY - len(network.outputs):
        return network
    rank = {key: place for place, key in enumerate(sorted(network.keys))}
    return renumbered(network, rank.__getitem__)


def _unbounded(network: Network) -> Network:
    """Return the same function without a bound of its own.

    Where random inputs pass the bound, activations keep it.
    """
    if isinf(network.bound):
        return network
    free, points = replace(network, bound=inf), probes(network.inputs)
    if agree(evaluate(network, points), evaluate(free, points)):
        return free
    kept = [
        node
        if node.key < network.inputs
        else replace(node, activation=BOUNDED.get(node.activation, node.activation))
        for node in network.nodes
    ]
    return replace(free, nodes=tuple(kept))


def room(needed: int) -> int:
    """Return the smallest of 16, 32, 64 … that holds as many rows."""
    return max(SMALLEST, 1 << (needed - 1).bit_length())


def _written(network: Network, max_nodes: int | None, max_conns: int | None) -> Genome:
    has_response = any(node.response != 1 for node in network.nodes)
    node_class = "DefaultNode" if has_response else "BiasNode"
    # float32 holds whole numbers exactly below 2²⁴ alone.
    marked = network.marked and max(x.marker or 0 for x in network.links) < LARGEST_KEY
    conn_class = "OriginConn" if marked else "DefaultConn"
    # All of them always, so that one compiled program evaluates all networks.
    activations = list(ACTIVATIONS)
    used = {node.aggregation for node in network.nodes}
    aggregations = [name for name in AGGREGATIONS if name in used]
    index = {"aggregation": aggregations.index, "activation": activations.index}
    nodes = [
        [node.key, *(index.get(x, float)(getattr(node, x)) for x in NODES[node_class])]
        for node in network.nodes
    ]
    columns = ("source", "target", *CONNECTIONS[conn_class])
    conns = [[getattr(link, name) for name in columns] for link in network.links]
    size = room(len(nodes)) if max_nodes is None else max_nodes
    length = room(len(conns)) if max_conns is None else max_conns
    meta = {"node_class": node_class, "conn_class": conn_class}
    meta |= {"activation_names": activations, "aggregation_names": aggregations}
    return Genome(
        _padded("max_nodes", nodes, 1 + len(NODES[node_class]), size),
        _padded("max_conns", conns, len(columns), length),
        _described(network) | meta,
    )


def _described(network: Network) -> dict[str, Any]:
    recurrent = network.steps is not None
    return {
        "format": FORMAT,
        "genome_class": "RecurrentGenome" if recurrent else "DefaultGenome",
        "network_type": "recurrent" if recurrent else "feedforward",
        "activate_time": network.steps,
        "num_inputs": network.inputs,
        "num_outputs": len(network.outputs),
        "input_keys": list(range(network.inputs)),
        "output_keys": list(network.outputs),
        "input_names": list(network.input_names),
        "output_names": list(network.output_names),
        "input_transform": None,
        "output_transform": network.output_transform,
        "register": list(TO_REGISTER),
    }


def _padded(field: str, given: list[list[Any]], columns: int, rows: int) -> np.ndarray:
    if len(given) > rows:
        raise ValueError(f"`{field}` must be at least {len(given)}, got {rows}")
    table = np.full((rows, columns), np.nan, np.float32)
    table[: len(given)] = np.array(given, float).reshape(len(given), columns)
    return table


MEMBERS = ("nodes.npy", "conns.npy", "fitness.npy", "meta.npy")
LARGEST = 64 * 2**20
"""Most bytes of an array, so that a small file cannot ask for all memory."""


def dump_tensorneat(genome: Genome, fitness: float = float("nan")) -> bytes:
    """Write a genome as TensorNEAT saves one, with its names beside it."""
    stream, meta, value = BytesIO(), np.array(json.dumps(genome.meta)), np.float32(fitness)
    np.savez(stream, nodes=genome.nodes, conns=genome.conns, fitness=value, meta=meta)
    return stream.getvalue()


def load_tensorneat(
    data: bytes, meta: Mapping[str, Any] | None = None
) -> tuple[Network, float]:
    """Return the network in a file, and its fitness or NaN. Raises `ValueError` if invalid.

    A file that TensorNEAT itself wrote holds no names: give them as `meta`.
    """
    arrays = _arrays(data)
    # A file that TensorNEAT wrote has positions of functions, and no names.
    names = _meta(arrays) if meta is None else meta
    for name in ("nodes", "conns"):
        if name not in arrays:
            raise ValueError(f"the file must hold `{name}`, got {sorted(arrays)}")
    fitness = arrays.get("fitness", np.array(np.nan))
    if fitness.size != 1 or fitness.dtype.kind not in "fiu":
        raise ValueError(f"`fitness` must be one number, got {fitness.dtype}{fitness.shape}")
    network = read_tensorneat(arrays["nodes"], arrays["conns"], names)
    return network, float(fitness.reshape(()))


def _meta(arrays: Mapping[str, np.ndarray]) -> Any:
    if "meta" not in arrays:
        raise ValueError(
            f"the file must hold `meta`, or its names must be given; got {sorted(arrays)}"
        )
    try:
        return json.loads(str(arrays["meta"]))
    except (ValueError, RecursionError) as error:
        raise ValueError(f"`meta` must be JSON, got {str(arrays['meta'])!r:.60}") from error


def _arrays(data: bytes) -> dict[str, np.ndarray]:
    try:
        with ZipFile(BytesIO(data)) as file:
            names = file.namelist()
            if not set(names) <= set(MEMBERS) or len(names) > len(MEMBERS):
                needed = ", ".join(MEMBERS)
                raise ValueError(f"the file must hold {needed} alone, got {names[:8]}")
            return {name.removesuffix(".npy"): _array(name, file) for name in names}
    except (BadZipFile, LargeZipFile, EOFError, OSError, RuntimeError, zlib.error) as error:
        raise ValueError(f"a genome must be a NumPy archive (.npz), got {error}") from error


def _array(name: str, file: ZipFile) -> np.ndarray:
    """Read one array; its header must fit the bytes before memory is allocated."""
    with file.open(name) as member:
        data = member.read(LARGEST + 1)
    if len(data) > LARGEST:
        raise ValueError(f"`{name}` must be at most {LARGEST:,} bytes, got more")
    stream = BytesIO(data)
    version = np.lib.format.read_magic(stream)
    if version != (1, 0):
        raise ValueError(f"`{name}` must be of NumPy's format 1.0, got {version}")
    shape, fortran, dtype = np.lib.format.read_array_header_1_0(stream)
    rest = data[stream.tell() :]
    if dtype.hasobject or prod(shape) * dtype.itemsize != len(rest) or not rest:
        raise ValueError(f"`{name}` must hold {shape} of {dtype}, got {len(rest)} bytes")
    return np.frombuffer(rest, dtype).reshape(shape, order="F" if fortran else "C")
