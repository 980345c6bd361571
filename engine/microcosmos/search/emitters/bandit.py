"""A bandit that divides batches among emitters by how many of their children entered.

It is UCB1 (Auer, Cesa-Bianchi and Fischer, Mach. Learn. 47, 235 (2002), figure 1) over a
sliding window (SW-UCB of Garivier and Moulines, arXiv:0805.3415, section 2), since ever fewer
children enter an archive that fills. Reward and weight ζ are those of Multi-emitter MAP-Elites
(Cully, GECCO 2021), which chooses emitters where this chooses slots. It draws no numbers.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal
from math import inf, sqrt


@dataclass(frozen=True)
class Bandit:
    """UCB1 over the slots of a batch, one after another."""

    window: int
    """Generations that count."""
    exploration: float
    """The weight ζ of uncertainty beside the share of children that entered."""

    def slots(
        self, children: Sequence[int], entered: Sequence[int], batch: int
    ) -> tuple[int, ...]:
        """Return each emitter's part of a batch from its children in the window.

        Each slot goes to the emitter with the largest r + ζ √(ln N / n), the first of equal
        ones: n of the N children before this slot are its own, and a share r of those that
        were evaluated entered. An emitter without children comes first.
        """
        rates = [e / max(n, 1) for e, n in zip(entered, children, strict=True)]
        counts = list(children)
        for _ in range(batch):
            log = _logarithm(sum(counts))
            bounds = [
                rate + self.exploration * sqrt(log / n) if n else inf
                for rate, n in zip(rates, counts, strict=True)
            ]
            counts[bounds.index(max(bounds))] += 1
        return tuple(n - old for n, old in zip(counts, children, strict=True))


def _logarithm(count: int) -> float:
    """Return ln of a count, with the same bits on every processor; 0 of none."""
    return float(Decimal(count).ln()) if count else 0.0
