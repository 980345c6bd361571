"""The file of a study, as YAML or JSON, parsed strictly; errors name the field."""

import re
from collections.abc import Sequence
from math import inf
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import Field, StrictInt, ValidationError, field_validator, model_validator

from ..invalid import InvalidField, invalid_field
from ..json_text import read_json, refuse_repeated
from ..optional import require
from ..spec.base import Part, field_path
from ..statistics.effects import MAX_RESAMPLES
from ..statistics.measures import DEFAULT, Measure

Name = Annotated[str, Field(min_length=1, max_length=60, pattern=r"^[A-Za-z0-9][\w .+-]*$")]
Export = Literal["csv", "json", "latex", "archive-csv", "poses-npz"]
MAX_RUNS = 1000
MAX_NODES = 100_000
"""Most values of a study in YAML, those of an alias wherever it stands."""


class Sweep(Part):
    """Runs of a spec: every combination of the grid's values with every seed."""

    spec: str | dict[str, Any] = "demo"
    """The name of a preset, a file with a spec beside the study's, or the spec itself."""
    set: dict[str, Any] = Field(default={}, max_length=50)
    """Values by the dotted path of a field, as `search.generations`."""
    grid: dict[str, Annotated[list[Any], Field(min_length=1)]] = Field(
        default={}, max_length=16
    )
    """Lists of values by the dotted path of a field."""
    seeds: (
        Annotated[StrictInt, Field(ge=1, le=MAX_RUNS)]
        | Annotated[list[StrictInt], Field(min_length=1)]
    ) = 5
    """A number of seeds, which starts with the spec's own, or a list of seeds."""

    @field_validator("seeds")
    @classmethod
    def refuse_twice(cls, seeds: int | list[int]) -> int | list[int]:
        if isinstance(seeds, list) and len(set(seeds)) < len(seeds):
            twice = next(one for one in seeds if seeds.count(one) > 1)
            raise ValueError(f"needs seeds that differ, got {twice} twice")
        return seeds


class Selection(Part):
    """Cases of a sweep as one group."""

    sweep: str
    where: dict[str, Any] = Field(default={})
    """Values that the cases have, by paths of the grid."""


class Comparison(Part):
    """Groups of runs, and the measures in which they are compared."""

    groups: Annotated[list[str], Field(min_length=1)] | dict[Name, Selection]
    """Names of sweeps, whose cases are groups; or groups by name."""
    measures: tuple[str, ...] = Field(default=DEFAULT, min_length=1)
    """Curves (`qd_score`), curves after evaluations (`qd_score@6400`), or evaluations to a
    value (`best>=0.5`)."""
    tasks: tuple[str, ...] = ()
    """Fields of the spec that tell tasks apart: aggregates over them, in place of tests."""

    @field_validator("measures")
    @classmethod
    def refuse_unknown(cls, measures: tuple[str, ...]) -> tuple[str, ...]:
        for text in measures:
            try:
                Measure.parse(text)
            except InvalidField as error:  # The path of this field names it.
                raise ValueError(error.reason) from error
        return measures


class Figure(Part):
    """A figure of a comparison."""

    kind: Literal["curves", "box", "parameter", "profile", "creatures", "sheet"]
    """`creatures`: a stroke of the fittest of each group; `sheet`: gaits of the fittest run."""
    of: str = ""
    """The comparison; needed where there are several."""
    field: str = ""
    """For `parameter`: the field of the spec."""
    shown: Annotated[tuple[str, ...], Field(min_length=1)] = ("best", "coverage", "qd_score")
    """For `curves`: the curves."""

    @model_validator(mode="after")
    def refuse_without_field(self) -> Self:
        if (self.kind == "parameter") != bool(self.field):
            needed = "is needed by" if self.kind == "parameter" else "must be empty for"
            raise InvalidField("field", f"{needed} a figure `{self.kind}`, got {self.field!r}")
        return self


class Study(Part):
    """Sweeps, and what is made of them."""

    title: Annotated[str, Field(min_length=1, max_length=200)]
    about: str = ""
    """Paragraphs for the head of the report."""
    sweeps: dict[Name, Sweep] = Field(min_length=1)
    comparisons: dict[Name, Comparison] = Field(min_length=1)
    figures: tuple[Figure, ...] = ()
    exports: tuple[Export, ...] = ()
    resamples: StrictInt = Field(default=9999, ge=99, le=MAX_RESAMPLES)
    """Resamples of the bootstrap, whose seed is 0."""

    @model_validator(mode="after")
    def refuse_one_file_of_two(self) -> Self:
        """Raise `ValueError` where exports of two comparisons would be one file."""
        files: dict[str, str] = {}
        for name in self.comparisons:
            other = files.setdefault(file_of(name), name)
            if other != name:
                raise InvalidField(
                    "comparisons",
                    "needs names of different files, got "
                    f"{other!r} and {name!r}, which are both {file_of(name)!r}",
                )
        return self

    @model_validator(mode="after")
    def refuse_unknown_names(self) -> Self:
        for name, one in self.comparisons.items():
            groups = one.groups
            used = groups if isinstance(groups, list) else [x.sweep for x in groups.values()]
            for sweep in used:
                _refuse_unknown(f"comparisons.{name}.groups", sweep, self.sweeps)
        for number, figure in enumerate(self.figures):
            if figure.of:
                _refuse_unknown(f"figures.{number}.of", figure.of, self.comparisons)
            elif len(self.comparisons) > 1:
                needed = ", ".join(self.comparisons)
                raise InvalidField(f"figures.{number}.of", f"must be one of {needed}, got none")
            self._refuse_aggregate(number, figure)
        return self

    def _refuse_aggregate(self, number: int, figure: Figure) -> None:
        """Raise `ValueError` where a figure needs tasks, or is of a comparison with tasks."""
        tasks = self.comparison_of(figure)[1].tasks
        if figure.kind == "profile" and not tasks:
            needed = "with `tasks` for a figure `profile`"
            raise InvalidField(f"figures.{number}", f"needs a comparison {needed}")
        # Over tasks, a median of curves would be neither over seeds nor over equal scales.
        if figure.kind in ("curves", "box", "parameter") and tasks:
            needed = f"without `tasks` for a figure `{figure.kind}`"
            raise InvalidField(f"figures.{number}", f"needs a comparison {needed}")

    def comparison_of(self, figure: Figure) -> tuple[str, Comparison]:
        """Return the name of a figure's comparison, and the comparison."""
        name = figure.of or next(iter(self.comparisons))
        return name, self.comparisons[name]


def file_of(comparison: str) -> str:
    """Return the name of a comparison's files, without their ending."""
    return comparison.replace(" ", "-")


def _refuse_unknown(field: str, name: str, known: Any) -> None:
    if name not in known:
        raise InvalidField(field, f"must be one of {', '.join(known)}, got {name!r}")


def read(path: Path) -> Study:
    """Return the study in a file. Raises `ValueError`, which names the fields that are wrong,
    and `ImportError` where YAML needs the extra `studies`."""
    return decode(path.read_bytes(), path.name)


def decode(data: bytes, name: str) -> Study:
    """Return the study in the bytes of a file with this name; see `read`."""
    try:
        text = data.decode()
    except UnicodeDecodeError:
        raise ValueError("a study must be a text in UTF-8, YAML or JSON; got other") from None
    return parse(text, name.lower().endswith(".json"))


def parse(text: str, is_json: bool = False) -> Study:
    """Return the study in a text; see `read`."""
    try:
        return Study.model_validate(read_json(text) if is_json else yaml(text))
    except ValidationError as error:
        invalid = (invalid_field(one, _path(one["loc"])) for one in error.errors())
        raise ValueError("\n".join(map(str, invalid))) from error


def _path(location: Sequence[str | int]) -> str:
    return field_path([part for part in location if not _is_tag(part)])


def _is_tag(part: Any) -> bool:
    """Return whether pydantic added a part of a path, to tell the members of a union apart."""
    # Pydantic names the members of a union in the path of an error, which people did not write.
    text = str(part)
    return "[" in text or text in ("int", "str", "constrained-int")


SCALARS = {
    "null": r"~|null|Null|NULL|",
    "bool": r"true|True|TRUE|false|False|FALSE",
    "int": r"[-+]?[0-9]+|0o[0-7]+|0x[0-9a-fA-F]+",
    "float": r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?"
    r"|[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)",
    "merge": r"<<",
}
"""Text without quotes that is no text: the core schema of YAML 1.2, and `<<` of 1.1. PyYAML
follows 1.1, where `yes` is true, `010` is 8, `1:30` is 90 and `1e-2` is text."""
TAG = "tag:yaml.org,2002:"
BASES = {"0o": 8, "0x": 16}


def yaml(text: str) -> Any:
    """Return the document in a text. Raises `ValueError` for a name that is given twice, and
    `ImportError` without the extra `studies`."""
    library = require("yaml", "microcosmos[studies]")
    try:
        loader = _loader(library)(text)
        node = loader.get_single_node()
    except library.YAMLError as error:
        raise ValueError(f"a study must be YAML or JSON: {error}") from error
    _check(library, node, "", set())
    # A few lines of aliases of aliases would take hours.
    if node is not None and _nodes(node, {}) > MAX_NODES:
        raise ValueError(f"a study must have at most {MAX_NODES:,} values with its aliases")
    try:
        return None if node is None else loader.construct_document(node)
    # A tag such as `!!int` before text that is no integer ends in the latter two.
    except (library.YAMLError, ValueError, KeyError) as error:
        raise ValueError(f"a study must be YAML or JSON: {error}") from error


def _nodes(node: Any, known: dict[int, float]) -> float:
    """Return the values at and below a node; infinite for one that leads to itself."""
    if id(node) not in known:
        known[id(node)] = inf  # Of a node that is met below itself.
        below = [] if isinstance(node.value, str) else node.value
        pairs = (one if isinstance(one, tuple) else (one,) for one in below)
        known[id(node)] = 1 + sum(_nodes(one, known) for pair in pairs for one in pair)
    return known[id(node)]


def _loader(library: Any) -> Any:
    """Return PyYAML's loader with the scalars of `SCALARS`, and neither dates nor sets."""
    known = library.SafeLoader.yaml_constructors
    kinds = [None, *(TAG + name for name in (*SCALARS, "str", "seq", "map"))]
    parts = {
        "yaml_implicit_resolvers": {},
        "yaml_constructors": {kind: known[kind] for kind in kinds if kind in known},
    }
    # A class of its own: resolvers belong to the class, and PyYAML's must not change.
    made: Any = type("Loader", (library.SafeLoader,), parts)
    for name, pattern in SCALARS.items():
        made.add_implicit_resolver(TAG + name, re.compile(rf"({pattern})\Z"), None)
    made.add_constructor(TAG + "int", lambda _, node: _integer(node.value))
    return made


def _integer(text: str) -> int:
    return int(text, BASES.get(text[:2], 10))


def _check(library: Any, node: Any, path: str, seen: set[int]) -> None:
    """Refuse names that are given twice; aliases lead to a node again, also to one above."""
    if id(node) in seen:
        return
    seen.add(id(node))
    if isinstance(node, library.MappingNode):
        named = [(key.value, one) for key, one in node.value if _is_name(library, key)]
        refuse_repeated([name for name, _ in named], path)
        for name, one in named:
            _check(library, one, f"{path}{name}.", seen)
    elif isinstance(node, library.SequenceNode):
        for i, one in enumerate(node.value):
            _check(library, one, f"{path}{i}.", seen)


def _is_name(library: Any, key: Any) -> bool:
    """Return whether a key is a name, and not `<<`, which merges mappings."""
    return isinstance(key, library.ScalarNode) and not key.tag.endswith(":merge")
