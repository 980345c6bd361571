"""Arrow tables of runs, and their Parquet and Arrow files."""

import json
from collections.abc import Callable, Mapping, Sequence
from io import BytesIO
from typing import Any

import numpy as np

from ..archive.export import Source, source_bytes
from ..invalid import InvalidField
from ..optional import require
from ..quantities.real import Real
from . import si, tables
from .run_file import RunFile
from .tables import Column, Columns, Ragged

FORMAT = "microcosmos-table/1"
EXTRA = "microcosmos[exports]"
ITEM = "element"
"""Name of the items of lists in Parquet."""


def to_arrow(
    archive: Source,
    table: str = "archive",
    run: str = "run",
    *,
    length: str | None = None,
    period: str | None = None,
) -> Any:
    """Return a table of a run's file as a `pyarrow.Table`.

    `table` is `archive`, `curves`, `lineage`, `genomes` or `poses`, or `result` for a run
    without an archive; `docs/formats.md` describes the columns. `run` fills the first one.
    Titles and units are metadata of the fields, the spec is metadata of the schema. With the
    real `length` of a body, such as `1mm`, and `period` of a stroke, such as `0.5s`, columns
    `NAME_si` in SI units follow. Raises `ValueError` for a table that the run lacks, and for a
    length or period without a known unit, and `ImportError` without pyarrow.
    """
    real = Real.of(length, period)
    return of_runs([RunFile(run, source_bytes(archive))], table, real)


def of_runs(runs: Sequence[RunFile], table: str, real: Real | None = None) -> Any:
    """Return a table of several runs, one after another; the first column names the run.

    A column that one run lacks is null in its rows. A field has the unit and the axis that are
    the same for all runs, and none where they differ. With `real` quantities, columns in SI
    units follow; every body then has that length.
    """
    pa = require("pyarrow", EXTRA)
    parts = [
        of_columns(_of(run, table, real), run.name)
        for run in runs
        if table in tables.makers(run)
    ]
    if not parts:
        known = ", ".join(tables.names(list(runs)))
        raise InvalidField("table", f"must be one of {known}, got {table!r}")
    fields = _agreed(parts)
    whole = pa.concat_tables([_with(one, fields) for one in parts], promote_options="default")
    # An Arrow file takes one dictionary for each column.
    whole = whole.unify_dictionaries()
    about = {
        "format": FORMAT,
        "table": table,
        "runs": json.dumps({run.name: run.facts() for run in runs}, ensure_ascii=False),
    }
    if real is not None:
        about["real"] = json.dumps(si.facts(real))
    return whole.replace_schema_metadata(about)


def _agreed(parts: Sequence[Any]) -> dict[str, Any]:
    """Return a field for each column of tables, with the metadata that all of them give it.

    Raises `ValueError` where values differ in type.
    """
    fields: dict[str, Any] = {}
    for name in dict.fromkeys(name for part in parts for name in part.column_names):
        having = [part for part in parts if name in part.column_names]
        found = [part.schema.field(name) for part in having]
        kinds = {one.type for one in found}
        if len(kinds) > 1:  # A table without any value does not know its type.
            filled = [part.column(name) for part in having if not _is_empty(part.column(name))]
            kinds = {one.type for one in filled} or {found[0].type}
        if len(kinds) > 1:
            got = ", ".join(sorted(map(str, kinds)))
            raise InvalidField(name, f"must have one type in all runs; got {got}")
        first, *others = (one.metadata or {} for one in found)
        about = {k: v for k, v in first.items() if all(one.get(k) == v for one in others)}
        fields[name] = found[0].with_type(kinds.pop()).with_metadata(about)
    return fields


def _is_empty(column: Any) -> bool:
    return all(one.is_null(nan_is_null=True).true_count == len(one) for one in column.chunks)


def _with(table: Any, fields: Mapping[str, Any]) -> Any:
    """Return a table with these fields; a column of another type, without values, is null."""
    pa = require("pyarrow", EXTRA)
    of = pa.schema([fields[name] for name in table.column_names])
    columns = [
        old if old.type == new.type else pa.nulls(len(old), new.type)
        for old, new in zip(table.columns, of, strict=True)
    ]
    return pa.table(columns, schema=of)


def _of(run: RunFile, table: str, real: Real | None) -> Columns:
    columns = tables.makers(run)[table](run)
    return columns if real is None else si.with_si(columns, run, table, real)


def of_columns(columns: Columns, run: str) -> Any:
    """Return columns as a `pyarrow.Table` behind a column with the name of the run."""
    pa = require("pyarrow", EXTRA)
    count = next((_rows(one) for one in columns.values()), 0)
    named = Column([run] * count, "Run", "", repeated=True)
    whole = {"run": named, **columns}
    arrays = {name: _array(pa, column) for name, column in whole.items()}
    fields = [
        pa.field(name, arrays[name].type, metadata=_about(column))
        for name, column in whole.items()
    ]
    return pa.table(list(arrays.values()), schema=pa.schema(fields))


def _rows(column: Column) -> int:
    values = column.values
    return len(values.counts if isinstance(values, Ragged) else values)


def _about(column: Column) -> dict[str, str]:
    about = {"title": column.title}
    about |= {"unit": column.unit} if column.unit else {}
    if column.axis is not None:
        names = ("low", "high", "bins", "scale")
        about["axis"] = json.dumps({name: column.axis[name] for name in names})
    return about


def _array(pa: Any, column: Column) -> Any:
    if column.repeated:
        return pa.array(column.values, pa.string()).dictionary_encode()
    return _values(pa, column.values)


def _values(pa: Any, values: Any) -> Any:
    """Return values without a change of a bit; NaN stays NaN."""
    if isinstance(values, Ragged):
        offsets = np.concatenate([[0], np.cumsum(values.counts)]).astype(np.int32)
        items = _values(pa, values.items)
        kind = pa.list_(pa.field(ITEM, items.type))
        return pa.ListArray.from_arrays(pa.array(offsets), items, type=kind)
    if not isinstance(values, np.ndarray):
        # An explicit type: an archive without elites has no text to infer it from.
        return pa.array(values, pa.string())
    if values.ndim == 2:
        flat = pa.array(np.ascontiguousarray(values).ravel())
        kind = pa.list_(pa.field(ITEM, flat.type), values.shape[1])
        return pa.FixedSizeListArray.from_arrays(flat, type=kind)
    return pa.array(np.ascontiguousarray(values))


def parquet(table: Any) -> bytes:
    """Return a Parquet file, compressed by Zstandard.

    Bytes of floats are split by place, which halves poses.
    """
    pa, file = require("pyarrow", EXTRA), BytesIO()
    words = [one.name for one in table.schema if pa.types.is_dictionary(one.type)]
    leaves = [_leaf(pa, one.name, one.type) for one in table.schema]
    split = [path for path, kind in leaves if pa.types.is_floating(kind)]
    # Parquet prefers a dictionary to the split of bytes, so only words have one.
    options = {"use_dictionary": words, "use_byte_stream_split": split, "compression": "zstd"}
    require("pyarrow.parquet", EXTRA).write_table(table, file, **options)
    return file.getvalue()


def _leaf(pa: Any, path: str, kind: Any) -> tuple[str, Any]:
    """Return the path and type of what a column's lists hold, as Parquet names it."""
    if pa.types.is_list(kind) or pa.types.is_fixed_size_list(kind):
        return _leaf(pa, f"{path}.list.{ITEM}", kind.value_type)
    return path, kind


def arrow(table: Any) -> bytes:
    """Return an Arrow IPC file, which is not compressed, so that it can be mapped."""
    ipc, file = require("pyarrow.ipc", EXTRA), BytesIO()
    with ipc.new_file(file, table.schema) as writer:
        writer.write_table(table)
    return file.getvalue()


WRITERS: dict[str, Callable[[Any], bytes]] = {"parquet": parquet, "arrow": arrow}
