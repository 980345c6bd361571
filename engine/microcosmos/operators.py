"""Emitters, and the operators by which they make creatures.

An emitter has its settings in `spec.emitters`, and its builder in `build.plan.BUILDERS`.
"""

EMITTERS: dict[str, tuple[str, ...]] = {
    "random": ("random",),
    "neat": ("neat", "crossover", "copy"),
    "iso+line": ("iso+line",),
    "gaussian": ("gaussian",),
    "cma-me": ("cma-me",),
    "cma-mae": ("cma-mae",),
    "population": ("copy", "neat", "crossover"),
    "cma-mega": ("cma-mega",),
}
"""Names of the emitters, each with its operators."""

FORK = "fork"
"""The operator of initial creatures, which no emitter makes."""

_OF_EMITTERS = (operator for made in EMITTERS.values() for operator in made)
# Archive files number operators by this order, so new emitters go behind the others.
OPERATORS: tuple[str, ...] = (*dict.fromkeys(_OF_EMITTERS), FORK)
"""Names of the operators, by the number that an archive file has for each. Those of plug-ins
follow."""
