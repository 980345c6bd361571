"""Species of a population over the generations, as its search told them."""

from typing import Any
from uuid import UUID

from sqlalchemy import select
from sqlalchemy.orm import Session

from ..tables import Generation


def history(session: Session, run_id: UUID, wanted: list[int]) -> dict[str, list[Any]]:
    """For each of the wanted generations that tells any: numbers of species, their members."""
    mine = (Generation.run_id == run_id) & Generation.generation.in_(wanted)
    rows = select(Generation.generation, Generation.summary).where(mine)
    columns: dict[str, list[Any]] = {"generation": [], "number": [], "members": []}
    for generation, summary in session.execute(rows.order_by(Generation.generation)):
        told = (summary or {}).get("species")
        if isinstance(told, str):
            pairs = [pair.partition(":") for pair in told.split()]
            columns["generation"].append(generation)
            columns["number"].append([int(number) for number, _, _ in pairs])
            columns["members"].append([int(members) for _, _, members in pairs])
    return columns
