"""A plug-in: an emitter that adapts its step by the rule of one fifth (Rechenberg 1973).

    microcosmos evolve spec.json --module examples/plugin_emitter.py

Its operator in a spec is the file's name, a dot and the name below: `plugin_emitter.fifth`. It
stands beside built-in emitters, has settings in the page's form and a state in the archive
file, from which a run continues with the same bytes; see docs/plugins.md.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, PRNGKeyArray
from pydantic import Field

import microcosmos
from microcosmos import plugins
from microcosmos.genomes import Vector
from microcosmos.search import Elites, emitters
from microcosmos.spec import Part


class Step(eqx.Module):
    """The state: JAX arrays, which the archive file holds."""

    size: Float[Array, ""]


@dataclass(frozen=True)
class Fifth:
    """Elites plus Gaussian steps, longer when more than a fifth of them enters the archive."""

    problem: emitters.Problem
    first: float
    factor: float

    @property
    def slots(self) -> int:
        return self.problem.slots

    def init(self, *, key: PRNGKeyArray) -> Step:
        return Step(jnp.asarray(self.first))

    def emit(
        self, state: Step, archive: Elites, *, keys: emitters.Keys
    ) -> tuple[emitters.Children, Step, None]:
        """Return a child for each key; newcomers while the archive is empty."""

        def child(key):
            which, step = jax.random.split(key)
            cell = emitters.draw(archive, "mixed", key=which)
            genes = archive.genotypes
            assert isinstance(genes, Vector)
            moved = genes.values[cell] + state.size * jax.random.normal(
                step, genes.values.shape[1:]
            )
            return jnp.clip(moved, -1.0, 1.0), cell

        values, cells = jax.vmap(child)(keys)
        varied = emitters.children(Vector(values), [cells], self.problem.operator)
        fresh = emitters.newcomers(self.problem.newcomer, keys)
        return emitters.or_newcomers(archive, varied, fresh), state, None

    def tell(self, state: Step, outcome: emitters.Outcome) -> Step:
        """Return the state after the outcome of its own children."""
        success = jnp.mean(outcome.entered.astype(jnp.float32))
        factor = jnp.where(success > 0.2, self.factor, 1 / self.factor)
        return Step(jnp.clip(state.size * factor, 1e-3, 1.0))


class Settings(Part):
    """Settings are fields with a default; forms show them with their range and docstring."""

    first: float = Field(default=0.1, gt=0.0, le=1.0)
    """Standard deviation of the first steps; genes lie within ±1."""
    factor: float = Field(default=1.1, gt=1.0, le=2.0)
    """Factor by which the step changes in a generation."""


@plugins.emitter(
    "fifth", title="One fifth", varies=["numbers"], learns="offspring", settings=Settings
)
def fifth(problem: emitters.Problem, settings: Settings) -> emitters.Emitter:
    """An elite plus an isotropic step whose size follows the success of all steps."""
    return Fifth(problem, settings.first, settings.factor)


SPEC: dict[str, Any] = {
    "experiment": "quality-diversity",
    "world": {"width": 32, "height": 32},
    "body": {"nodes": 16},
    "control": {"encoding": "direct", "period": 50, "angle_scale": 0.3},
    "task": {"steps": 200},
    "search": {
        "generations": 20,
        "batch": 16,
        "emitters": [
            {"operator": "plugin_emitter.fifth", "plugin": {"settings": {"first": 0.2}}},
            {"operator": "iso+line"},
        ],
    },
}


def main(archive: Path = Path("plugin_emitter.h5"), **changes: Any) -> Path:
    """Evolve swimmers by both emitters; the archive file."""
    microcosmos.prepare()
    plugins.load(__file__)
    changed = {name: {**SPEC[name], **part} for name, part in changes.items()}
    microcosmos.evolve(
        microcosmos.parse({**SPEC, **changed}),
        archive,
        tell=lambda report: print(f"{report.generation}: best {report.best:.3f}"),
    )
    return archive


if __name__ == "__main__":
    main()
