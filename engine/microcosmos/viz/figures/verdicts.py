"""Verdicts of audits, for figures."""

import json
from collections.abc import Sequence
from pathlib import Path

WORDS = {True: "trusted", False: "not trusted"}


def verdicts(reports: Sequence[Path]) -> dict[str, bool]:
    """Return the verdict on each audited creature, by its hash.

    Raises `ValueError` for a file that is not the report of an audit.
    """
    found = {}
    for path in reports:
        try:
            report = json.loads(path.read_bytes())
            found[report["creature"]] = bool(report["verdict"]["trusted"])
        except (KeyError, TypeError, ValueError) as error:
            needed = "a report of `microcosmos audit FILE --out REPORT`"
            raise ValueError(f"`--audit` needs {needed}, got {path}") from error
    return found
