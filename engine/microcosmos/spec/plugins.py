"""What a spec says of something of one's own: which version, and with which settings."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import Field, PlainSerializer, ValidationInfo, WrapValidator
from pydantic.json_schema import SkipJsonSchema

from .. import plugins
from ..plugins import Known, is_own
from .base import Part

CONTEXT = "own"
"""Where `parse` is told whom to ask for versions; else it is what this process has loaded."""


class Own(Part):
    """A version of something of one's own; all but the settings follows from its name."""

    source: Annotated[str, Field(pattern="^[0-9a-f]{64}$")]
    """SHA-256 of its module's source."""
    title: Annotated[str, Field(min_length=1, max_length=100)]
    """What people call it."""
    unit: Annotated[str, Field(max_length=40)] = ""
    """That of a measure."""
    sizes: dict[str, Annotated[int, Field(ge=0, le=65_536)]] = Field(default={})
    """What a body or an encoding needs room for."""
    settings: dict[str, Any] = Field(default={})
    """Those that it declares."""


def _built_in_or_own(value: Any, built_in: Any) -> Any:
    return value if is_own(value) else built_in(value)


# The schema stays that of the words that are built in: whoever knows more adds to it.
OR_OWN = (WrapValidator(_built_in_or_own), PlainSerializer(str, return_type=str))
"""Makes a choice of words one that takes names of one's own as well."""

OwnName = Annotated[str, Field(pattern=rf"^{plugins.declaration.FULL_NAME.pattern}$")]


def left_out() -> Any:
    """A field that is not written where there is nothing of one's own."""
    return Field(default=None, exclude_if=lambda value: not value)


MaybeOwn = SkipJsonSchema[Own | None]
"""In no schema: it comes with names that are not in it either."""


def version(
    kinds: tuple[str, ...], field: str, name: str, own: Any, info: ValidationInfo
) -> tuple[Any, plugins.Declaration | None]:
    """What there is to be said of a name of one's own, and its declaration if it is known.

    A version that a spec already names is believed where it is not known: files must stay
    readable where nobody can carry them out.
    """
    if isinstance(own, Own):
        own = own.model_dump()
    given: Mapping[str, Any] = own if isinstance(own, Mapping) else {}
    if own is not None and given is not own:
        raise ValueError(f"`own` must be an object with `settings`, got {own!r:.80}")
    known: Known = (info.context or {}).get(CONTEXT, plugins.LOADED)
    found = [one for kind in kinds for one in known.versions(kind, name)]
    source = given.get("source")
    declared = next((one for one in found if source in (None, one.source)), None)
    if declared is None and source is None:
        raise ValueError(
            f"`{field}` must be known, got {name!r}: {known.nobody(kinds[0], name)}"
        )
    if declared is None:
        return own, None
    settings = given.get("settings") or {}
    if not isinstance(settings, Mapping):
        raise ValueError(f"`own.settings` must be an object, got {settings!r:.80}")
    told = {
        "source": declared.source,
        "title": declared.title,
        "unit": declared.unit,
        "sizes": dict(declared.sizes),
        "settings": known.settings(declared, settings),
    }
    return told, declared


def completed(
    given: Any, kinds: tuple[str, ...], field: str, info: ValidationInfo
) -> tuple[Any, plugins.Declaration | None]:
    """A part whose `field` may name something of one's own, with the version that it means."""
    if not isinstance(given, dict):
        return given, None
    name, own = given.get(field), given.get("own")
    if is_own(name):
        told, declared = version(kinds, field, str(name), own, info)
        return {**given, "own": told}, declared
    if isinstance(own, Own) or (isinstance(own, Mapping) and "source" in own):
        # A spec that was complete got another word: what belonged to the one before goes.
        return {key: value for key, value in given.items() if key != "own"}, None
    if own is not None:
        raise ValueError(f"`own` must be left out where `{field}` is {name!r}, got some")
    return given, None


@dataclass(frozen=True)
class Used:
    """Something of one's own that a document names."""

    path: str
    """Of the field with its name."""
    name: str
    own: Own


NAMING = ("fitness", "name", "builder", "encoding", "swimmer")
"""Fields that hold names of one's own."""


def used(document: Any, path: str = "") -> Iterator[Used]:
    """Everything of one's own in a spec or a creature file, as JSON has them."""
    if isinstance(document, list):
        for number, part in enumerate(document):
            yield from used(part, f"{path}{number}.")
    if not isinstance(document, dict):
        return
    own = document.get("own")
    if isinstance(own, dict):
        yield from _versions(document, own, path)
    for name, part in document.items():
        if name != "own":
            yield from used(part, f"{path}{name}.")


def _versions(document: Mapping[str, Any], own: Mapping[str, Any], path: str) -> Iterator[Used]:
    """Of the field beside it, or of names by which there are several."""
    for field in NAMING:
        if is_own(document.get(field)):
            yield Used(f"{path}{field}", str(document[field]), Own.model_validate(own))
            return
    for name, version in own.items():
        if is_own(name):
            yield Used(f"{path}own", name, Own.model_validate(version))
