"""Make the renderings of a creature, with the engine or from its replay."""

import json
from collections.abc import Callable
from functools import lru_cache
from typing import Any

from microcosmos.viz.film import gif, loop, mp4, preview, strip
from microcosmos.viz.replay_file import Replay, read_replay
from microcosmos_server.renderings import storage as renderings
from microcosmos_server.services.services import Services
from microcosmos_server.tables import (
    AUDIT,
    EVALUATION,
    GIF,
    LOOP,
    MEASUREMENT,
    MP4,
    PREVIEW,
    REPLAY,
    STRIP,
)

PICTURES: dict[str, Callable[[Replay], bytes]] = {
    STRIP: strip,
    PREVIEW: preview,
    GIF: gif,
    MP4: mp4,
    LOOP: loop,
}


def make(services: Services, creature: str, kind: str) -> bytes:
    if kind in PICTURES:
        replay = renderings.existing(services, creature, REPLAY)
        if replay is None:
            replay = make(services, creature, REPLAY)
            renderings.save(services, creature, REPLAY, replay)
        return PICTURES[kind](read_replay(replay))
    file = renderings.creature(services, creature)
    if kind in (AUDIT, MEASUREMENT):
        from microcosmos.audit import audit, measurement  # Loads JAX.

        report = audit if kind == AUDIT else measurement
        return json.dumps(report(file), allow_nan=False).encode()
    if kind == EVALUATION:
        from microcosmos.audit import evaluation_inputs  # Loads JAX.

        return evaluation_inputs(file)
    if kind == REPLAY:
        from microcosmos.viz.replay import record  # Loads JAX.

        return record(file)
    known = ", ".join((REPLAY, AUDIT, MEASUREMENT, EVALUATION, *PICTURES))
    raise ValueError(f"`kind` of a rendering must be one of {known}; got {kind!r}")


def first(document: dict[str, Any], number: int) -> bytes:
    """Return the inputs of the evaluation of a creature of a spec's first generation."""
    from microcosmos.audit import evaluation_inputs  # Loads JAX.

    return evaluation_inputs(_first_generation(json.dumps(document))[number])


@lru_cache(maxsize=4)
def _first_generation(document: str) -> list[dict[str, Any]]:
    from microcosmos.build import build  # Loads JAX.
    from microcosmos.experiments.evolution import Evolution
    from microcosmos.spec import parse

    experiment = build(parse(json.loads(document)))
    assert isinstance(experiment, Evolution)
    return experiment.first_generation()
