"""How each rendering of a creature is made: the engine makes it, or it is drawn of a replay."""

import json
from collections.abc import Callable

from microcosmos import render
from microcosmos.render.movie import gif, mp4
from microcosmos.render.preview import preview
from microcosmos.render.reading import Replay, read_replay
from microcosmos.render.strip import strip
from server import renderings
from server.models import AUDIT, GIF, MEASUREMENT, MP4, PREVIEW, REPLAY, STRIP
from server.services import Services

PICTURES: dict[str, Callable[[Replay], bytes]] = {
    STRIP: strip,
    PREVIEW: preview,
    GIF: gif,
    MP4: mp4,
}


def make(services: Services, creature: str, kind: str) -> bytes:
    """The bytes of one rendering."""
    if kind in PICTURES:
        return PICTURES[kind](read_replay(_replay(services, creature)))
    file = renderings.creature(services, creature)
    if kind == AUDIT:
        return json.dumps(render.audit(file), allow_nan=False).encode()
    if kind == MEASUREMENT:
        return json.dumps(render.measurement(file), allow_nan=False).encode()
    if kind == REPLAY:
        return render.record(file)
    known = ", ".join((REPLAY, AUDIT, MEASUREMENT, *PICTURES))
    raise ValueError(f"`kind` of a rendering must be one of {known}; got {kind!r}")


def _replay(services: Services, creature: str) -> bytes:
    """The replay that is kept, made first if need be."""
    data = renderings.kept(services, creature, REPLAY)
    if data is None:
        data = render.record(renderings.creature(services, creature))
        renderings.save(services, creature, REPLAY, data)
    return data
