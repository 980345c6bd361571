"""Build the encoding of a scene."""

import numpy as np

from .. import bodies, genomes, spec
from ..spec.control import ANATOMY, NetworkInputs
from .plugins import build_act

TIMERS = {"sine-cosine": genomes.sine_cosine, "linear": genomes.linear}
LENGTHS = {"log": genomes.scaled, "raw": genomes.added}
BASES = {"fourier": genomes.fourier, "table": genomes.table}


def build_encoding(scene: spec.Scene, room: tuple[int, int]) -> genomes.Encoding:
    """Build a scene's encoding; `room` is the number of nodes and connections."""
    control, body = scene.control, spec.shape(scene.body)
    if isinstance(control, spec.Gait):
        raise ValueError("`control` must have a genome, got a hand-made gait")
    if isinstance(control, spec.Fold):
        steps, lengths = scene.task.steps, LENGTHS[control.lengths]
        return genomes.FoldEncoding(body.rest_angle, body.rest_length, steps, lengths)
    controls = build_controls(control, body, scene.task.steps)
    return _encoding(control, controls, scene.body, body, room)


def build_controls(control: spec.Controller, body: bodies.Body, steps: int) -> genomes.Controls:
    """Build a controller's inputs at all nodes and times, and the meaning of its outputs."""
    # The stroke grows from rest, so that no blow hits the fluid at the start
    # (docs/reproduction.md).
    rise = np.maximum(control.ramp * control.period, 1)
    waves = control.waves if isinstance(control, NetworkInputs) else None
    sites, path = build_sites(control, body)
    return genomes.Controls(
        sites=sites,
        timer=TIMERS[control.timer](steps, control.period),
        ramp=np.minimum(1, (np.arange(steps) + (control.ramp == 0)) / rise),
        edges=body.edges.astype(np.int32),
        joint_nodes=body.joint_nodes.astype(np.int32),
        rest_angle=body.rest_angle,
        rest_length=body.rest_length,
        angle_scale=control.angle_scale,
        length_scale=control.length_scale,
        senses=("energy",) if getattr(control, "sense_energy", False) else (),
        wave=None if waves is None else 2 * np.pi * waves * path,
    )


def build_sites(control: spec.Controller, body: bodies.Body) -> tuple[np.ndarray, np.ndarray]:
    """Return the inputs (site, node) that say where nodes are, and the path (node,), from 0 to
    1, along which waves travel."""
    unit = getattr(control, "position", "signed") == "unit"
    if not (isinstance(control, NetworkInputs) and control.anatomy):
        return (body.arc if unit else 2 * body.arc - 1)[None], body.arc
    place = bodies.anatomy(body)
    sites = np.stack([getattr(place, name) for name in ANATOMY])
    if unit:
        sites[0] = 0.5 * (1 + sites[0])
    return sites, place.distance


def _encoding(
    control: spec.Controller,
    controls: genomes.Controls,
    grown: spec.Body,
    body: bodies.Body,
    room: tuple[int, int],
) -> genomes.Encoding:
    match control:
        case spec.Control():
            return genomes.CPPNControl(controls, room, control.recurrent)
        case spec.Direct():
            reshaped = {"rest_angle", "rest_length"} & set(control.traits)
            return genomes.Direct(
                controls=controls,
                parts=control.parts(body),
                bounds=control.traits,
                basis=BASES[control.waveform],
                terms=control.terms,
                layout=bodies.layout(body) if reshaped else None,
                spread=control.spread,
                faintest=control.faintest,
            )
        case spec.PluginControl():
            act = build_act(control, controls)
            return genomes.PluginEncoding(controls, control.genes(body), act)
        case spec.BodyGraph():
            assert isinstance(grown, spec.GrownBody)
            return genomes.BodyGraphEncoding(
                controls=controls,
                room=room,
                capacity=grown.capacity,
                segments=grown.genes,
                inputs=len(control.inputs),
                waves=control.waves,
                unit=control.position == "unit",
                softest=control.softest,
            )
