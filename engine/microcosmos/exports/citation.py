"""CITATION.cff of a published run."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import date
from typing import Any

from ..naming import LICENCE
from ..version import VERSION

PAPER = {
    "type": "article",
    "title": "Microcosmos: Reimagining Artificial Life for the GPU Era",
    "year": 2026,
    "authors": [
        {"given-names": given, "family-names": family}
        for given, family in (
            ("Mark", "Tensen"),
            ("Ciaran", "Regan"),
            ("Bert Wang-Chak", "Chan"),
            ("Mizuki", "Oka"),
            ("Kenneth O.", "Stanley"),
            ("Grisha", "Szep"),
        )
    ],
}
"""The paper whose model this software implements."""


@dataclass(frozen=True)
class Publication:
    """How a run is published."""

    title: str = ""
    """Empty: made of the run's name and experiment."""
    authors: Sequence[str] = ()
    """`Family, Given`, or the name of a group."""
    licence: str = LICENCE
    """An SPDX identifier."""
    day: date | None = None
    """Day of publication; None: today."""

    @property
    def published(self) -> date:
        return self.day or date.today()


def person(author: str) -> dict[str, str]:
    """Return an author as CFF describes one: a person, or an entity without a comma."""
    family, comma, given = (part.strip() for part in author.partition(","))
    if not comma:
        return {"name": family}
    return {"given-names": given, "family-names": family}


def citation(title: str, about: Publication, keywords: Sequence[str]) -> str:
    """Return a citation file in the Citation File Format 1.2."""
    document: dict[str, Any] = {
        "cff-version": "1.2.0",
        "message": "If you use this data set, please cite it, and the software that made it.",
        "type": "dataset",
        "title": title,
        "authors": [person(author) for author in about.authors or NOBODY],
        "license": about.licence,
        "date-released": about.published.isoformat(),
        "keywords": list(keywords),
        "references": [
            {
                "type": "software",
                "title": "Microcosmos",
                "version": VERSION,
                "license": "Apache-2.0",
                "authors": [{"name": "The Microcosmos authors"}],
            },
            PAPER,
        ],
    }
    return "\n".join(_lines(document)) + "\n"


NOBODY = ("The authors of this data set",)
"""Stands in the files where no author is given; Zenodo asks for names."""


def _lines(document: Mapping[str, Any], indent: str = "") -> list[str]:
    """Return YAML; a text in JSON is one of its texts."""
    found: list[str] = []
    for name, value in document.items():
        if isinstance(value, list):
            found.append(f"{indent}{name}:")
            for one in value:
                if isinstance(one, Mapping):
                    first, *rest = _lines(one, f"{indent}    ")
                    found += [f"{indent}  - {first.strip()}", *rest]
                else:
                    found.append(f"{indent}  - {_scalar(one)}")
        else:
            found.append(f"{indent}{name}: {_scalar(value)}")
    return found


def _scalar(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False)
