"""A reader of Newick files without quotes and comments, for tests."""

import re
from typing import NamedTuple

TOKEN = re.compile(r"[(),;]|[^(),;\s]+")


class Node(NamedTuple):
    label: str
    length: float
    parent: str | None


def read(text: str) -> list[Node]:
    """The nodes of all trees of a file; raises `ValueError` where a tree is malformed."""
    nodes: list[Node] = []
    waiting: list[list[str]] = [[]]
    closed: list[str] | None = None
    for token in TOKEN.findall(text):
        if token == "(":
            waiting.append([])
        elif token == ")":
            closed = waiting.pop()
        elif token == ",":
            if len(waiting) == 1:
                raise ValueError("a comma outside a tree")
        elif token == ";":
            if len(waiting) != 1 or len(waiting[0]) != 1:
                raise ValueError("a tree must have one root and closed parentheses")
            waiting = [[]]
        else:
            label, _, length = token.partition(":")
            parents = dict.fromkeys(closed or (), label)
            nodes = [
                one._replace(parent=label) if one.label in parents else one for one in nodes
            ]
            nodes.append(Node(label, float(length), None))
            waiting[-1].append(label)
            closed = None
    if waiting != [[]]:
        raise ValueError("the last tree does not end")
    return nodes
