"""Lessons: children changed by derivatives of fitness and descriptors before they live."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import jax
import numpy as np

from .. import search
from ..genomes import Genotype


@dataclass(frozen=True)
class Lessons:
    """The compiled parts of what one emitter's children learn."""

    number: int
    """In a generation."""
    asks: Callable[..., Genotype]
    slopes: Callable[[Genotype], search.Slopes]
    """Of a block of genotypes."""
    learn: Callable[..., tuple[search.Children, Any]]


@dataclass(frozen=True)
class Taught:
    """What a generation's lessons came to."""

    simulated: int = 0
    """Creatures that were simulated, forwards and backwards."""
    sound: int = 0
    """Those whose slopes were finite."""
    norms: tuple[float, ...] = ()
    """Lengths of the sound slopes of fitness."""

    def summary(self) -> dict[str, float]:
        """For the record of a generation; nothing where nobody learnt."""
        if not self.simulated:
            return {}
        found = {"slopes: sound": self.sound / self.simulated}
        return found | ({"slopes: length": float(np.median(self.norms))} if self.norms else {})

    def and_of(self, slopes: search.Slopes) -> "Taught":
        """With those of one more lesson."""
        sound = np.asarray(slopes.sound)
        norms = np.linalg.norm(np.asarray(slopes.rows)[sound, 0], axis=-1)
        return Taught(
            self.simulated + len(sound),
            self.sound + int(sound.sum()),
            self.norms + tuple(norms.tolist()),
        )


def teach(
    lessons: tuple[Lessons | None, ...],
    slots: tuple[int, ...],
    children: search.Children,
    states: tuple[Any, ...],
    *,
    block: int,
    stop: Callable[[], bool],
) -> tuple[search.Children, tuple[Any, ...], Taught]:
    """Children and emitters' states after all lessons; `lessons` and `slots` are of each
    emitter.
    """
    taught_offspring, kept, taught, first = [], [], Taught(), 0
    for lesson, count, state in zip(lessons, slots, states, strict=True):
        offspring = jax.tree.map(lambda x, a=first, b=first + count: x[a:b], children)
        for _ in range(lesson.number if lesson else 0):
            assert lesson is not None
            asked = jax.device_get(lesson.asks(state, offspring))
            number = len(jax.tree.leaves(asked)[0])
            found = search.evaluate_blocks(
                lesson.slopes, asked, block=min(block, number), stop=stop
            )
            offspring, state = lesson.learn(state, offspring, found)
            taught = taught.and_of(found)
        taught_offspring.append(jax.device_get(offspring))
        kept.append(state)
        first += count
    if not taught.simulated:
        return children, states, taught
    whole = jax.tree.map(lambda *parts: np.concatenate(parts), *taught_offspring)
    return whole, tuple(kept), taught
