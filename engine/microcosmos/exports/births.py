"""The phylogeny of a run, from the lineage in its file."""

import json

from ..archive.phylogeny import (
    NONE,
    Birth,
    Phylogeny,
    alife_csv,
    births_of,
    entries,
    newick,
    phylogeny,
)
from .run_file import RunFile, hexes


def of_file(run: RunFile) -> Phylogeny:
    """Return all creatures that ever entered a run's archive, below its initial creatures.

    Raises `ValueError` for a run without an archive. A creature is lost when another takes its
    cell. The file does not tell when a container gave up a creature: there the last generation
    stands.
    """
    present = set(hexes(run.archive()["creature"]))
    rows = run.tree["lineage"]
    creatures, words = hexes(rows["creature"]), json.loads(run.attributes["operators"])
    operators = [words[number] for number in rows["operator"]]
    numbers = (rows[name].tolist() for name in ("cell", "generation"))
    columns = (*numbers, creatures, rows["fitness"].tolist(), operators)
    entered = sorted(zip(*columns, strict=True), key=lambda row: row[:2])
    links: dict[str, list[str]] = {}
    for name, parents in zip(creatures, rows["parents"], strict=True):
        links.setdefault(name, [bytes(one).hex() for one in parents if one.any()])

    def held(creature: str) -> int | None:
        return None if creature in present else run.generation

    known = list(births_of(entries(run.name, entered, held), links))
    initial = hexes(run.tree["initial"]["creature"]) if "initial" in run.tree else []
    mine = {birth.creature for birth in known}
    first = [Birth(name, (), None, NONE, NONE, None, None) for name in initial]
    first = [birth for birth in first if birth.creature not in mine]
    return phylogeny([*first, *known], [run.name], [(run.name, name) for name in initial])


FORMS = {"csv": alife_csv, "nwk": newick}
"""The ALife phylogeny standard and Newick, by the ending of their files."""


def written(run: RunFile, ending: str) -> bytes:
    """Return the phylogeny in a form: that of the run's server, or of its file alone."""
    if ending in run.trees:
        return run.trees[ending]
    return FORMS[ending](of_file(run)).encode()
