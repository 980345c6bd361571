"""Scenes of few cells and steps that together use every part and field of a spec's scene."""

from collections.abc import Collection, Iterator
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from microcosmos import spec
from microcosmos.spec.evolution import UNLIMITED

BOX = {"width": 20, "height": 18}
ENERGY = {"packets": 3, "width": 3.0, "amplitude": 2.0, "seed": 1}
CONSUMED = ENERGY | {"consume": True, "rate": 0.3, "diffusion": 0.1}
TRAITS = {
    "rest_angle": {"low": -0.2, "high": 0.3},
    "rest_length": {"low": 0.8, "high": 1.2},
    "stretch": {"low": 0.4, "high": 0.9},
    "shear": {"low": 0.2, "high": 0.9},
    "bend": {"low": 0.3, "high": 0.8},
}
OBSTACLES = [
    {"kind": "post", "x": 1, "y": 2, "radius": 1.5},
    {"kind": "wall", "x0": 18, "y0": 4, "x1": 18, "y1": 10, "thickness": 2},
    {"kind": "pattern", "rows": "....#/...../...../...../....."},
]
VORTICES = {"kind": "vortices", "speed": 0.02, "vortices": 4}
POINTS = [[0, 0], [3, 0], [3, 3], [0, 3]]
CROSS = {
    "nodes": [[0, 0], [1, 0], [2, 0.3], [1, 1], [1, 2]],
    "edges": [[0, 1], [1, 2], [1, 3], [3, 4]],
}


def scene(control: dict[str, Any], task: dict[str, Any] | None = None, **parts: Any) -> dict:
    """A scene; `box` is what its world has beside its size."""
    box = BOX | parts.pop("box", {})
    timed = control if "period" in control or "lengths" in control else control | {"period": 8}
    return {"world": box, "control": timed, "task": {"steps": 30} | (task or {}), **parts}


def gait(swimmer: str, **options: Any) -> dict[str, Any]:
    """The scene of a hand-made gait."""
    control = {"swimmer": swimmer, "period": 20} | options
    task = {"steps": 30, "fitness": "displacement"}
    world = {"width": 44, "height": 42, "viscosity": 0.5}
    return {"world": world, "body": {"builder": swimmer}, "control": control, "task": task}


CASES: dict[str, dict[str, Any]] = {
    "a network": scene(
        {"max_speed": None}, box={"steric": {"smoothing": "gaussian"}}, body={"nodes": 8}
    ),
    "a network that senses": scene(
        {"sense_energy": True, "position": "unit", "ramp": 0.5, **UNLIMITED},
        {"fitness": "energy"},
        box={"energy": ENERGY, "viscosity": 0.2},
        body={"builder": "arc", "nodes": 9, "gap": 0.4, "spacing": 0.9},
        coupling={"kernel": "peskin", "layers": 2},
    ),
    "a network in linear time, the paper's form": scene(
        {"timer": "linear", "angle_scale": 0.3, "length_scale": 0.2},
        {"fitness": "displacement", "steps": 25},
        box={"magic": "fixed"},
        body={"builder": "walk", "nodes": 14, "spacing": 0.5, "deviation": 0.2, "seed": 4},
        coupling={
            "projection": "none",
            "theta_feedback": 0,
            "force_factor": 1,
            "forcing_iterations": 1,
            "constraint_iterations": 4,
            "limits": False,
        },
    ),
    "a recurrent network": scene(
        {"recurrent": True, "wave_number": None, "max_speed": 0.04, "lag": 3, "max_bend": 1.0},
        box={"steric": {"smoothing": "binomial", "strength": 2.0, "limit": 0.05}},
        body={"builder": "ring", "nodes": 12, "stretch": 0.9, "shear": 0.7, "bend": 0.5},
        coupling={"kernel": "hat", "constraint_iterations": 3},
    ),
    "a recurrent network that senses, in several worlds": scene(
        {"recurrent": True, "sense_energy": True, "wave_number": 0.5, "anatomy": True},
        {"fitness": "displacement+energy", "energy_weight": 0.1},
        box={"energy": CONSUMED | {"placements": 2}},
        body={"builder": "star", "arms": 3, "arm_nodes": 3},
    ),
    "genes of waves and of the body": scene(
        {"encoding": "direct", "terms": 3, "spread": 0.5, "faintest": 0.2} | TRAITS,
        {"fitness": "cost_of_transport", "trials": 2},
        body={
            "builder": "tree",
            "levels": 2,
            "branches": 3,
            "segment_nodes": 3,
            "angle": 1.2,
        },
    ),
    "upstream in a channel": scene(
        {},
        {"fitness": "upstream"},
        box={"flow": {"speed": 0.02}},
        body={"nodes": 8},
    ),
    "through obstacles, among vortices": scene(
        {},
        {"fitness": "through", "trials": 2},
        box={"width": 36, "height": 34, "flow": VORTICES, "obstacles": OBSTACLES},
        body={"nodes": 8},
    ),
    "in a shear": scene({}, box={"flow": {"kind": "shear"}}, body={"nodes": 8}),
    "a row": scene({}, box={"copies": {"arrangement": "row", "spacing": 9}}, body={"nodes": 6}),
    "a grid": scene(
        {},
        box={"copies": {"count": 3, "arrangement": "grid", "spacing": 8}},
        body={"nodes": 5},
    ),
    "a column": scene({}, box={"copies": {"count": 3, "spacing": 5}}, body={"nodes": 8}),
    "tables of genes without fluid": scene(
        {"encoding": "direct", "waveform": "table", "timer": "linear"},
        {"fitness": "displacement"},
        box={"fluid": False, "steric": {"smoothing": "binomial"}},
        body={"builder": "polyline", "points": POINTS, "closed": True},
        coupling={"nu_c": 0.1, "projection": "force"},
    ),
    "a cross, held within limits": scene(
        {},
        {"trials": 2},
        body={"builder": "graph", **CROSS},
        coupling={"max_displacement": 0.05, "max_force": 0.02},
    ),
    "an open line": scene({}, body={"builder": "polyline", "points": POINTS}),
    "a body from a plan": scene(
        {"encoding": "body-graph", "softest": 0.2},
        body={"builder": "grown", "nodes": 14, "length": 9.0, "segments": 4, "rings": 2}
        | {"segment_nodes": 15, "copies": 3, "limbs": 5, "spacing": 0.9},
    ),
    "a body from a plan that senses": scene(
        {"encoding": "body-graph", "sense_energy": True},
        box={"energy": ENERGY},
        body={"builder": "grown", "nodes": 14, "length": 9.0, "segments": 4},
    ),
    "plug-ins": scene(
        {"encoding": "movers.pulse"},
        {"fitness": "movers.way"},
        body={"builder": "movers.stick"},
    ),
    "a rest shape": scene(
        {"encoding": "fold", "lengths": "log"}, {"fitness": "displacement"}, body={"nodes": 10}
    ),
    "a rest shape in cells": scene(
        {"encoding": "fold", "lengths": "raw"}, {"fitness": "displacement"}, body={"nodes": 10}
    ),
    "a gait": gait("worm", ramp=0.5),
    "a gait of a plug-in": gait("movers.wriggler"),
    **{f"the {name}": gait(name) for name in ("tadpole", "ray", "cilia", "jellyfish")},
}
"""Documents of scenes. The plug-ins are those of `movers.py`."""

QUICK = ("a network that senses", "a gait")
"""Cases of the quick tests."""

ANOTHER = object()
"""Any number or text but the default."""


def parts_of(value: Any) -> Iterator[spec.Part]:
    """Yield a part and all parts within it."""
    if isinstance(value, spec.Part):
        yield value
        value = [getattr(value, name) for name in type(value).model_fields]
    if isinstance(value, dict):
        value = list(value.values())
    if isinstance(value, list | tuple):
        for one in value:
            yield from parts_of(one)


def alternatives(annotation: Any) -> Iterator[Any]:
    """Yield what a field may hold: choices, None, classes of parts, and `ANOTHER`."""
    origin, arguments = get_origin(annotation), get_args(annotation)
    if origin is Annotated:
        yield from alternatives(arguments[0])
    elif origin in (Union, UnionType):
        for one in arguments:
            yield from alternatives(one)
    elif origin is Literal:
        yield from arguments
    elif annotation is bool:
        yield from (True, False)
    elif annotation is NoneType:
        yield None
    elif isinstance(annotation, type) and issubclass(annotation, spec.Part):
        yield annotation
    else:
        yield ANOTHER


def is_held(alternative: Any, value: Any, default: Any) -> bool:
    """Return whether the value of a field is this alternative."""
    if alternative is ANOTHER:
        return value is not None and value != default
    if isinstance(alternative, type):
        return isinstance(value, alternative)
    return type(value) is type(alternative) and value == alternative


def owner(part: type[spec.Part], name: str) -> str:
    """Return the class that declares a field of a part."""
    return next(one.__name__ for one in part.__mro__ if name in one.__annotations__)


def fields_of(part: type[spec.Part]) -> Iterator[tuple[str, Any]]:
    """Yield the path and an alternative of each field of a part and of parts within it."""
    for name, field in part.model_fields.items():
        for one in alternatives(field.annotation):
            yield f"{owner(part, name)}.{name}", one
            if isinstance(one, type):
                yield from fields_of(one)


def held_in(scenes: list[spec.Scene]) -> set[tuple[str, Any]]:
    """Return the paths of fields with the alternatives that scenes hold."""
    return {
        (f"{owner(type(part), name)}.{name}", one)
        for whole in scenes
        for part in parts_of(whole)
        for name, field in type(part).model_fields.items()
        for one in alternatives(field.annotation)
        if is_held(one, getattr(part, name), field.default)
    }


def lacking_in(scenes: list[spec.Scene], unused: Collection[str]) -> set[str]:
    """Return the choices of fields that no scene holds, but for fields that are `unused`."""
    choices = set(fields_of(spec.Scene))
    assert set(unused) <= {field for field, _ in choices}
    return {
        f"{field}: {choice}"
        for field, choice in choices - held_in(scenes)
        if field not in unused
    }
