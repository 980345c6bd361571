"""The base class of all parts of a spec, and the declaration of their fields."""

from collections.abc import Callable, Mapping, Sequence
from decimal import ROUND_CEILING, Context
from typing import Annotated, Any

from pydantic import BaseModel, BeforeValidator, ConfigDict, Discriminator, Field
from pydantic_core import PydanticCustomError

from ..plugins import is_plugin

Digest = Annotated[str, Field(pattern="^[0-9a-f]{64}$")]
"""A SHA-256 in hexadecimal."""


class Part(BaseModel):
    """A frozen part of a spec; unknown fields, NaN and infinities are refused."""

    model_config = ConfigDict(
        extra="forbid",
        frozen=True,
        allow_inf_nan=False,
        use_attribute_docstrings=True,
        validate_default=True,
    )


def field(default: Any, *, unit: str = "", source: str = "", **limits: Any) -> Any:
    """Declare a field: its default, unit, the source of its method, and pydantic's limits."""
    extra: Any = {name: text for name, text in (("unit", unit), ("source", source)) if text}
    return Field(default=default, json_schema_extra=extra or None, **limits)


def enough(needed: float) -> str:
    """Return the least value that a field needs, rounded up to four digits.

    An error states it, and the field accepts what the error states.
    """
    digits = Context(prec=4, rounding=ROUND_CEILING).create_decimal_from_float(needed)
    return f"{digits.normalize():f}"


def sourced(source: str, **marks: bool) -> ConfigDict:
    """Configure a part with its source; a form shows a part with the mark `seldom` closed."""
    return ConfigDict(json_schema_extra={**marks, "source": source})


def name_in(field: str, default: str | None = None) -> Callable[[Any], Any]:
    """Return a function that reads `field` of a part or of its document."""
    return lambda part: (
        part.get(field, default) if isinstance(part, dict) else getattr(part, field, None)
    )


def one_of(
    field: str,
    known: Sequence[str],
    name_of: Callable[[Any], Any],
    tags: Mapping[str, str] | None = None,
) -> tuple[Any, ...]:
    """Return annotations of a union whose parts have names in `field`; refuse unknown names.

    The tag of a part is its name, "plugin" for the name of a plug-in, or that in `tags`.
    """

    def tag(part: Any) -> Any:
        name = name_of(part)
        return "plugin" if is_plugin(name) else (tags or {}).get(name, name)

    def refuse_unknown(part: Any) -> Any:
        name = name_of(part)
        if name in known or is_plugin(name):
            return part
        got = f"{part if name is None else name!r:.80}"
        context = {"field": field, "known": ", ".join(known), "got": got}
        message = "`{field}` must be one of {known}, got {got}"
        raise PydanticCustomError("unknown_name", message, context)

    return Discriminator(tag), BeforeValidator(refuse_unknown)


ENCODINGS = (
    "cppn",
    "direct",
    "weights",
    "cppn-body",
    "body-graph",
    "gait",
    "fold",
    "plugin",
)
BUILDERS = ("chain", "ring", "arc", "walk", "star", "tree", "polyline", "graph", "grown")
NETWORK_OPERATORS = ("neat", "population", "lamarckian")
VECTOR_OPERATORS = ("iso+line", "gaussian", "cma-mae", "cma-me", "cma-mega")
TAGS: dict[str, tuple[str, ...]] = {
    "body": (*BUILDERS, "known", "plugin"),
    "genome": ENCODINGS,
    "control": ENCODINGS,
    "targets": ("digit", "picture"),
    "obstacles": ("post", "wall", "pattern"),
    "container": ("fronts", "dominated-novelty", "learned"),
    "emitters": ("random", *NETWORK_OPERATORS, *VECTOR_OPERATORS),
}
"""The tags of union fields, which pydantic adds to the paths of errors."""


def field_path(location: Sequence[str | int]) -> str:
    """Return the path of pydantic's error location as people write it, without tags."""
    path, owner = [], ""
    for part in location:
        if part not in TAGS.get(owner, ()):
            path.append(str(part))
            owner = part if isinstance(part, str) else owner
    return ".".join(path)
