"""Creatures that sense and collect energy, against those that only swim, or sense nothing."""

import statistics
from collections.abc import Callable

from drive import Installation
from rich.console import Console

from microcosmos.naming import decode, encode, name
from microcosmos.spec import parse

SEEDS = (0, 1, 2)
GENERATIONS, BATCH = 24, 64
SENSOR = 3
"""The CPPN's input that energy comes in by, after position, sine and cosine."""


def spec(seed: int, fitness: str) -> dict:
    """NEAT among packets of energy, which networks sense; 1 : 1 as in the paper.

    Bodies that are small beside the distance of packets, a life long enough to come to one,
    and packets elsewhere in each of four worlds: what is not sensed cannot be known.
    """
    energy = {"packets": 5, "width": 3.0, "placements": 4}
    control = {"sense_energy": True, "period": 50, "angle_scale": 0.3, "length_scale": 0.2}
    whole = {
        "experiment": "neuroevolution",
        "seed": seed,
        "world": {"width": 48, "height": 48, "energy": energy},
        "body": {"builder": "chain", "nodes": 16},
        "control": control,
        "task": {"fitness": fitness, "energy_weight": 1.0, "steps": 800},
        "search": {"generations": GENERATIONS, "batch": BATCH},
    }
    return parse(whole).model_dump(mode="json")


def forage(
    place: Installation, carry_out: Callable[[Installation, dict, str], dict], console: Console
) -> bool:
    """Whether those selected for energy collect more than the others, as medians."""
    found: dict[str, list[float]] = {"displacement+energy": [], "displacement": [], "blind": []}
    for seed in SEEDS:
        for fitness in ("displacement+energy", "displacement"):
            run = carry_out(place, spec(seed, fitness), f"{fitness}, seed {seed}")
            best = fittest(place, run["id"])
            found[fitness].append(best["measured"]["measures"]["energy"])
            if fitness == "displacement+energy":
                found["blind"].append(collected(blinded(best)))
    middle = {kind: statistics.median(values) for kind, values in found.items()}
    for kind, values in found.items():
        listed = ", ".join(f"{value:.0f}" for value in values)
        console.print(f"energy collected by {kind}: median {middle[kind]:.0f} ({listed})")
    most = middle["displacement+energy"]
    return most > middle["displacement"] and most > middle["blind"]


def fittest(place: Installation, run: str) -> dict:
    """The creature file of a run's best elite."""
    archive = place.http.get(f"/api/v1/runs/{run}/archive").raise_for_status().json()
    best = max(range(len(archive["fitness"])), key=archive["fitness"].__getitem__)
    address = f"/api/v1/creatures/{archive['creature'][best]}"
    return place.http.get(address).raise_for_status().json()


def blinded(file: dict) -> dict:
    """The same creature with no weight on what it senses."""
    identity = file["identity"]
    connections = identity["genome"]["connections"]
    weights = decode(connections["weight"]).copy()
    weights[[source == SENSOR for source in connections["source"]]] = 0.0
    genome = {**identity["genome"], "connections": {**connections, "weight": encode(weights)}}
    changed = {**identity, "genome": genome}
    return {**file, "identity": changed, "sha256": name(changed)}


def collected(file: dict) -> float:
    """The energy that a creature collects, measured anew."""
    from microcosmos.audit.reproducibility import check

    return check(file).repeated["energy"]
