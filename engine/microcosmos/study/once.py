"""YAML and JSON in which each mapping has every name once."""

import json as json_module
import re
from collections.abc import Sequence
from typing import Any

from ..optional import require

FLOAT = re.compile(r"[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)[eE][-+]?[0-9]+$")
"""Numbers of YAML 1.2, such as `1e-2`, that PyYAML reads as text."""


class _Pairs(tuple):
    """Names and values of a mapping, in order."""


def json(text: str) -> Any:
    """Return the document in a text. Raises `ValueError` for a name that is given twice."""
    return _whole(json_module.loads(text, object_pairs_hook=_Pairs), "")


def _whole(part: Any, path: str) -> Any:
    if isinstance(part, _Pairs):
        _refuse_twice([name for name, _ in part], path)
        return {name: _whole(one, f"{path}{name}.") for name, one in part}
    if isinstance(part, list):
        return [_whole(one, f"{path}{i}.") for i, one in enumerate(part)]
    return part


def yaml(text: str) -> Any:
    """Return the document in a text. Raises `ValueError` for a name that is given twice, and
    `ImportError` without the extra `studies`."""
    library = require("yaml", "microcosmos[studies]")
    made = type("Loader", (library.SafeLoader,), {})
    made.add_implicit_resolver("tag:yaml.org,2002:float", FLOAT, list("-+.0123456789"))
    try:
        loader = made(text)
        node = loader.get_single_node()
        _check(library, node, "", set())
        return None if node is None else loader.construct_document(node)
    except library.YAMLError as error:
        raise ValueError(f"a study must be YAML or JSON: {error}") from error


def _check(library: Any, node: Any, path: str, seen: set[int]) -> None:
    """Refuse names that are given twice; aliases lead to a node again, also to one above."""
    if id(node) in seen:
        return
    seen.add(id(node))
    if isinstance(node, library.MappingNode):
        named = [(key.value, one) for key, one in node.value if _is_name(library, key)]
        _refuse_twice([name for name, _ in named], path)
        for name, one in named:
            _check(library, one, f"{path}{name}.", seen)
    elif isinstance(node, library.SequenceNode):
        for i, one in enumerate(node.value):
            _check(library, one, f"{path}{i}.", seen)


def _is_name(library: Any, key: Any) -> bool:
    """Return whether a key is a name, and not `<<`, which merges mappings."""
    return isinstance(key, library.ScalarNode) and not key.tag.endswith(":merge")


def _refuse_twice(names: Sequence[str], path: str) -> None:
    for name in names:
        if names.count(name) > 1:
            raise ValueError(f"{path}{name}: a name must be given once, got it twice")
