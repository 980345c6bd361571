"""Specs of runs as the database has them, read again and estimated."""

import json
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from microcosmos.spec import Estimate, Spec, estimate, parse


@dataclass(frozen=True)
class Known:
    """A spec and what it needs."""

    spec: Spec
    needs: Estimate


def known(document: dict[str, Any]) -> Known | None:
    """None where another version wrote it in its own way."""
    return _known(json.dumps(document, sort_keys=True))


@lru_cache(maxsize=1024)
def _known(text: str) -> Known | None:
    try:
        spec = parse(json.loads(text))
        return Known(spec, estimate(spec))
    except ValueError:
        return None
