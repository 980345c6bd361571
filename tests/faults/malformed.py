"""Malformed creature files, made systematically from valid ones, always the same."""

import base64
import gzip
import json
import random
import struct
from collections.abc import Iterator
from copy import deepcopy
from dataclasses import dataclass
from typing import Any

from microcosmos.archive import creature
from server.creatures.probe import example

JSON = "application/json"


@dataclass(frozen=True)
class Case:
    """A body, and the words that its refusal must contain."""

    name: str
    body: bytes
    says: str = ""
    kind: str = JSON
    harmless: bool = False
    """The change may leave the file valid."""


def good() -> dict[str, Any]:
    """A valid creature file with a network."""
    identity = example()
    genome = identity["genome"]
    inputs, outputs = len(genome["inputs"]), len(genome["outputs"])
    genome["connections"] = {
        "innovation": list(range(outputs)),
        "source": [0] * outputs,
        "target": list(range(inputs, inputs + outputs)),
        "enabled": [True] * outputs,
        "weight": floats(*range(1, outputs + 1)),
    }
    return creature.document(identity, None, None)


def floats(*values: float) -> str:
    return base64.b64encode(struct.pack(f"<{len(values)}f", *values)).decode()


def written(document: Any) -> bytes:
    return json.dumps(document, separators=(",", ":"), ensure_ascii=False).encode()


def cases() -> Iterator[Case]:
    """Documents that are not plain JSON, not a creature, or not the creature they say."""
    yield from broken(written(good()))
    yield from oversized()
    yield from changed(good())


def broken(whole: bytes) -> Iterator[Case]:
    chance = random.Random(7)
    for at in sorted(chance.sample(range(len(whole) - 1), 120)):
        yield Case(f"truncated at {at}", whole[:at], "JSON")
    document = json.loads(whole)
    for at in sorted(chance.sample(range(whole.index(b'"licence"')), 200)):
        flipped = bytearray(whole)
        flipped[at] ^= 1 << chance.randrange(8)
        if not same(bytes(flipped), document):
            yield Case(f"bit flipped in {at}", bytes(flipped))
    for at in sorted(chance.sample(range(len(whole)), 30)):
        for name, byte in (("no UTF-8", b"\xff"), ("NUL", b"\0")):
            yield Case(f"{name} at {at}", whole[:at] + byte + whole[at:], "JSON")
    yield Case("BOM", b"\xef\xbb\xbf" + whole, "BOM")
    for encoding in ("utf-16", "utf-16-le", "utf-32", "utf-7"):
        yield Case(encoding, "\ufeff{}".encode(encoding), "JSON")
    yield Case("gzip", gzip.compress(whole, mtime=0), "JSON")
    yield Case("gzip bomb", gzip.compress(bytes(50 << 20), mtime=0), "JSON")
    yield Case("twice", whole + whole, "JSON")
    for name in ("identity", "sha256", "encoding", "viscosity", "weight", "width"):
        key = b'"%s":' % name.encode()
        yield Case(f"{name} twice", whole.replace(key, key + b"1," + key, 1), f"{name}' twice")


def same(body: bytes, document: Any) -> bool:
    """Tell whether bytes mean the same, such as 1E-05 for 1e-05."""
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


def changed(document: dict[str, Any]) -> Iterator[Case]:
    """Every value of a document in turn: of another type or size, missing, one too many."""
    for path in paths(document):
        place = ".".join(map(str, path))
        here = at(document, path)
        for name, value in replacements(here):
            if path == ("licence",) and isinstance(value, str):
                continue  # Any text is a licence.
            if path == ("credit",) and value == []:
                continue  # Nobody is to be named.
            # What is left out has its default, and true is 1 to some: that may be as before.
            same = value in (True, {})
            yield Case(f"{place}: {name}", changed_at(document, path, value), harmless=same)
        for constant in (b"NaN", b"-Infinity", b"1e999", b"01", b"+1"):
            body = changed_at(document, path, "@here@").replace(b'"@here@"', constant)
            yield Case(f"{place}: {constant.decode()}", body, "JSON|finite")
        if isinstance(path[-1], str) and path[-1] not in ("measured", "provenance", "licence"):
            body = changed_at(document, path, None, drop=True)
            yield Case(f"{place} missing", body, harmless=True)
        if isinstance(here, dict):
            body = changed_at(document, path, {**here, "surprise": 1})
            yield Case(f"{place}: surprise", body)
    text = changed_at(document, ("licence",), "@here@")
    for escape in (b'"\\ud800"', b'"\\u0000"', b'"\\x41"', b'"\n"'):
        yield Case(f"licence: {escape!r}", text.replace(b'"@here@"', escape))


def replacements(here: Any) -> Iterator[tuple[str, Any]]:
    found = {
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
    yield from (item for item in found.items() if here is not None or item[1] is not None)


def paths(document: Any, before: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """The paths of all values; the first item of a list stands for all."""
    items = document.items() if isinstance(document, dict) else enumerate(document[:1])
    for key, value in items:
        yield (*before, key)
        if isinstance(value, dict | list):
            yield from paths(value, (*before, key))


def at(document: Any, path: tuple[Any, ...]) -> Any:
    for key in path:
        document = document[key]
    return document


def changed_at(document: Any, path: tuple[Any, ...], value: Any, drop: bool = False) -> bytes:
    other = deepcopy(document)
    place = at(other, path[:-1])
    if drop:
        del place[path[-1]]
    else:
        place[path[-1]] = value
    return written(other)
