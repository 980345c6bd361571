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

    def told(self) -> dict[str, float]:
        """For the record of a generation; nothing where nobody learnt."""
        if not self.simulated:
            return {}
        told = {"slopes: sound": self.sound / self.simulated}
        return told | ({"slopes: length": float(np.median(self.norms))} if self.norms else {})

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
    broods, kept, taught, first = [], [], Taught(), 0
    for own, count, state in zip(lessons, slots, states, strict=True):
        brood = jax.tree.map(lambda x, a=first, b=first + count: x[a:b], children)
        for _ in range(own.number if own else 0):
            assert own is not None
            asked = jax.device_get(own.asks(state, brood))
            number = len(jax.tree.leaves(asked)[0])
            found = search.evaluate_blocks(
                own.slopes, asked, block=min(block, number), stop=stop
            )
            brood, state = own.learn(state, brood, found)
            taught = taught.and_of(found)
        broods.append(jax.device_get(brood))
        kept.append(state)
        first += count
    if not taught.simulated:
        return children, states, taught
    whole = jax.tree.map(lambda *parts: np.concatenate(parts), *broods)
    return whole, tuple(kept), taught
