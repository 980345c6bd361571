"""Initial creatures: check that they fit a spec, and take over their genes.

World, body and task are the new spec's.
"""

from collections.abc import Iterable, Mapping, Sequence
from itertools import count
from typing import Any

from ..bodies.growth import FIRST_LIMBS
from ..naming import decode, encode
from ..spec import BodyGraph, Direct, Evolution, GrownBody, PluginControl, shape
from ..spec.body import is_unavailable
from ..spec.control import Control
from ..spec.creature import CreatureError, Identity
from ..spec.creature.genomes import Connections, Nodes, Segments, check_genes

Genes = dict[str, Any]
"""The genome of a creature's identity."""

MAX_GENE_NUMBER = 2**30
"""Upper bound of the numbers of initial genes; it leaves enough numbers for the search."""


def genes_of(chosen: Evolution, files: Iterable[Mapping[str, Any]]) -> list[Genes]:
    """Return the genes of creature files, in their order, as the spec's encoding reads them.

    Raises `CreatureError`, which names the field of the spec that a creature does not fit.
    """
    genomes = [fitting(chosen, file) for file in files]
    if isinstance(chosen.control, Control | BodyGraph):
        return renumbered(genomes, len(chosen.control.inputs), len(chosen.control.outputs))
    return genomes


def fitting(chosen: Evolution, file: Mapping[str, Any]) -> Genes:
    """Return the genome of a creature file, if it fits the spec."""
    genome, who = file["identity"]["genome"], f"creature {file['sha256'][:12]}"
    control = chosen.control
    _compare("control.encoding", control.encoding, genome["encoding"], who)
    for name in ("inputs", "outputs"):
        found = list(genome.get(name, ()))
        _compare(f"control.{name}", list(getattr(control, name)), found, who)
    if isinstance(control, Control | BodyGraph):
        _refuse_large(chosen, genome, who)
        _refuse_cycles(control, genome, who)
    else:
        before = Identity.model_validate(file["identity"]).scene
        _refuse_other_parts(chosen, before, who)
    return genome


def _compare(field: str, got: Any, needed: Any, who: str, what: str = "") -> None:
    if got != needed:
        raise CreatureError(field, f"{what}{needed!r} to begin from {who}", got)


def _refuse_large(chosen: Evolution, genome: Genes, who: str) -> None:
    sizes = {
        "max_nodes": len(genome["nodes"]["id"]),
        "max_connections": len(genome["connections"]["innovation"]),
    }
    for name, needed in sizes.items():
        room = getattr(chosen.genome, name)
        if room < needed:
            raise CreatureError(f"genome.{name}", f"at least {needed}, which {who} has", room)
    if isinstance(chosen.body, GrownBody):
        try:
            Segments.model_validate(genome["plan"]).refuse_unfit(chosen.body)
        except ValueError as error:
            raise CreatureError(
                "body", f"room for the plan of {who}: {error}", "less"
            ) from error


def _refuse_cycles(control: Control | BodyGraph, genome: Genes, who: str) -> None:
    if getattr(control, "recurrent", False):
        return
    fixed = len(control.inputs), len(control.outputs)
    nodes, connections = Nodes(**genome["nodes"]), Connections(**genome["connections"])
    try:
        check_genes(*fixed, nodes, connections)
    except ValueError as error:
        needed = f"true to begin from {who}, whose network has cycles"
        raise CreatureError("control.recurrent", needed, False) from error


def _refuse_other_parts(chosen: Evolution, before: Any, who: str) -> None:
    """Raise `CreatureError` unless each gene means the same: terms, plug-in, joints, edges."""
    control, old = chosen.control, before.control
    if isinstance(control, Direct):
        _compare("control.waveform", control.waveform, old.waveform, who)
        _compare("control.terms", control.terms, old.terms, who)
        traits = sorted(control.traits), sorted(old.traits)
        _compare("control", *traits, who, "the inherited traits ")
    if isinstance(control, PluginControl):
        for name in ("source", "settings"):
            version, needed = (getattr(one.plugin, name) for one in (control, old))
            _compare(f"control.plugin.{name}", version, needed, who)
    if is_unavailable(chosen.body):  # A worker that can build it checks it.
        return
    now, then = shape(chosen.body), shape(before.body)
    for name in ("joints", "edges"):
        needed, found = len(getattr(then, name)), len(getattr(now, name))
        _compare("body", found, needed, who, f"as many {name} as ")


def renumbered(genomes: Sequence[Genes], inputs: int, outputs: int) -> list[Genes]:
    """Return genomes in which each number stands for one connection.

    Genomes whose numbers agree keep them. A genome that gives a known number other ends belongs
    to another family, whose numbers are shifted.
    """
    fixed = inputs + outputs
    step = max(fixed + 1, inputs * outputs + 1, *counters(genomes))
    # The genes of newcomers: see `genomes.cppn.minimal`.
    plain = {i: (i % inputs, inputs + i // inputs) for i in range(inputs * outputs)}
    families: list[dict[int, tuple[int, int]]] = [dict(plain)]
    found = []
    for genome in genomes:
        for family in count():
            shifted = _shifted(genome, family * step, fixed, plain)
            ends = _ends(shifted)
            if family == len(families):
                families.append(dict(plain))
            known = families[family]
            if all(known.get(number, pair) == pair for number, pair in ends.items()):
                known.update(ends)
                found.append(shifted)
                break
    if step * len(families) >= MAX_GENE_NUMBER:
        limit = MAX_GENE_NUMBER // len(families)
        needed = f"creatures whose genes have numbers below {limit:,}"
        raise CreatureError("search.initial", needed, step - 1)
    return found


def counters(genomes: Sequence[Genes]) -> tuple[int, int, int]:
    """Return the first unused number of a connection, of a node and of a segment."""
    connections = [n for genome in genomes for n in genome["connections"]["innovation"]]
    nodes = [n for genome in genomes for n in genome["nodes"]["id"]]
    segments = [n for genome in genomes for n in genome.get("plan", {}).get("number", ())]
    first, second, third = (max(n, default=-1) + 1 for n in (connections, nodes, segments))
    return first, second, third


def _ends(genome: Genes) -> dict[int, tuple[int, int]]:
    genes = genome["connections"]
    pairs = zip(genes["source"], genes["target"], strict=True)
    return dict(zip(genes["innovation"], pairs, strict=True))


def _shifted(genome: Genes, by: int, fixed: int, plain: dict[int, tuple[int, int]]) -> Genes:
    ends = _ends(genome)

    def node(number: int) -> int:
        return number + by if number >= fixed else number

    def connection(number: int) -> int:
        # A newcomer's gene keeps its number.
        return number if plain.get(number) == ends[number] else number + by

    nodes, genes = genome["nodes"], genome["connections"]
    numbers = [connection(number) for number in genes["innovation"]]
    order = sorted(range(len(numbers)), key=numbers.__getitem__)
    plan = {}
    if "plan" in genome:
        shifted = [n + by if n > FIRST_LIMBS else n for n in genome["plan"]["number"]]
        plan = {"plan": {**genome["plan"], "number": shifted}}
    return {
        **genome,
        **plan,
        "nodes": {**nodes, "id": [node(number) for number in nodes["id"]]},
        "connections": {
            "innovation": sorted(numbers),
            "source": [node(genes["source"][i]) for i in order],
            "target": [node(genes["target"][i]) for i in order],
            "enabled": [genes["enabled"][i] for i in order],
            "weight": encode(decode(genes["weight"])[order]),
        },
    }
