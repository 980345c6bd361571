"""JSON that people wrote. Parsers disagree on which value of a repeated name counts."""

import json
from collections import Counter
from collections.abc import Iterable
from typing import Any

from .invalid import InvalidField


class _Pairs(tuple):
    """Names and values of an object, in order."""


def read_json(text: str | bytes) -> Any:
    """Return the document in a text.

    Raises `InvalidField` for a name that an object has twice, and `ValueError` for what is not
    JSON, is no text or nests too deeply.
    """
    try:
        return _whole(json.loads(text, object_pairs_hook=_Pairs), "")
    except RecursionError:
        raise ValueError("JSON must nest less deeply") from None
    except UnicodeDecodeError:
        raise ValueError("JSON must be text in UTF-8; got other bytes") from None


def _whole(part: Any, path: str) -> Any:
    if isinstance(part, _Pairs):
        refuse_repeated((name for name, _ in part), path)
        return {name: _whole(one, f"{path}{name}.") for name, one in part}
    if isinstance(part, list):
        return [_whole(one, f"{path}{i}.") for i, one in enumerate(part)]
    return part


def refuse_repeated(names: Iterable[str], path: str) -> None:
    """Raise `InvalidField` for a name that stands twice in the object at a path."""
    for name, times in Counter(names).items():
        if times > 1:
            raise InvalidField(f"{path}{name}", "must be given once; got it twice")
