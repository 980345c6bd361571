"""The base class of all parts of a spec, the declaration of fields, and sources of methods."""

from collections.abc import Callable, Mapping, Sequence
from decimal import ROUND_CEILING, Context
from functools import cache
from types import UnionType
from typing import Annotated, Any, Union, get_args, get_origin

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    model_validator,
)

from ..invalid import InvalidField, invalid_field
from ..operators import EMITTERS
from ..plugins import is_plugin

PAPER = "Tensen et al. 2026"
OURS = "ours: docs/physics.md"
NEAT = "Stanley and Miikkulainen, Evol. Comput. 10, 99 (2002)"
CPPN = "Stanley, Genet. Program. Evolvable Mach. 8, 131 (2007)"
MAP_ELITES = "Mouret and Clune, arXiv:1504.04909 (2015)"
TOURNAMENT = "tournament: Goldberg and Deb, Foundations of Genetic Algorithms 1, 69 (1991)"
CURIOSITY = "curiosity: Cully and Demiris, IEEE Trans. Evol. Comput. 22, 245 (2018)"
PHASE_LAG = "Ijspeert, Neural Networks 21, 642 (2008)"
CVT = "Vassiliades, Chatzilygeroudis and Mouret, IEEE Trans. Evol. Comput. 22, 623 (2018)"
LINE = "Vassiliades and Mouret, GECCO 2018, eq. 3"
CMA_ME = "Fontaine et al., GECCO 2020"
CMA_MAE = "Fontaine and Nikolaidis, GECCO 2023"
CMA_MEGA = "Fontaine and Nikolaidis, NeurIPS 2021, algorithm 2"
REEVALUATION = "Flageat and Cully, Artificial Life 32 (2020) and arXiv:2302.00463"
LATTICE = "D2Q9: " + PAPER
TRT = "Ginzburg, Verhaeghe and d’Humières, Commun. Comput. Phys. 3, 427 (2008)"
GUO = "Guo, Zheng and Shi, Phys. Rev. E 65, 046308 (2002), eqs. 3, 4 and 20"
FORCING = "Wang, Fan and Luo, Int. J. Multiphase Flow 34, 283 (2008)"
PBD = "Müller et al., J. Vis. Commun. Image R. 18, 109 (2007)"
RODS = "planar form of " + PAPER + "; Umetani, Schmidt and Stam, SCA 2014"
LAYERS = "Mittal and Iaccarino, Annu. Rev. Fluid Mech. 37, 239 (2005), as in " + PAPER
DELTAS = (
    "peskin: Acta Numerica 11, 479 (2002), eq. 6.27; roma: J. Comput. Phys. 153, 509 (1999), "
    "eq. 22"
)
ADAM = "Kingma and Ba, ICLR 2015, algorithm 1"
DIGITS = "Alpaydin and Kaynak, UCI (1998), doi:10.24432/C50P49"
MOME = (
    "Pierrot, Richard, Beguir and Cully, GECCO 2022, arXiv:2202.03057; crowding: Janmohamed, "
    "Pierrot and Cully, GECCO 2023, arXiv:2302.12668"
)
DOMINATED_NOVELTY = "Bahlous-Boldi et al., GECCO 2025, arXiv:2502.00593"
AURORA = "Grillotti and Cully, IEEE Trans. Evol. Comput. 26, 1539 (2022), arXiv:2106.05648"
SCREENING = "Gaier, Asteroth and Mouret, Evol. Comput. 26, 381 (2018)"
BREEDING = (
    "Picbreeder: Secretan et al., Evol. Comput. 19, 373 (2011); review: Takagi, Proc. IEEE 89, "
    "1275 (2001)"
)


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

    @model_validator(mode="before")
    @classmethod
    def refuse_no_numbers(cls, given: Any) -> Any:
        """Refuse words and truth values, which pydantic takes for numbers."""
        for name in numeric(cls) & given.keys() if isinstance(given, dict) else ():
            if isinstance(given[name], bool | str):
                kind = (
                    "integer" if int in members(cls.model_fields[name].annotation) else "number"
                )
                raise InvalidField(name, f"needs a valid {kind}; got {given[name]!r}")
        return given


@cache
def numeric(part: type[BaseModel]) -> frozenset[str]:
    """Return the fields of a part that hold one number, or perhaps none."""
    of = {name: members(one.annotation) for name, one in part.model_fields.items()}
    numbers, none = {int, float}, {type(None)}
    return frozenset(
        n for n, kinds in of.items() if kinds & numbers and kinds <= numbers | none
    )


def members(annotation: Any) -> set[Any]:
    """Return the types of a union, or the only one."""
    origin = get_origin(annotation)
    if origin is Annotated:
        return members(get_args(annotation)[0])
    if origin in (Union, UnionType):
        return set[Any]().union(*map(members, get_args(annotation)))
    return {annotation}


PERCEPTIBLE = 1e-6
"""Least size of what acts beside numbers of about 1, such as genes and angles: their spacing in
single precision is 1.2e-7, so that much less changes nothing."""


def _numeric(value: Any) -> Any:
    """Refuse what pydantic takes for a number within lists, as `Part` does for single ones."""
    if isinstance(value, bool | str):
        raise InvalidField("", f"needs a valid number; got {value!r}")
    return value


Numeric = BeforeValidator(_numeric)


def field(default: Any, *, unit: str = "", source: str = "", **limits: Any) -> Any:
    """Declare a field: its default, unit, the source of its method, and pydantic's limits."""
    extra: Any = {name: text for name, text in (("unit", unit), ("source", source)) if text}
    return Field(default=default, json_schema_extra=extra or None, **limits)


def refuse(
    condition: Any,
    field: str,
    reason: str,
    least: float | None = None,
    most: float | None = None,
) -> None:
    """Raise `InvalidField` with these arguments if a condition holds."""
    if condition:
        raise InvalidField(field, reason, least=least, most=most)


def refuse_repeated(field: str, values: Sequence[Any]) -> None:
    """Raise `InvalidField` if a field holds a value more than once."""
    refuse(len(set(values)) < len(values), field, f"must not repeat, got {list(values)}")


def enough(needed: float) -> str:
    """Return the least value that a field needs, rounded up to four digits.

    An error states it, and the field accepts what the error states.
    """
    # Rounded up: a value copied from the error must be accepted.
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
        raise InvalidField(field, f"must be one of {', '.join(known)}, got {got}")

    return Discriminator(tag), BeforeValidator(refuse_unknown)


ENCODINGS = (
    "cppn",
    "direct",
    "body-graph",
    "gait",
    "fold",
    "plugin",
)
BUILDERS = ("chain", "ring", "arc", "walk", "star", "tree", "polyline", "graph", "grown")
TAGS: dict[str, tuple[str, ...]] = {
    "body": (*BUILDERS, "known", "plugin"),
    "genome": ENCODINGS,
    "control": ENCODINGS,
    "targets": ("digit", "picture"),
    "obstacles": ("post", "wall", "pattern"),
    "container": ("fronts", "dominated-novelty", "learned"),
    "emitters": (*EMITTERS, "plugin"),
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


def invalid_fields(errors: Sequence[Mapping[str, Any]]) -> list[InvalidField]:
    """Return the `errors()` of a pydantic model as data, with paths as people write them."""
    return [invalid_field(one, field_path(one["loc"])) for one in errors]
