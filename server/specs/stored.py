"""Stored specs of runs, parsed and estimated."""

import json
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from microcosmos.spec import Estimate, Spec, estimate, parse


@dataclass(frozen=True)
class ParsedSpec:
    spec: Spec
    estimate: Estimate


def parsed(document: dict[str, Any]) -> ParsedSpec | None:
    """Return None if this version cannot read a spec of another version."""
    return _parsed(json.dumps(document, sort_keys=True))


@lru_cache(maxsize=1024)
def _parsed(text: str) -> ParsedSpec | None:
    try:
        spec = parse(json.loads(text))
        return ParsedSpec(spec, estimate(spec))
    except ValueError:
        return None
