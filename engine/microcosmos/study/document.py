"""The file of a study, as YAML or JSON; errors name the field."""

from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import Field, ValidationError, field_validator, model_validator

from ..spec.base import Part, field_path
from ..statistics.measures import DEFAULT, Measure
from . import once

Name = Annotated[str, Field(min_length=1, max_length=60, pattern=r"^[A-Za-z0-9][\w .+-]*$")]
Export = Literal["csv", "json", "latex", "archive-csv", "poses-npz"]
MAX_RUNS = 1000


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
        Annotated[int, Field(ge=1, le=MAX_RUNS)] | Annotated[list[int], Field(min_length=1)]
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
            Measure.parse(text)
        return measures


class Figure(Part):
    """A figure of a comparison."""

    kind: Literal["curves", "box", "parameter", "profile", "creatures", "sheet"]
    """`creatures`: a stroke of the fittest of each group; `sheet`: gaits of the fittest run."""
    of: str = ""
    """The comparison; needed where there are several."""
    field: str = ""
    """For `parameter`: the field of the spec."""
    shown: tuple[str, ...] = ("best", "coverage", "qd_score")
    """For `curves`: the curves."""

    @model_validator(mode="after")
    def refuse_without_field(self) -> Self:
        if (self.kind == "parameter") != bool(self.field):
            needed = "needs" if self.kind == "parameter" else "has no"
            raise ValueError(f"a figure `{self.kind}` {needed} `field`, got {self.field!r}")
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
    resamples: int = Field(default=9999, ge=99)
    """Resamples of the bootstrap, whose seed is 0."""

    @model_validator(mode="after")
    def refuse_one_file_of_two(self) -> Self:
        """Raise `ValueError` where exports of two comparisons would be one file."""
        files: dict[str, str] = {}
        for name in self.comparisons:
            other = files.setdefault(file_of(name), name)
            if other != name:
                raise ValueError(
                    "`comparisons` needs names of different files, got "
                    f"{other!r} and {name!r}, which are both {file_of(name)!r}"
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
                raise ValueError(f"`figures.{number}.of` must be one of {needed}, got none")
            self._refuse_aggregate(number, figure)
        return self

    def _refuse_aggregate(self, number: int, figure: Figure) -> None:
        """Raise `ValueError` where a figure needs tasks, or is of a comparison with tasks."""
        tasks = self.comparison_of(figure)[1].tasks
        if figure.kind == "profile" and not tasks:
            raise ValueError(f"`figures.{number}`: a profile needs a comparison with `tasks`")
        if figure.kind in ("box", "parameter") and tasks:
            raise ValueError(
                f"`figures.{number}`: a {figure.kind} needs a comparison without `tasks`"
            )

    def comparison_of(self, figure: Figure) -> tuple[str, Comparison]:
        """Return the name of a figure's comparison, and the comparison."""
        name = figure.of or next(iter(self.comparisons))
        return name, self.comparisons[name]


def file_of(comparison: str) -> str:
    """Return the name of a comparison's files, without their ending."""
    return comparison.replace(" ", "-")


def _refuse_unknown(field: str, name: str, known: Any) -> None:
    if name not in known:
        raise ValueError(f"`{field}` must be one of {', '.join(known)}, got {name!r}")


def read(path: Path) -> Study:
    """Return the study in a file. Raises `ValueError`, which names the fields that are wrong,
    and `ImportError` where YAML needs the extra `studies`."""
    return parse(path.read_text(), path.suffix.lower() == ".json")


def parse(text: str, is_json: bool = False) -> Study:
    """Return the study in a text; see `read`."""
    try:
        return Study.model_validate(once.json(text) if is_json else once.yaml(text))
    except ValidationError as error:
        raise ValueError("\n".join(_message(one) for one in error.errors())) from error


def _message(error: Any) -> str:
    needed = str(error["msg"]).removeprefix("Value error, ")
    field = field_path([part for part in error["loc"] if not _is_tag(part)])
    got = "" if "got" in needed else f"; got {error['input']!r:.80}"
    return f"{field}: {needed}{got}" if field else f"{needed}{got}"


def _is_tag(part: Any) -> bool:
    """Return whether pydantic added a part of a path, to tell the members of a union apart."""
    text = str(part)
    return "[" in text or text in ("int", "str", "constrained-int")
