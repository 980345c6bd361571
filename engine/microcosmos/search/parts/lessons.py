"""Lessons: children of some emitters improve by derivatives before their evaluation."""

from collections.abc import Callable, Generator, Iterator
from dataclasses import dataclass, replace
from typing import Any

import jax
import numpy as np

from ...genomes import Genotype
from ..emitters import Children
from ..gradients import Slopes
from ..loop import Ask, Part, Program, Turn


@dataclass(frozen=True)
class Lessons:
    """The compiled parts of one emitter's lessons."""

    number: int
    """Lessons in a generation."""
    to_differentiate: Callable[..., Genotype]
    slopes: Program
    """Slopes of a block of genotypes."""
    learn: Callable[..., tuple[Children, Any]]


@dataclass(frozen=True)
class Results:
    """The results of a generation's lessons."""

    differentiated: int = 0
    """Creatures simulated, forwards and backwards."""
    finite: int = 0
    """Creatures with finite slopes."""
    norms: tuple[float, ...] = ()
    """Lengths of the finite slopes of fitness."""

    def with_lesson(self, slopes: Slopes) -> "Results":
        finite = np.asarray(slopes.finite)
        norms = np.linalg.norm(np.asarray(slopes.rows)[finite, 0], axis=-1)
        return Results(
            self.differentiated + len(finite),
            self.finite + int(finite.sum()),
            self.norms + tuple(norms.tolist()),
        )


def part(of_emitters: tuple[Lessons | None, ...]) -> Part:
    """Return the part that teaches; takes the lessons of each emitter, None for no lessons."""
    named = {_program(i): one.slopes for i, one in enumerate(of_emitters) if one}
    return Part(
        name="lessons",
        begin=lambda plan: Results(),
        programs=named,
        amend=lambda own, turn: _taught(of_emitters, turn),
        figures=_figures,
    )


def _program(emitter: int) -> str:
    return f"slopes {emitter}"


def _taught(
    of_emitters: tuple[Lessons | None, ...], turn: Turn
) -> Generator[Ask, Any, tuple[Results, Turn]]:
    batch, slots = turn.batch, [emitter.slots for emitter in turn.plan.emitters]
    parts, states, results = [], [], Results()
    pairs = zip(of_emitters, _parts(batch.children, slots), batch.emitters, strict=True)
    for number, (lesson, children, state) in enumerate(pairs):
        for _ in range(lesson.number if lesson else 0):
            assert lesson is not None
            asked = jax.device_get(lesson.to_differentiate(state, children))
            slopes = yield Ask(asked, _program(number))
            children, state = lesson.learn(state, children, slopes)
            results = results.with_lesson(slopes)
        parts.append(jax.device_get(children))
        states.append(state)
    if not results.differentiated:
        return results, turn
    whole = jax.tree.map(lambda *rows: np.concatenate(rows), *parts)
    batch = replace(batch, children=whole, emitters=tuple(states))
    return results, replace(turn, batch=batch)


def _parts(children: Children | None, slots: list[int]) -> Iterator[Children]:
    """Yield the children of each emitter."""
    first = 0
    for count in slots:
        yield jax.tree.map(lambda x, a=first, b=first + count: x[a:b], children)
        first += count


def _figures(own: Results, turn: Turn) -> dict[str, int | float]:
    if not own.differentiated:
        return {}
    figures: dict[str, int | float] = {"slopes.finite": own.finite / own.differentiated}
    return figures | ({"slopes.length": float(np.median(own.norms))} if own.norms else {})
