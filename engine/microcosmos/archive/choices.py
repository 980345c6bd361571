"""Files of choices: creatures that people chose in a run, and when each began to count."""

from collections.abc import Iterable, Mapping
from typing import Any

from pydantic import Field, ValidationError

from ..spec.base import Digest, Part, invalid_fields
from ..spec.creature import CreatureError
from .creature import decoded
from .creature import parse as parse_creature

Files = list[dict[str, Any]]
"""Creature files."""


class Choice(Part):
    """A creature, and the generation from which it counts."""

    generation: int = Field(ge=2, lt=2**31)
    creature: Digest


class Document(Part):
    choices: tuple[Choice, ...]
    creatures: tuple[dict[str, Any], ...]
    """The file of each chosen creature."""


def document(
    rows: Iterable[tuple[int, str]], files: Iterable[Mapping[str, Any]]
) -> dict[str, Any]:
    """Return the file of choices, given by generation and name, with their creature files."""
    choices = [{"generation": number, "creature": name} for number, name in sorted(rows)]
    return {"choices": choices, "creatures": list(files)}


def parse(data: bytes) -> dict[int, Files]:
    """Return the creature files of each generation with choices.

    Raises `ValueError`, which names the field, what was needed and what came.
    """
    try:
        found = Document.model_validate(decoded(data))
    except ValidationError as error:
        found = invalid_fields(error.errors())[0]
        needed = found.needed or found.reason
        raise CreatureError(found.field or "file", needed, found.got, found.reason) from None
    files: dict[str, dict[str, Any]] = {}
    for place, one in enumerate(found.creatures):
        try:
            file = parse_creature(one)
        except CreatureError as error:
            raise error.within(f"creatures.{place}") from error
        if file["sha256"] in files:  # Two files of a creature may differ in all but its genes.
            raise CreatureError(f"creatures.{place}", "each creature once", file["sha256"])
        files[file["sha256"]] = file
    chosen: dict[int, Files] = {}
    for choice in sorted(set(found.choices), key=lambda one: (one.generation, one.creature)):
        if choice.creature not in files:
            raise CreatureError("creatures", "the file of each choice", choice.creature)
        chosen.setdefault(choice.generation, []).append(files[choice.creature])
    return chosen
