"""Malformed creature files, made systematically from valid ones, always the same."""

import gzip
import json
import random
from collections.abc import Callable, Iterator
from copy import deepcopy
from dataclasses import dataclass
from functools import reduce
from operator import delitem, getitem, setitem
from typing import Any

import reports

from microcosmos.archive import creature

Keys = tuple[str | int, ...]


@dataclass(frozen=True)
class Case:
    """A request body, and a pattern that its refusal matches."""

    name: str
    body: bytes
    says: str = ""
    kind: str = "application/json"
    harmless: bool = False
    """The change may leave the file valid."""


def valid_document() -> dict[str, Any]:
    return creature.document(reports.identity(), None, None)


def encoded(document: Any) -> bytes:
    return json.dumps(document, separators=(",", ":"), ensure_ascii=False).encode()


def cases() -> Iterator[Case]:
    """Documents that are not plain JSON, not a creature, or not the creature they name."""
    yield from broken(encoded(valid_document()))
    yield from oversized()
    yield from changed(valid_document())


def broken(whole: bytes) -> Iterator[Case]:
    rng = random.Random(7)
    for at in sorted(rng.sample(range(len(whole) - 1), 120)):
        yield Case(f"truncated at {at}", whole[:at], "JSON")
    original = json.loads(whole)
    for at in sorted(rng.sample(range(whole.index(b'"licence"')), 200)):
        flipped = bytearray(whole)
        flipped[at] ^= 1 << rng.randrange(8)
        if not equal(bytes(flipped), original):
            yield Case(f"bit flipped in {at}", bytes(flipped))
    for at in sorted(rng.sample(range(len(whole)), 30)):
        for name, byte in (("no UTF-8", b"\xff"), ("NUL", b"\0")):
            yield Case(f"{name} at {at}", whole[:at] + byte + whole[at:], "JSON")
    yield Case("BOM", b"\xef\xbb\xbf" + whole, "BOM")
    for encoding in ("utf-16", "utf-16-le", "utf-32", "utf-7"):
        yield Case(encoding, "\ufeff{}".encode(encoding), "JSON")
    yield Case("gzip", gzip.compress(whole, mtime=0), "JSON")
    yield Case("gzip bomb", gzip.compress(bytes(50 << 20), mtime=0), "JSON")
    yield Case("twice", whole + whole, "JSON")
    for name in ("identity", "sha256", "encoding", "viscosity", "weight", "width"):
        key = f'"{name}":'.encode()
        yield Case(f"{name} twice", whole.replace(key, key + b"1," + key, 1), f"{name}' twice")


def equal(body: bytes, document: Any) -> bool:
    """Tell whether bytes are this document, also in other words, such as 1E-05 for 1e-05."""
    try:
        return json.loads(body) == document
    except ValueError:
        return False


def oversized() -> Iterator[Case]:
    yield Case("too many bytes", b'{"a":"' + b"a" * (9 << 20) + b'"}', "bytes")
    yield Case("too many values", b"[" + b"[]," * 200_000 + b"[]]", "values")
    for depth in (33, 1000, 100_000):
        yield Case(f"{depth} lists deep", b"[" * depth + b"]" * depth, "levels")
        deep = b'{"a":' * depth + b"1" + b"}" * depth
        yield Case(f"{depth} objects deep", deep, "levels")
        yield Case(f"{depth} lists begun", b"[" * depth, "JSON" if depth < 900 else "")
    for document in (b"", b" ", b"null", b"1", b'"text"', b"[]", b"{}", b"[1,2]", b"tru"):
        yield Case(f"{document!r} alone", document)
    for long in (5000, 500_000):
        yield Case(f"{long} digits", b'{"identity":' + b"9" * long + b"}")
        yield Case(f"exponent of {long} digits", b'{"identity":1e' + b"9" * long + b"}")


REPLACEMENTS = {
    "null": None,
    "true": True,
    "text": "text",
    "list": [],
    "object": {},
    "negative": -1,
    "large": 1e308,
    "huge": 10**400,
    "many": [0] * 9000,
    "long": "A" * 100_000,
}


def changed(document: dict[str, Any]) -> Iterator[Case]:
    """Every value of a document in turn: of another type or size, missing, one too many."""
    for path in paths(document):
        place, last, here = ".".join(map(str, path)), path[-1], reduce(getitem, path, document)
        for name, value in REPLACEMENTS.items():
            any_licence = last == "licence" and isinstance(value, str)
            if any_licence or (last == "credit" and value == []) or value is here is None:
                continue
            # A missing part has its default, and true counts as 1: the file may stay valid.
            body = edited(document, path, setitem, value)
            yield Case(f"{place}: {name}", body, harmless=value in (True, {}))
        for constant in ("NaN", "-Infinity", "1e999", "01", "+1"):
            yield Case(f"{place}: {constant}", literal(document, path, constant), "JSON|finite")
        if isinstance(last, str) and last not in ("measured", "provenance", "licence"):
            yield Case(f"{place} missing", edited(document, path, delitem), harmless=True)
        if isinstance(here, dict):
            body = edited(document, path, setitem, here | {"surprise": 1})
            yield Case(f"{place}: surprise", body)
    for escape in (r'"\ud800"', r'"\u0000"', r'"\x41"', '"\n"'):
        yield Case(f"licence: {escape!r}", literal(document, ("licence",), escape))


def paths(document: Any, before: Keys = ()) -> Iterator[Keys]:
    """The paths of all values; the first item of a list stands for all."""
    items = document.items() if isinstance(document, dict) else enumerate(document[:1])
    for key, value in items:
        yield (*before, key)
        if isinstance(value, dict | list):
            yield from paths(value, (*before, key))


def edited(document: Any, path: Keys, edit: Callable[..., None], *values: Any) -> bytes:
    """Set or delete the item at a path."""
    other = deepcopy(document)
    edit(reduce(getitem, path[:-1], other), path[-1], *values)
    return encoded(other)


def literal(document: Any, path: Keys, text: str) -> bytes:
    """Write this text in place of a value."""
    return edited(document, path, setitem, "@here@").replace(b'"@here@"', text.encode())
